// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <palpate/identification/registration.hpp>

namespace palpate {

namespace {

/// Every pose of every frame against the tracker itself, or against the base sensor.
Catheter without_registration(Catheter catheter) {
  catheter.base.T_tracker_base = Pose{};
  catheter.base.sensor.T_local_sensor = Pose{};
  return catheter;
}

}  // namespace

std::vector<MeanPose> mean_reference_poses(const Catheter& catheter, std::span<const TrackerFrame> frames,
                                           double from_s, double to_s) {
  return mean_poses(without_registration(catheter), frames, from_s, to_s);
}

std::vector<SensorDrift> find_drift(const Catheter& catheter, std::span<const TrackerFrame> frames, double from_s,
                                    double to_s) {
  std::vector<double> times_s;
  for (const TrackerFrame& frame : frames)
    if (frame.time_s >= from_s && frame.time_s <= to_s) times_s.push_back(frame.time_s);
  std::vector<SensorDrift> drifts;
  if (times_s.size() < 4) return drifts;
  const auto middle = times_s.begin() + static_cast<std::ptrdiff_t>(times_s.size() / 2);
  std::nth_element(times_s.begin(), middle, times_s.end());
  const auto early = mean_reference_poses(catheter, frames, from_s, std::nextafter(*middle, -HUGE_VAL));
  const auto late = mean_reference_poses(catheter, frames, *middle, to_s);
  constexpr double kSigmas = 5.0;
  for (std::size_t i = 0; i < early.size(); ++i) {
    if (early[i].count == 0 || late[i].count == 0) continue;
    const double noise_m = catheter.sensors[i].noise_m.norm();  // in 3-D
    const double of_means_m = noise_m * std::sqrt(1.0 / early[i].count + 1.0 / late[i].count);
    const double moved_m = (late[i].T_base_sensor.p - early[i].T_base_sensor.p).norm();
    if (moved_m > std::max(kSigmas * of_means_m, noise_m)) drifts.push_back({static_cast<int>(i), moved_m});
  }
  return drifts;
}

}  // namespace palpate
