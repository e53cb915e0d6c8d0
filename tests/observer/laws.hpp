// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>
#include <ostream>
#include <tests/force_motions.hpp>
#include <tests/observer/runs.hpp>

/// Every law of motion, with and without a declared disturbance, and recordings to try them on.
namespace palpate::test {

struct Law {
  ForceMotion motion;
  bool disturbed;

  std::string name() const { return std::string(name_of(motion)) + (disturbed ? "_disturbed" : ""); }
  friend void PrintTo(const Law& law, std::ostream* out) { *out << law.name(); }
};

inline std::vector<Law> every_law() {
  std::vector<Law> all;
  for (const ForceMotion motion : kEveryMotion)
    for (const bool disturbed : {false, true}) all.push_back({motion, disturbed});
  return all;
}

inline constexpr int kLag = 12;
inline constexpr double kStep_s = 0.025;

/// 0.1 N before the first frame: a force as large as the paper's.
inline ObserverOptions options_of(const Law& law) {
  return {.force_model = law.motion,
          .initial_force_sigma_N = 0.1,
          .disturbance_rms_N = law.disturbed ? 5e-3 : 0.0,
          .forecast_s = 0.1,
          .smoothing_lag_frames = kLag};
}

inline Eigen::Array3d sigma_N(const Matrix3d& covariance_N2) { return covariance_N2.diagonal().array().sqrt(); }

/// Blind for a second; then times that cannot be.
inline constexpr std::size_t kBlindFrom = 100, kBlindTo = 140, kStepsBack = 150, kNoTime = 160;

/// Missing readings, outliers, a second without any sensor, a jump, times that cannot be.
inline std::vector<TrackerFrame> faulty_frames(const Catheter& catheter) {
  const auto force = [](double time_s) -> Vector3d {
    return time_s < 4.5 ? beating_wall_force(time_s) : Vector3d(0.02, -0.1, -0.08);
  };
  std::vector<TrackerFrame> out =
      simulate_tracker(catheter, force, {.duration_s = 6.0, .seed = 5, .missing_share = 0.1, .outlier_share = 0.05})
          .frames;
  for (std::size_t i = kBlindFrom; i < kBlindTo; ++i)
    for (SensorReading& reading : out[i].readings) reading = SensorReading{};
  out[kStepsBack].time_s -= 1.0;
  out[kNoTime].time_s = std::numeric_limits<double>::quiet_NaN();
  return out;
}

struct Moved {
  std::vector<TrackerFrame> frames;
  std::vector<Vector3d> tissue_N;  ///< the force to be found: without the disturbance
};

/// What is seen is `tissue_N`, pushed by the disturbance that the options declare.
inline Moved with_disturbance(const Catheter& catheter, const ObserverOptions& options, std::vector<Vector3d> tissue_N,
                              unsigned seed) {
  Draws draws(seed);
  std::vector<Vector3d> seen_N = tissue_N;
  const double keep = std::exp(-kStep_s / options.disturbance_memory_s), fresh = std::sqrt(1.0 - keep * keep);
  Vector3d push_N = options.disturbance_rms_N * draws.normal3();
  for (Vector3d& force_N : seen_N) {
    force_N += push_N;
    push_N = keep * push_N + fresh * options.disturbance_rms_N * draws.normal3();
  }
  const ForceSchedule schedule = [&](double time_s) {
    return seen_N[static_cast<std::size_t>(std::lround(time_s / kStep_s))];
  };
  const double duration_s = kStep_s * static_cast<double>(seen_N.size());
  VirtualRecording recording = simulate_tracker(catheter, schedule, {.duration_s = duration_s, .seed = seed});
  return {std::move(recording.frames), std::move(tissue_N)};
}

inline Moved on_the_beating_wall(const Catheter& catheter, const ObserverOptions& options, int frames, unsigned seed) {
  std::vector<Vector3d> tissue_N(static_cast<std::size_t>(frames));
  for (int k = 0; k < frames; ++k) tissue_N[static_cast<std::size_t>(k)] = beating_wall_force(kStep_s * k);
  return with_disturbance(catheter, options, std::move(tissue_N), seed);
}

}  // namespace palpate::test
