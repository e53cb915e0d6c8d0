// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <ostream>
#include <string>
#include <tests/observer/runs.hpp>
#include <vector>

/// Every layout of the state, catheters whose files state a sigma for every number, and recordings of them. The
/// catheter before the virtual tracker is exactly the file's.
namespace palpate::test {

/// What is estimated beside the force.
struct Layout {
  const char* name;
  bool stiffness = false, free_torsion = false, precurvature = false;

  ObserverOptions of(ObserverOptions options) const {
    options.estimate_stiffness = stiffness;
    options.free_torsion = free_torsion;
    options.estimate_precurvature = precurvature;
    return options;
  }
};

inline constexpr std::array kEveryLayout{Layout{"force"}, Layout{.name = "stiffness", .stiffness = true},
                                         Layout{.name = "stiffness_free", .stiffness = true, .free_torsion = true},
                                         Layout{.name = "precurvature", .precurvature = true},
                                         Layout{"all", true, true, true}};

struct Filter {
  Method method;
  Layout layout;

  ObserverOptions options() const { return layout.of({.method = method}); }
  std::string name() const { return std::string(layout.name) + "_" + name_of(method); }
  friend void PrintTo(const Filter& filter, std::ostream* out) { *out << filter.name(); }
};

inline std::vector<Filter> every_filter() {
  std::vector<Filter> all;
  for (const Layout& layout : kEveryLayout)
    for (const Method method : kEveryMethod) all.push_back({method, layout});
  return all;
}

inline constexpr double kStiffnessSigma = 0.05;

/// Beside the white noise: stiffness 5 %, precurvature 1 1/m, base 0.3 mm and 0.3 deg, mounting 0.2 mm, an
/// electromagnetic tracker biased by 0.48 mm and 0.3 deg rms.
inline Catheter with_every_sigma(Catheter catheter) {
  catheter.stiffness_sigma_fraction = kStiffnessSigma;
  catheter.precurvature_sigma_per_m = {1.0, 1.0, 1.0};
  catheter.base.position_sigma_m = 0.3e-3;
  catheter.base.rotation_sigma_rad = 0.3 * kRadiansPerDegree;
  for (Sensor& sensor : catheter.sensors) {
    sensor.mount_sigma_m = 0.2e-3;
    sensor.bias_m = 0.48e-3;
    sensor.bias_rad = 0.3 * kRadiansPerDegree;
  }
  return catheter;
}

inline Catheter with_tendon(Catheter catheter) {
  catheter.tendon.present = true;
  catheter.tendon.moment_sigma_fraction = 0.1;
  return catheter;
}

inline Catheter layouts_catheter() { return with_every_sigma(two_sensors()); }
inline Catheter layouts_catheter_with_tendon() { return with_tendon(layouts_catheter()); }

inline constexpr double kTendonSigma_Nm = 2e-5;

/// A slow pull, a quarter of what bends the shaft as far as its precurvature does.
inline Eigen::Vector2d tendon_moment_Nm(double time_s) {
  return {1e-3 * (1.0 + std::sin(2.0 * std::numbers::pi * 0.3 * time_s)), 0.2e-3};
}

/// The virtual tracker's recording; of a catheter with a tendon, whose frames carry a noisy reading of it, without gaps
/// and outliers.
inline VirtualRecording recorded(const Catheter& catheter, const ForceSchedule& force,
                                 const VirtualTrackerOptions& options) {
  VirtualRecording out = simulate_tracker(catheter, force, options);
  if (!catheter.tendon.present) return out;
  Draws draws(static_cast<unsigned>(options.seed));
  for (std::size_t i = 0; i < out.frames.size(); ++i) {
    TrackerFrame& frame = out.frames[i];
    const Eigen::Vector2d moment_Nm = tendon_moment_Nm(frame.time_s);
    const TrueFrame truth = true_frame(
        catheter, {.force_tip_N = out.force_tip_N[i], .tendon_couple_Nm = {moment_Nm.x(), moment_Nm.y(), 0.0}});
    frame.readings = with_noise(catheter, truth.frame, draws).readings;
    const Eigen::Vector2d noise_Nm = kTendonSigma_Nm * draws.normal3().head<2>();
    frame.tendon = {.present = true, .moment_Nm = moment_Nm + noise_Nm, .sigma_Nm = kTendonSigma_Nm};
  }
  return out;
}

/// Every third frame carries a reading of the tendon; for some frames the load is known, in tip and in base components.
/// Only for tests of bounds: the shape does not follow the tendon.
inline void add_loads(const Catheter& catheter, std::vector<TrackerFrame>& frames) {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (catheter.tendon.present && i % 3 != 2)
      frames[i].tendon = {.present = true, .moment_Nm = {1e-4, -5e-5}, .sigma_Nm = i % 2 == 0 ? kTendonSigma_Nm : 0.0};
    if (i % 8 >= 5)
      frames[i].known_load = {.present = true, .in_base = i % 2 == 0, .force_N = {0.0, 0.01, -0.02}, .sigma_N = 5e-3};
  }
}

/// A force that jumps to anywhere within 0.3 N, and stays there for so many frames.
inline constexpr int kJumps = 30, kStay = 3;

inline ForceSchedule jumping_force(unsigned seed) {
  Draws draws(seed);
  std::vector<Vector3d> forces_N;
  for (int i = 0; i < kJumps; ++i) forces_N.push_back(draws.in_ball(0.3));
  return [forces_N](double time_s) {
    const auto frame = static_cast<std::size_t>(std::lround(40.0 * time_s));
    return forces_N[std::min(frame / kStay, forces_N.size() - 1)];
  };
}

/// The catheter with the shaft as it is believed to be.
inline Catheter believed(Catheter catheter, const ShaftEstimate& shaft) {
  catheter.rod.sections[0].stiffness_Nm2 = shaft.stiffness_Nm2;
  catheter.rod.sections[0].precurvature_per_m = shaft.precurvature_per_m;
  return catheter;
}

}  // namespace palpate::test
