// SPDX-License-Identifier: Apache-2.0
#include <boost/asio/post.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/service/real_time.hpp>
#include <palpate/service/service_parts.hpp>

namespace palpate::service {

namespace asio = boost::asio;
using namespace std::chrono_literals;

void Service::Parts::start() {
  if (settings.lock_memory)
    if (const std::string why = ask_for_locked_memory(); !why.empty()) refuse(why);
  observer_thread = std::thread([this] {
    if (settings.real_time_priority > 0)
      if (const std::string why = ask_for_priority(settings.real_time_priority); !why.empty())
        asio::post(io, [this, why] { refuse(why); });
    loop->run();
  });
  playing = (player ? 1 : 0) + (input ? 1 : 0);
  if (player)
    player_thread = std::thread([this] {
      player->run();
      --playing;
    });
  if (input)
    input_thread = std::thread([this] {
      try {
        input->run();
      } catch (const InputError& error) {
        input_error = error.what();
      }
      --playing;
    });
  for (LinkSource& link : links) link.start();
  for (NdiSource& aurora : auroras) aurora_threads.emplace_back([&aurora] { aurora.run(); });
  if (web)
    web_thread = std::thread([this] {
      stand_back();
      web->run();
    });
  network_ready.assign(network.wakeup().descriptor());
  wait_for_records();
  tick_later();
  signals.add(SIGINT);
  signals.add(SIGTERM);
  signals.async_wait([this](const boost::system::error_code& error, int) {
    if (!error) stop();
  });
  if (look) look_later();
}

/// Nothing more comes in; what has come is estimated and goes out.
void Service::Parts::stop() {
  if (player) player->stop();
  if (input) input->stop();
  for (LinkSource& link : links) link.stop();
  for (NdiSource& aurora : auroras) aurora.stop();
  finish();
}

void Service::Parts::finish() {
  for (std::thread* const thread : {&player_thread, &input_thread})
    if (thread->joinable()) thread->join();
  for (std::thread& thread : aurora_threads)
    if (thread.joinable()) thread.join();
  operators->finish();
  loop->stop();
  if (observer_thread.joinable()) observer_thread.join();
  drain();
  network_ready.cancel();
  network_ready.release();
  tick.cancel();
  look_timer.cancel();
  if (web) web->stop();
  if (web_thread.joinable()) web_thread.join();
  if (server) server->stop();
  io.stop();
}

void Service::Parts::wait_for_records() {
  network_ready.async_wait(asio::posix::stream_descriptor::wait_read, [this](const boost::system::error_code& error) {
    if (error) return;
    network.wakeup().clear();
    drain();
    wait_for_records();
  });
}

void Service::Parts::drain() {
  const bool listened = server && server->health().clients > 0;
  while (const session::LiveRecord* const record = network.front()) {
    if (record->kind == session::LiveRecord::Kind::kEvent) {
      if (page) page->take_event(*record);
      network.pop();
      continue;
    }
    const auto i = static_cast<std::size_t>(record->catheter);
    const bool news = views[i].take(*record);
    network.pop();
    if (page && news) page->take(i, views[i].latest, clock.now_ns());
    if (!listened || !news) continue;
    auto bytes = std::make_shared<std::vector<std::byte>>();
    outputs[i].add(views[i], clock.now_ns(), *bytes);
    outputs[i].add_health(views[i], clock.now_ns(), *bytes);
    server->broadcast(std::move(bytes));
  }
}

/// What happens by the clock alone: health of those from whom nothing comes, references, the end.
void Service::Parts::tick_later() {
  tick.expires_after(20ms);
  tick.async_wait([this](const boost::system::error_code& error) {
    if (error) return;
    operators->look_for_reference();
    if (web) tell_of_strangers();
    auto bytes = std::make_shared<std::vector<std::byte>>();
    for (std::size_t i = 0; i < views.size(); ++i) outputs[i].add_health(views[i], clock.now_ns(), *bytes);
    if (server && !bytes->empty()) server->broadcast(std::move(bytes));
    if (page) page->look(clock.now_ns(), [this] { return health(); });
    const bool ended = !goes_on && playing == 0 && loop->idle() && network.front() == nullptr;
    ended ? stop() : tick_later();
  });
}

void Service::Parts::look_later() {
  look_timer.expires_after(500ms);
  look_timer.async_wait([this](const boost::system::error_code& error) {
    if (error) return;
    look();
    look_later();
  });
}

/// Who was refused stands in the recording; of many within a second the latest, and how many.
void Service::Parts::tell_of_strangers() {
  constexpr std::int64_t kEvery_ns = 1'000'000'000;
  const std::int64_t now_ns = clock.now_ns();
  if (now_ns < strangers_due_ns) return;
  const http::ServerHealth health = web->health();
  const std::uint64_t refused = health.unauthorized + health.forbidden + health.malformed;
  if (refused == strangers) return;
  strangers_due_ns = now_ns + kEvery_ns;
  say("stranger refused", {{"text", health.last_refusal}, {"count", refused - strangers}});
  strangers = refused;
}

/// It goes on without.
void Service::Parts::refuse(const std::string& why) {
  refusals.push_back(why);
  say("refused", {{"text", why}});
}

void Service::Parts::say(const std::string& event, const nlohmann::json& data, int catheter) {
  [[maybe_unused]] const bool said = loop->command({.catheter = catheter, .event = event, .data = text_of(data)});
}

}  // namespace palpate::service
