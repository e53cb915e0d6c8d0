// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <cstring>
#include <palpate/math/units.hpp>
#include <palpate/service/host_clock.hpp>
#include <palpate/service/page.hpp>
#include <span>

namespace palpate::service {

namespace {

using nlohmann::json;

constexpr std::int64_t kRowEvery_ns = 16'666'667;  // 60 a second
constexpr std::int64_t kHealthEvery_ns = 200'000'000;
constexpr std::int64_t kPastEvery_ns = 500'000'000;
constexpr double kMillisecondsPerNanosecond = 1e-6;

double milliseconds(std::int64_t ns) { return kMillisecondsPerNanosecond * static_cast<double>(ns); }

/// As a Float64Array reads them.
http::Message binary(std::span<const double> numbers, bool droppable) {
  static_assert(std::endian::native == std::endian::little);
  std::string bytes(sizeof(double) * numbers.size(), '\0');
  std::memcpy(bytes.data(), numbers.data(), bytes.size());
  return {.bytes = std::make_shared<const std::string>(std::move(bytes)), .binary = true, .droppable = droppable};
}

http::Message text_message(const json& data) { return {.bytes = std::make_shared<const std::string>(text_of(data))}; }

json estimates_json(const ObserverOptions& options) {
  json out = json::array({"force"});
  if (options.estimate_stiffness) out.push_back("stiffness");
  if (options.estimate_precurvature) out.push_back("precurvature");
  return out;
}

json catheter_greeting(const CatheterView& view, const PlayedTruth* truth) {
  const CatheterFile& file = view.settings->settings;
  json out{{"name", view.settings->name},
           {"sensors", view.settings->sensor_names},
           {"tracked_base", file.catheter.base.tracked},
           {"length_mm", file.catheter.rod.length_m() * kMillimetresPerMetre},
           {"rigid_tip_mm", file.catheter.rod.rigid_tip_m * kMillimetresPerMetre},
           {"simulated", truth != nullptr},
           {"wall_normal", nullptr},
           {"estimates", estimates_json(file.observer)}};
  if (truth != nullptr && truth->wall_normal_base) {
    const Vector3d& n = *truth->wall_normal_base;
    out["wall_normal"] = {n.x(), n.y(), n.z()};
  }
  return out;
}

json words_of_statuses() {
  json out = json::array();
  for (std::size_t i = 0; i < kEstimateStatuses; ++i) out.push_back(describe(static_cast<EstimateStatus>(i)));
  return out;
}

}  // namespace

Page::Page(const Settings& settings, const std::vector<CatheterView>& views, std::vector<const PlayedTruth*> truths,
           Send send)
    : settings_(settings), views_(views), truths_(std::move(truths)), send_(std::move(send)) {
  for (std::size_t i = 0; i < views_.size(); ++i)
    shown_.push_back({.figures = {}, .past = {}, .maker = {views_[i].catheter, truths_[i]}});
}

json Page::greeting(std::int64_t now_ns) const {
  json out{{"type", "hello"},
           {"version", settings_.recording.options.program_version},
           {"row", json::array()},
           {"history", kPageHistory},
           {"history_step_s", kPageHistoryStep_s},
           {"history_s", kPageHistory_s},
           {"statuses", words_of_statuses()},
           {"states", {"WAITING", "LIVE", "DEGRADED", "STALE"}},
           {"catheters", json::array()},
           {"bands_g", settings_.dashboard.bands_g},
           {"unit", settings_.dashboard.unit},
           {"contact_rule", in_words(ContactRule{})},
           {"recording", nullptr},
           {"watched", 0},
           {"server_ms", milliseconds(now_ns)}};
  for (const PageField& field : kPageRow)
    out["row"].push_back({{"name", field.name}, {"count", field.count}, {"unit", field.unit}, {"about", field.about}});
  for (std::size_t i = 0; i < views_.size(); ++i) out["catheters"].push_back(catheter_greeting(views_[i], truths_[i]));
  if (!settings_.recording.path.empty()) out["recording"] = settings_.recording.path.string();
  return out;
}

void Page::opened(http::ClientId client, std::int64_t now_ns) {
  send_(client, text_message(greeting(now_ns)));
  send_past(client, clients_[client] = {}, now_ns);
  shown_[0].news = shown_[0].any;
  health_due_ns_ = 0;
}

void Page::text(http::ClientId client, const std::string& text, std::int64_t now_ns) {
  const json said = json::parse(text, nullptr, false);
  const auto found = clients_.find(client);
  if (!said.is_object() || found == clients_.end()) return;
  if (const json ping = said.value("ping", json()); ping.is_number())
    send_(client, text_message({{"type", "pong"}, {"ping", ping}, {"server_ms", milliseconds(now_ns)}}));
  if (const json watch = said.value("watch", json()); watch.is_number_unsigned() && watch < views_.size()) {
    found->second.watches = watch.get<std::size_t>();
    found->second.wants_past = true;
    if (now_ns >= found->second.past_due_ns) send_past(client, found->second, now_ns);
    shown_[found->second.watches].news = shown_[found->second.watches].any;
  }
}

void Page::send_past(http::ClientId id, Client& client, std::int64_t now_ns) {
  client.wants_past = false;
  client.past_due_ns = now_ns + kPastEvery_ns;
  const PageHistory& past = shown_[client.watches].past;
  std::vector<double> numbers{static_cast<double>(PageMessage::kHistory), static_cast<double>(client.watches),
                              static_cast<double>(past.rows())};
  past.append_to(numbers);
  send_(id, binary(numbers, false));
}

bool Page::watched(std::size_t catheter) const {
  return std::any_of(clients_.begin(), clients_.end(),
                     [&](const auto& client) { return client.second.watches == catheter; });
}

void Page::take(std::size_t catheter, const session::LiveRecord& record, std::int64_t now_ns) {
  Shown& shown = shown_[catheter];
  shown.figures.take(record);
  shown.past.take(shown.maker.history_row(views_[catheter], shown.figures, now_ns));
  shown.any = shown.news = true;
  // Silence is told at once; of what comes faster than 60 a second, the latest when it is due.
  const bool stale = record.kind == session::LiveRecord::Kind::kStale;
  if (now_ns >= shown.due_ns || (stale && !shown.told_stale)) send_row(catheter, now_ns);
}

void Page::send_row(std::size_t catheter, std::int64_t now_ns) {
  Shown& shown = shown_[catheter];
  shown.news = false;
  if (!watched(catheter)) return;
  shown.due_ns = now_ns + kRowEvery_ns;
  shown.told_stale = state_of(views_[catheter], now_ns) == LiveState::kStale;
  std::array<double, 2 + page_row_size()> numbers{static_cast<double>(PageMessage::kRow),
                                                  static_cast<double>(catheter)};
  const PageRow& row = shown.maker.row(views_[catheter], shown.figures, now_ns);
  std::copy(row.begin(), row.end(), numbers.begin() + 2);
  const http::Message message = binary(numbers, true);
  for (const auto& [id, client] : clients_)
    if (client.watches == catheter) send_(id, message);
}

void Page::take_event(const session::LiveRecord& event) {
  if (clients_.empty()) return;
  json data = json::parse(event.data, nullptr, false);
  if (data.is_discarded()) data = nullptr;  // most say nothing more
  send_all({{"type", "event"},
            {"catheter", event.catheter},
            {"event", event.event},
            {"data", std::move(data)},
            {"server_ms", milliseconds(event.received_ns)}});
}

void Page::set_catheter(std::size_t catheter) { shown_[catheter].maker.set_catheter(views_[catheter].catheter); }

void Page::look(std::int64_t now_ns, const std::function<json()>& health) {
  if (clients_.empty()) return;
  for (auto& [id, client] : clients_)
    if (client.wants_past && now_ns >= client.past_due_ns) send_past(id, client, now_ns);
  bool due = now_ns >= health_due_ns_;
  for (std::size_t i = 0; i < shown_.size(); ++i) {
    Shown& shown = shown_[i];
    if (shown.news && now_ns >= shown.due_ns) send_row(i, now_ns);
    const LiveState state = state_of(views_[i], now_ns);
    due = due || state != shown.said;
    shown.said = state;
  }
  if (!due) return;
  health_due_ns_ = now_ns + kHealthEvery_ns;
  json status = health();
  status["type"] = "status";
  send_all(status);
}

void Page::send_all(const json& data) {
  const http::Message message = text_message(data);
  for (const auto& [id, client] : clients_) send_(id, message);
}

}  // namespace palpate::service
