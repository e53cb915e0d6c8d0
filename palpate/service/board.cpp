// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <palpate/evaluation/force_size.hpp>
#include <palpate/service/board.hpp>
#include <palpate/service/host_clock.hpp>

namespace palpate::service {

namespace {

using Kind = session::LiveRecord::Kind;

double seconds(std::int64_t ns) { return kSecondsPerNanosecond * static_cast<double>(ns); }

nlohmann::json numbers(const Vector3d& values) {
  nlohmann::json out = nlohmann::json::array();
  for (int i = 0; i < 3; ++i) out.push_back(std::isfinite(values(i)) ? nlohmann::json(values(i)) : nlohmann::json());
  return out;
}

nlohmann::json statuses_json(const CatheterCounters& counters) {
  nlohmann::json out = nlohmann::json::object();
  for (std::size_t i = 0; i < kEstimateStatuses; ++i)
    if (const std::uint64_t count = counters.by_status[i].get(); count > 0)
      out[std::string(describe(static_cast<EstimateStatus>(i)))] = count;
  return out;
}

nlohmann::json sensors_json(const CatheterView& view, const CatheterCounters& counters) {
  nlohmann::json out = nlohmann::json::object();
  const auto& names = view.settings->sensor_names;
  for (std::size_t i = 0; i < names.size(); ++i) {
    nlohmann::json& sensor = out[names[i]] = nlohmann::json::object();
    for (std::size_t reason = 0; reason < kRejections; ++reason)
      if (const std::uint64_t count = counters.by_sensor_and_reason[i][reason].get(); count > 0)
        sensor[reason == 0 ? "usable" : std::string(describe(static_cast<Rejection>(reason)))] = count;
  }
  return out;
}

/// Of the latest frame: "usable", or why it was not.
nlohmann::json sensors_now_json(const CatheterView& view) {
  nlohmann::json out = nlohmann::json::object();
  const auto& names = view.settings->sensor_names;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Rejection why = view.latest.estimate.rejections[i];
    out[names[i]] = why == Rejection::kNone ? "usable" : std::string(describe(why));
  }
  return out;
}

nlohmann::json times_json(const CatheterCounters& counters) {
  const auto count = [&](FrameTime time) { return counters.by_time[static_cast<std::size_t>(time)].get(); };
  return {{"stood_still", count(FrameTime::kStandsStill)},
          {"stepped_back", count(FrameTime::kStepsBack)},
          {"not_finite", count(FrameTime::kNotFinite)},
          {"resynchronised", count(FrameTime::kResynchronised)}};
}

}  // namespace

std::string_view describe(LiveState state) {
  constexpr std::array<std::string_view, 4> words{"WAITING", "LIVE", "DEGRADED", "STALE"};
  return words[static_cast<std::size_t>(state)];
}

bool CatheterView::take(const session::LiveRecord& record) {
  if (record.kind == Kind::kEvent) return false;
  // A frame that comes twice, or late behind others, says nothing of now; the one before stands until it is stale.
  if (record.kind == Kind::kFrame && any && !moves_the_clock(record.estimate.time)) return false;
  if (!any) first_time_s = record.frame.time_s;
  any = true;
  latest = record;
  if (record.kind != Kind::kFrame || !moves_the_clock(record.estimate.time)) return true;
  const bool waits = settings->settings.reference.given && !reference_done;
  recent.push_back(record.frame);
  while (recent.size() > kMostRecent || (!waits && recent.back().time_s - recent.front().time_s > kRecent_s))
    recent.pop_front();
  return true;
}

namespace {

bool comes_late(const CatheterCounters& counters, std::int64_t now_ns) {
  constexpr std::uint64_t kRecently_ns = 1'000'000'000;
  return counters.last_miss_ns.get() + kRecently_ns > static_cast<std::uint64_t>(now_ns);
}

}  // namespace

