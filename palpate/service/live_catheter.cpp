// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <palpate/service/host_clock.hpp>
#include <palpate/service/live_catheter.hpp>
#include <utility>

namespace palpate::service {

LiveCatheter::LiveCatheter(int index, const Catheter& catheter, const ObserverOptions& options, const Watch& watch)
    : index_(index), observer_(std::make_unique<ForceObserver>(catheter, options)), staleness_(watch.stale_ns) {
  if (watch.tracker) lateness_.emplace();
}

void LiveCatheter::take(const TrackerFrame& frame, std::int64_t received_ns, session::LiveRecord& out) {
  out.kind = session::LiveRecord::Kind::kFrame;
  out.catheter = index_;
  out.received_ns = received_ns;
  out.frame = frame;
  if (!frame.tendon.present) out.frame.tendon = tendon_;
  const double step_s = frame.time_s - last_.time_s;
  out.estimate = last_ = observer_->update(out.frame);
  out.output_time_s = clock_.stamp(frame.time_s, kSecondsPerNanosecond * static_cast<double>(received_ns));

  judge_age(out);

  changed_ = 0;
  const bool was_silent = staleness_.stale(), was_alarmed = alarm_.alarmed();
  // A device that repeats its last frame is silent, too.
  if (moves_the_clock(out.estimate.time))
    staleness_.frame(received_ns, std::isfinite(step_s) ? nanoseconds(std::clamp(step_s, 0.0, 10.0)) : 0);
  alarm_.take(out.estimate);
  if (was_silent && !staleness_.stale()) note("live");
  if (alarm_.alarmed() != was_alarmed) note(was_alarmed ? "consistent" : "inconsistent");
  if (alarm_.alarmed() && !was_alarmed) counters_.inconsistent.add();
  count(out.frame, out.estimate);
}

void LiveCatheter::judge_age(session::LiveRecord& out) {
  out.late_s = 0.0;
  if (!moves_the_clock(out.estimate.time)) return;
  if (lateness_) {
    if (out.estimate.time == FrameTime::kResynchronised) lateness_->begin_anew();
    out.late_s = lateness_->late_s(out.frame.time_s, kSecondsPerNanosecond * static_cast<double>(out.received_ns));
  }
  counters_.measured_at_ns.set(static_cast<std::uint64_t>(out.received_ns - nanoseconds(out.late_s)));
}

void LiveCatheter::count(const TrackerFrame& frame, const Estimate& estimate) {
  counters_.frames.add();
  counters_.by_status[static_cast<std::size_t>(estimate.status)].add();
  counters_.by_time[static_cast<std::size_t>(estimate.time)].add();
  for (std::size_t i = 0; moves_the_clock(estimate.time) && i < frame.readings.size(); ++i)
    counters_.by_sensor_and_reason[i][static_cast<std::size_t>(estimate.rejections[i])].add();
  counters_.is_inconsistent.set(alarm_.alarmed() ? 1 : 0);
  counters_.is_stale.set(staleness_.stale() ? 1 : 0);
  counters_.period_ns.set(static_cast<std::uint64_t>(staleness_.period_ns()));
  counters_.stale_after_ns.set(static_cast<std::uint64_t>(staleness_.limit_ns()));
}

bool LiveCatheter::look(std::int64_t now_ns, session::LiveRecord& out) {
  if (!staleness_.started() || staleness_.stale() || now_ns < staleness_.deadline_ns()) return false;
  staleness_.say_stale();
  counters_.stale.add();
  counters_.is_stale.set(1);
  const double silent_s = kSecondsPerNanosecond * static_cast<double>(staleness_.limit_ns());
  const ForceGaussian forecast = observer_->forecast(silent_s);
  out.kind = session::LiveRecord::Kind::kStale;
  out.catheter = index_;
  out.received_ns = now_ns;
  out.late_s = 0.0;
  out.estimate = last_;
  out.estimate.status = EstimateStatus::kStale;
  out.estimate.time_s = last_.time_s + silent_s;
  out.estimate.force_tip_N = forecast.mean_N;
  out.estimate.covariance_tip_N2 = forecast.covariance_N2;
  out.estimate.force_base_N = last_.R_base_tip * forecast.mean_N;
  out.estimate.used = 0;
  out.estimate.sensors_used = 0;
  out.output_time_s =
      clock_.stamp(std::numeric_limits<double>::quiet_NaN(), kSecondsPerNanosecond * static_cast<double>(now_ns));
  return true;
}

std::int64_t LiveCatheter::next_look_ns() const {
  const bool waits = staleness_.started() && !staleness_.stale();
  return waits ? staleness_.deadline_ns() : std::numeric_limits<std::int64_t>::max();
}

std::unique_ptr<ForceObserver> LiveCatheter::exchange(std::unique_ptr<ForceObserver> observer) {
  return std::exchange(observer_, std::move(observer));
}

}  // namespace palpate::service
