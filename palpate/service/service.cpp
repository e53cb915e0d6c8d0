// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <boost/asio/post.hpp>
#include <map>
#include <palpate/math/errors.hpp>
#include <palpate/service/service_parts.hpp>

namespace palpate::service {

namespace {

using Kind = SourceSettings::Kind;

std::vector<session::SessionCatheter> session_catheters(const Settings& settings) {
  std::vector<session::SessionCatheter> out;
  for (const CatheterSettings& each : settings.catheters)
    out.push_back({each.name, each.file, each.toml, each.sensor_names});
  return out;
}

}  // namespace

/// What may be refused comes first, the recording's file last: where something else cannot be, none is left behind.
Service::Parts::Parts(Settings what) : settings(std::move(what)) {
  for (const CatheterSettings& each : settings.catheters) add_catheter(each);
  std::vector<Reel> reels;
  for (std::size_t i = 0; i < settings.catheters.size(); ++i) {
    const CatheterSettings& each = settings.catheters[i];
    const Kind kind = each.source.kind;
    truths.emplace_back();
    if (kind == Kind::kOpenIgtLink || kind == Kind::kStandardInput || kind == Kind::kNdi) continue;
    reels.push_back(make_reel(static_cast<int>(i), each, catheters[i].counters()));
    truths.back() = std::move(reels.back().truth);
  }
  make_servers();
  if (web) make_page();
  make_loop();
  make_sources(std::move(reels));
}

Service::Parts::~Parts() {
  if (observer_thread.joinable()) stop();
}

void Service::Parts::add_catheter(const CatheterSettings& each) {
  const int index = static_cast<int>(catheters.size());
  const CatheterFile& file = each.settings;
  const LiveCatheter& live = catheters.emplace_back(
      index, file.catheter, file.observer,
      LiveCatheter::Watch{nanoseconds(settings.stale_s), each.source.kind == Kind::kOpenIgtLink});
  CatheterView& view = views.emplace_back();
  view.settings = &each;
  view.catheter = file.catheter;
  view.live = &live;
  outputs.emplace_back(each, settings.link);
  for (const std::string& warning : file.warnings) settings.warnings.push_back(warning);
}

void Service::Parts::make_loop() {
  if (!settings.recording.path.empty()) {
    writer.emplace(settings.recording.path, session_catheters(settings), settings.recording.options);
    recorder.emplace(*writer);
    sinks.push_back(&*recorder);
  }
  sinks.push_back(&network);
  std::vector<LiveCatheter*> pointers;
  for (LiveCatheter& each : catheters) pointers.push_back(&each);
  loop.emplace(clock, std::move(pointers), sinks);
  operators.emplace(io, clock, *loop, views, [this](std::size_t i) {
    outputs[i].set_catheter(views[i].catheter);
    if (page) page->set_catheter(i);
  });
}

void Service::Parts::make_sources(std::vector<Reel> reels) {
  if (!reels.empty()) player.emplace(clock, loop->add_source(kMaxSensors + 1), std::move(reels));
  for (std::size_t i = 0; i < settings.catheters.size(); ++i)
    if (settings.catheters[i].source.kind == Kind::kStandardInput) make_input(static_cast<int>(i));
  make_links();
  make_auroras();
}

void Service::Parts::make_input(int index) {
  const auto i = static_cast<std::size_t>(index);
  const auto say_bad_line = [this, index](const std::string& what) {
    boost::asio::post(io, [this, index, what] { say("bad line", {{"text", what}}, index); });
  };
  input.emplace(clock, loop->add_source(kMaxSensors + 1), index, settings.catheters[i], catheters[i].counters(),
                say_bad_line);
}

/// One connection to each server, whatever the number of catheters that it watches.
void Service::Parts::make_links() {
  std::map<std::string, std::vector<LinkSource::Watched>> servers;
  for (std::size_t i = 0; i < settings.catheters.size(); ++i) {
    const CatheterSettings& each = settings.catheters[i];
    if (each.source.kind != Kind::kOpenIgtLink) continue;
    servers[fmt::format("{}:{}", each.source.host, each.source.port)].push_back(
        {static_cast<int>(i), &each, &catheters[i].counters()});
  }
  if (servers.empty()) return;
  goes_on = true;
  FrameQueue& queue = loop->add_source(kMaxSensors + 1);
  for (const auto& [name, watched] : servers)
    links.emplace_back(io, clock, queue, watched,
                       [this, server = name](const std::string& event, const std::string& why) {
                         say(event, {{"server", server}, {"why", why}});
                       });
}

/// One for each serial port, with a queue of its own: every source's thread is the only one that fills its queue.
void Service::Parts::make_auroras() {
  std::map<std::string, std::vector<NdiSource::Watched>> ports;
  for (std::size_t i = 0; i < settings.catheters.size(); ++i) {
    const CatheterSettings& each = settings.catheters[i];
    if (each.source.kind == Kind::kNdi)
      ports[each.source.path.string()].push_back({static_cast<int>(i), &each, &catheters[i].counters()});
  }
  for (const auto& [name, watched] : ports) {
    goes_on = true;
    const auto say_state = [this, port = name](const std::string& event, const std::string& why) {
      boost::asio::post(io, [this, event, port, why] { say(event, {{"server", port}, {"why", why}}); });
    };
    auroras.emplace_back(clock, loop->add_source(kMaxSensors + 1), watched, say_state);
  }
}

void Service::Parts::make_servers() {
  if (settings.link.on)
    server.emplace(io, link::ServerOptions{.address = settings.link.address,
                                           .port = settings.link.port,
                                           .most_clients = settings.link.most_clients});
  if (!settings.dashboard.on) return;
  if (settings.dashboard.server.token.empty()) settings.dashboard.server.token = http::new_token();
  // It has a thread of its own; what it brings is done on the network's.
  const auto here = [this](auto&& what) { boost::asio::post(io, std::forward<decltype(what)>(what)); };
  web.emplace(
      settings.dashboard.server,
      [this, here](const http::Request& request, const http::Server::Reply& reply) {
        here([this, request, reply] { answer(request, reply); });
      },
      http::ClientEvents{
          .opened = [this, here](http::ClientId id) { here([this, id] { page->opened(id, clock.now_ns()); }); },
          .text =
              [this, here](http::ClientId id, std::string text) {
                here([this, id, text = std::move(text)] { page->text(id, text, clock.now_ns()); });
              },
          .closed = [this, here](http::ClientId id) { here([this, id] { page->closed(id); }); }});
}

void Service::Parts::make_page() {
  std::vector<const PlayedTruth*> known;
  for (const PlayedTruth& truth : truths) known.push_back(truth.moments.empty() ? nullptr : &truth);
  page.emplace(settings, views, std::move(known),
               [this](http::ClientId client, http::Message message) { web->send(client, std::move(message)); });
}

Service::Service(Settings settings) : parts_(std::make_unique<Parts>(std::move(settings))) {}
Service::~Service() = default;

void Service::run(const std::function<void()>& look) {
  parts_->look = look;
  parts_->start();
  parts_->io.run();
  if (!parts_->input_error.empty()) throw InputError(parts_->input_error);
}

nlohmann::json Service::finish() {
  if (parts_->writer) parts_->writer->close();
  return parts_->health();
}

nlohmann::json Service::health() const { return parts_->health(); }
std::uint16_t Service::link_port() const { return parts_->server ? parts_->server->port() : 0; }
std::uint16_t Service::dashboard_port() const { return parts_->web ? parts_->web->port() : 0; }
const std::string& Service::token() const { return parts_->settings.dashboard.server.token; }

std::string Service::dashboard_address() const {
  if (!parts_->web) return "";
  const http::ServerOptions& server = parts_->settings.dashboard.server;
  const std::string& host = server.hosts.empty() ? server.address : server.hosts.front();
  return fmt::format("{}://{}:{}/?token={}", parts_->web->secure() ? "https" : "http",
                     host.find(':') == std::string::npos ? host : "[" + host + "]", parts_->web->port(), server.token);
}
const std::vector<std::string>& Service::warnings() const { return parts_->settings.warnings; }

}  // namespace palpate::service