namespace {

bool is_fresh(const CatheterView& view, std::int64_t now_ns) {
  const std::int64_t age_ns = now_ns - view.latest.received_ns + nanoseconds(view.latest.late_s);
  return age_ns < static_cast<std::int64_t>(view.live->counters().stale_after_ns.get());
}

}  // namespace

LiveState state_of(const CatheterView& view, std::int64_t now_ns) {
  if (!view.any) return LiveState::kWaiting;
  const CatheterCounters& counters = view.live->counters();
  if (view.latest.kind == Kind::kStale || counters.is_stale.get() != 0 || !is_fresh(view, now_ns))
    return LiveState::kStale;
  const bool doubtful = counters.is_inconsistent.get() != 0 || comes_late(counters, now_ns);
  return doubtful ? LiveState::kDegraded : LiveState::kLive;
}

Health health_of(const CatheterView& view, std::int64_t now_ns) {
  const LiveState state = state_of(view, now_ns);
  if (state == LiveState::kWaiting) return {state, {"no frame has come yet"}};
  const CatheterCounters& counters = view.live->counters();
  if (state == LiveState::kStale) {
    const double silent_s = seconds(now_ns - static_cast<std::int64_t>(counters.measured_at_ns.get()));
    return {state, {fmt::format("no usable frame for {:.1f} s", silent_s)}};
  }
  Health out{state, {}};
  const Estimate& estimate = view.latest.estimate;
  if (counters.is_inconsistent.get() != 0)
    out.words.emplace_back(
        "the sensors contradict the shaft's model: is the field distorted, a sensor shifted, the shaft touched?");
  if (comes_late(counters, now_ns))
    out.words.emplace_back("estimates come late: the computer or the network is too busy");
  if (view.settings->settings.reference.given && !view.reference_done)
    out.words.emplace_back("waits for the reference interval: keep the tip free");
  if (!is_measured(estimate.status) && estimate.status != EstimateStatus::kStale)
    out.words.push_back(fmt::format("the latest frame gives no force: {}", describe(estimate.status)));
  if (!estimate.observability.all_observable()) out.words.push_back(describe(estimate.observability));
  return out;
}

bool shows_force(const CatheterView& view, std::int64_t now_ns) {
  return view.any && view.latest.kind == Kind::kFrame && is_measured(view.latest.estimate.status) &&
         is_fresh(view, now_ns);
}

nlohmann::json catheter_json(const CatheterView& view, std::int64_t now_ns) {
  const Health health = health_of(view, now_ns);
  const CatheterCounters& counters = view.live->counters();
  nlohmann::json out{{"catheter", view.settings->name},
                     {"state", describe(health.state)},
                     {"words", health.words},
                     {"frames", counters.frames.get()},
                     {"statuses", statuses_json(counters)},
                     {"sensors", sensors_json(view, counters)},
                     {"times", times_json(counters)},
                     {"misses", counters.misses.get()},
                     {"stale", counters.stale.get()},
                     {"inconsistent", counters.inconsistent.get()},
                     {"late_readings", counters.late_readings.get()},
                     {"queue_dropped", counters.queue_dropped.get()}};
  if (!view.any) return out;
  const Estimate& estimate = view.latest.estimate;
  const double period_s = seconds(static_cast<std::int64_t>(counters.period_ns.get()));
  out["status"] = describe(estimate.status);
  out["time_s"] = view.latest.output_time_s;
  out["age_s"] = seconds(now_ns - view.latest.received_ns) + view.latest.late_s;
  out["rate_hz"] = period_s > 0.0 ? nlohmann::json(1.0 / period_s) : nlohmann::json();
  out["force_tip_N"] = shows_force(view, now_ns) ? numbers(estimate.force_tip_N) : nlohmann::json();
  out["sensors_now"] = sensors_now_json(view);
  out["sigma_N"] = numbers(estimate.covariance_tip_N2.diagonal().cwiseSqrt());
  return out;
}

std::string text_of(const nlohmann::json& data) {
  return data.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace palpate::service
