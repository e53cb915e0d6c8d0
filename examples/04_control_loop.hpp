// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <palpate/observer/force_observer.hpp>
#include <thread>

/// A control loop at 1 kHz over a tracker at its own pace (40 Hz, say). A step allocates nothing, throws nothing and
/// waits for nobody; `tracker.poll(frame)` says whether it has put a new one there, `robot` takes the force.
template <typename Tracker, typename Robot>
void control_loop(palpate::ForceObserver& observer, palpate::TrackerFrame& frame, Tracker& tracker, Robot& robot) {
  using palpate::EstimateStatus;
  constexpr std::chrono::milliseconds kPeriod(1);
  constexpr double kStale_s = 0.1;  // four frames: after that the force is a guess
  double measured_s = -1e9;         // when a force was measured last

  for (auto next = std::chrono::steady_clock::now(); robot.running(); next += kPeriod) {
    std::this_thread::sleep_until(next);
    const double now_s = tracker.now_s();  // the clock that stamps the frames
    if (tracker.poll(frame)) {
      const palpate::Estimate estimate = observer.update(frame);  // some ten microseconds
      if (estimate.status == EstimateStatus::kUpdated || estimate.status == EstimateStatus::kReseeded)
        measured_s = frame.time_s;
    }
    if (now_s - measured_s > kStale_s)
      robot.hold();  // silence is not "no force"
    else
      robot.apply(observer.forecast(now_s - measured_s));  // tip axes, N, with its covariance
  }
}
