// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <palpate/identification/noise_samples.hpp>
#include <palpate/identification/noise_statistics.hpp>
#include <palpate/sensing/screening.hpp>

namespace palpate {

namespace {

SensorTiming timing_of(const std::vector<double>& times_s) {
  SensorTiming timing;
  if (times_s.size() < 2) return timing;
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < times_s.size(); ++i) steps_s.push_back(times_s[i] - times_s[i - 1]);
  const double count = static_cast<double>(steps_s.size());
  timing.duration_s = times_s.back() - times_s.front();
  timing.mean_rate_Hz = count / timing.duration_s;
  timing.longest_gap_s = *std::max_element(steps_s.begin(), steps_s.end());
  double squares = 0.0;
  for (const double step_s : steps_s) squares += std::pow(step_s - timing.duration_s / count, 2);
  timing.jitter_s = std::sqrt(squares / count);
  timing.period_s = quantile(std::move(steps_s), 0.5);
  return timing;
}

void add_reading(const SensorReading& reading, double time_s, SensorSamples& samples) {
  if (reading.status == SensorReading::Status::kAbsent) return;
  ++samples.frames;
  const SensorKind kind = samples.has_orientation ? SensorKind::kPose : SensorKind::kPosition;
  const Rejection reason = screen(reading, kind);
  if (reason == Rejection::kMissing) {
    ++samples.missing;
  } else if (reason != Rejection::kNone) {
    ++samples.unusable;
  } else if (!samples.times_s.empty() && !(time_s > samples.times_s.back())) {
    ++samples.bad_times;
  } else {
    Pose& pose = samples.poses.emplace_back();
    pose.p = reading.position_m;
    samples.times_s.push_back(time_s);
    if (!samples.has_orientation) return;
    const Eigen::Vector4d& q = reading.quaternion_wxyz;
    pose.R = Eigen::Quaterniond(q(0), q(1), q(2), q(3)).normalized().toRotationMatrix();
    samples.quaternions_wxyz.push_back(q);
  }
}

}  // namespace

bool SensorSamples::same(std::size_t i, std::size_t j) const {
  return poses[i].p == poses[j].p && (!has_orientation || quaternions_wxyz[i] == quaternions_wxyz[j]);
}

std::size_t SensorSamples::count_distinct() const {
  std::size_t count = size() > 0 ? 1 : 0;
  for (std::size_t i = 1; i < size(); ++i) count += same(i, i - 1) ? 0 : 1;
  return count;
}

SensorSamples SensorSamples::pick(const std::vector<std::size_t>& which) const {
  SensorSamples picked = *this;
  picked.times_s.clear();
  picked.poses.clear();
  picked.quaternions_wxyz.clear();
  for (const std::size_t i : which) {
    picked.times_s.push_back(times_s[i]);
    picked.poses.push_back(poses[i]);
    if (has_orientation) picked.quaternions_wxyz.push_back(quaternions_wxyz[i]);
  }
  return picked;
}

SensorSamples collect_samples(std::span<const TrackerFrame> frames, std::size_t sensor, const NoiseInterval& interval) {
  SensorSamples samples;
  // One reading with an orientation tells: a sensor that is missing carries no such word.
  for (const TrackerFrame& frame : frames)
    samples.has_orientation |=
        frame.readings[sensor].status == SensorReading::Status::kOk && frame.readings[sensor].has_orientation;
  for (const TrackerFrame& frame : frames)
    if (frame.time_s >= interval.from_s && frame.time_s <= interval.to_s && std::isfinite(frame.time_s))
      add_reading(frame.readings[sensor], frame.time_s, samples);
  samples.timing = timing_of(samples.times_s);
  return samples;
}

}  // namespace palpate
