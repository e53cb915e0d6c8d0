// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <palpate/math/errors.hpp>
#include <palpate/simulation/scenario.hpp>
#include <palpate/simulation/situation.hpp>
#include <string_view>

namespace palpate {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void require(bool good, std::string_view field, double value, std::string_view range) {
  if (!good) throw InputError(fmt::format("{} = {}: expected {}", field, value, range));
}

void require_not_negative(std::string_view field, double value) {
  require(value >= 0.0 && value < kInfinity, field, value, "0 or more");
}

void require_positive(std::string_view field, double value) {
  require(value > 0.0 && value < kInfinity, field, value, "more than 0");
}

void require_share(std::string_view field, double value) {
  require(value >= 0.0 && value < 1.0, field, value, "0 to below 1");
}

void require_finite(std::string_view field, double value) {
  require(std::isfinite(value), field, value, "a finite number");
}

void validate_signal(const std::string& field, const Signal& signal) {
  require_finite(field, signal.constant);
  for (std::size_t i = 0; i < signal.sines.size(); ++i) {
    const std::string name = fmt::format("{}.sines[{}]", field, i);
    require_finite(name + " amplitude", signal.sines[i].amplitude);
    require_not_negative(name + " frequency_hz", signal.sines[i].frequency_hz);
    require_finite(name + " phase_rad", signal.sines[i].phase_rad);
  }
  for (std::size_t i = 0; i < signal.points.size(); ++i) {
    const std::string name = fmt::format("{}.points[{}]", field, i);
    require_finite(name + " time", signal.points[i].first);
    require_finite(name + " value", signal.points[i].second);
    if (i > 0)
      require(signal.points[i].first > signal.points[i - 1].first, name + " time", signal.points[i].first,
              fmt::format("more than {} of the point before", signal.points[i - 1].first));
  }
}

void validate_signals(const std::string& field, const Signal3& signals) {
  for (std::size_t i = 0; i < 3; ++i) validate_signal(fmt::format("{}[{}]", field, i), signals[i]);
}

void validate_load(const ForceLoad& load) { validate_signals("load.force_N", load.force_N); }

void validate_load(const PulleyLoad& load) {
  require_not_negative("load.mass_kg", load.mass_kg);
  validate_signals("load.pulley_base_m", load.pulley_base_m);
}

void validate_load(const WallLoad& load) {
  for (int i = 0; i < 3; ++i) {
    require_finite(fmt::format("load.point_base_m[{}]", i), load.point_base_m[i]);
    require_finite(fmt::format("load.normal_base[{}]", i), load.normal_base[i]);
  }
  require(load.normal_base.norm() > 1e-9, "load.normal_base: length", load.normal_base.norm(), "a direction");
  require(load.stiffness_N_per_m > 0.0 && load.stiffness_N_per_m <= 1e6, "load.stiffness_N_per_m",
          load.stiffness_N_per_m, "more than 0, at most 1e6");
  require(load.tangential_stiffness_N_per_m >= 0.0 && load.tangential_stiffness_N_per_m <= 1e6,
          "load.tangential_stiffness_N_per_m", load.tangential_stiffness_N_per_m, "0 to 1e6");
  require_not_negative("load.friction", load.friction);
  validate_signal("load.along_normal_m", load.along_normal_m);
  const WallLoad::Heart& heart = load.heart;
  require(heart.beats_per_min >= 0.0 && heart.beats_per_min <= 1e4, "load.heart.beats_per_min", heart.beats_per_min,
          "0 to 10000");
  require_finite("load.heart.amplitude_m", heart.amplitude_m);
  require(heart.interval_spread >= 0.0 && heart.interval_spread < 0.5, "load.heart.interval_spread",
          heart.interval_spread, "0 to below 0.5");
  require(heart.size_spread >= 0.0 && heart.size_spread < 0.5, "load.heart.size_spread", heart.size_spread,
          "0 to below 0.5");
}

void validate_handle(const HandleMotion& handle, const Catheter& catheter) {
  validate_signal("handle.moment_1_Nm", handle.moment_1_Nm);
  require_share("handle.moment_sigma_fraction", handle.moment_sigma_fraction);
  validate_signal("handle.bend_1_per_m", handle.bend_1_per_m);
  validate_signal("handle.knob_rad", handle.knob_rad);
  validate_signal("handle.twist_rad", handle.twist_rad);
  validate_signal("handle.translation_m", handle.translation_m);
  const bool mapped = catheter.tendon_map.present && catheter.tendon_map.input == TendonInput::kKnob;
  if (has_knob(handle) && !mapped)
    throw InputError("handle.knob_rad: expected a catheter with a tendon map over the knob's angle");
}

void validate_tracker(const TrackerErrors& errors) {
  require(errors.rate_hz > 0.0 && errors.rate_hz <= 1e4, "tracker.rate_hz", errors.rate_hz,
          "more than 0, at most 10000");
  require_not_negative("tracker.bias_m", errors.bias_m);
  require_not_negative("tracker.bias_rad", errors.bias_rad);
  require_positive("tracker.bias_length_m", errors.bias_length_m);
  require_not_negative("tracker.position_step_m", errors.position_step_m);
  require_not_negative("tracker.quaternion_step", errors.quaternion_step);
  require_finite("tracker.latency_s", errors.latency_s);
  require_not_negative("tracker.jitter_s", errors.jitter_s);
  require_share("tracker.missing_share", errors.missing_share);
  require_share("tracker.dropped_share", errors.dropped_share);
  require_share("tracker.outlier_share", errors.outlier_share);
  require_not_negative("tracker.outlier_m", errors.outlier_m);
}

}  // namespace

void Scenario::validate() const {
  catheter.validate();
  require(duration_s > 0.0 && duration_s <= 86400.0, "duration_s", duration_s, "more than 0, at most 86400");
  std::visit([](const auto& l) { validate_load(l); }, load);
  validate_handle(handle, catheter);
  require_not_negative("flow.rms_N", flow.rms_N);
  require_positive("flow.memory_s", flow.memory_s);
  validate_signal("stiffness_factor", stiffness_factor);
  validate_tracker(tracker);
  require(duration_s * tracker.rate_hz <= kMostFrames,
          fmt::format("duration_s {:g} at rate_hz {:g}: frames", duration_s, tracker.rate_hz),
          std::round(duration_s * tracker.rate_hz), fmt::format("at most {:.0f}", kMostFrames));
}

}  // namespace palpate
