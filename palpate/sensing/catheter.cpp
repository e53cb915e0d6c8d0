// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <palpate/math/errors.hpp>
#include <palpate/sensing/catheter.hpp>

namespace palpate {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRotationTolerance = 1e-6;
constexpr double kArcTolerance_m = 1e-12;

[[noreturn]] void refuse(std::string_view parameter, double value, std::string_view expectation) {
  throw InputError(fmt::format("catheter: {} = {}: expected {}", parameter, value, expectation));
}

void require_sigma(std::string_view parameter, double value) {
  if (!(value >= 0.0 && value < kInfinity)) refuse(parameter, value, "0 or more");
}

void require_positive(std::string_view parameter, double value) {
  if (!(value > 0.0 && value < kInfinity)) refuse(parameter, value, "more than 0");
}

void validate_pose(std::string_view parameter, const Pose& pose) {
  const double error = (pose.R.transpose() * pose.R - Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(error <= kRotationTolerance) || !(pose.R.determinant() > 0.0)) {
    refuse(fmt::format("{} rotation: largest entry of R^T R - I", parameter), error, "a rotation matrix");
  }
  if (!pose.p.allFinite()) refuse(fmt::format("{} position, norm", parameter), pose.p.norm(), "finite numbers");
}

void validate_sensor(const Sensor& sensor, const std::string& name) {
  validate_pose(name + " mounting", sensor.T_local_sensor);
  require_sigma(name + " mount_sigma_m", sensor.mount_sigma_m);
  for (const double sigma : sensor.noise_m) require_positive(name + " noise_m", sigma);
  if (sensor.kind != SensorKind::kPosition) require_positive(name + " noise_rad", sensor.noise_rad);
  require_sigma(name + " bias_m", sensor.bias_m);
  require_sigma(name + " bias_rad", sensor.bias_rad);
  if (sensor.T_tracker_base) validate_pose(name + " base", *sensor.T_tracker_base);
  if (!std::isfinite(sensor.delay_s)) refuse(name + " delay_s", sensor.delay_s, "a finite number");
}

void validate_names(const std::vector<Sensor>& sensors, const BaseRegistration& base) {
  if (sensors.empty() || sensors.size() > static_cast<std::size_t>(kMaxSensors)) {
    refuse("number of sensors", static_cast<double>(sensors.size()), fmt::format("1..{}", kMaxSensors));
  }
  std::vector<std::string> names;
  names.reserve(sensors.size() + 1);
  for (const Sensor& sensor : sensors) names.push_back(sensor.name);
  if (base.tracked) names.push_back(base.sensor.name);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].empty()) throw InputError(fmt::format("catheter: sensor {}: name = '': expected a name", i + 1));
    const auto before = names.begin() + static_cast<std::ptrdiff_t>(i);
    if (std::find(names.begin(), before, names[i]) != before) {
      throw InputError(fmt::format("catheter: sensor name = '{}': expected each name once", names[i]));
    }
  }
}

void validate_base(const BaseRegistration& base) {
  if (!base.tracked) validate_pose("base", base.T_tracker_base);
  require_sigma("base position_sigma_m", base.position_sigma_m);
  require_sigma("base rotation_sigma_rad", base.rotation_sigma_rad);
  if (!base.tracked) return;
  validate_sensor(base.sensor, fmt::format("base sensor '{}'", base.sensor.name));
  if (base.sensor.T_tracker_base) {
    throw InputError(fmt::format("catheter: base sensor '{}': base pose: expected none, for it measures the base",
                                 base.sensor.name));
  }
  if (base.sensor.kind != SensorKind::kPose) {
    throw InputError(
        fmt::format("catheter: base sensor '{}': kind: expected pose, six degrees of freedom", base.sensor.name));
  }
}

}  // namespace

const Vector3d& Catheter::precurvature_per_m() const { return rod.first_flexible().precurvature_per_m; }

Catheter driven_by_map(Catheter catheter) {
  if (!catheter.tendon_map.present) return catheter;
  constexpr double kLeastSigma_per_m = 1e-6;  // a frame may know its bend worse than the map: it needs a parameter
  catheter.precurvature_sigma_per_m.head<2>() = catheter.tendon_map.sigma_per_m.cwiseMax(kLeastSigma_per_m);
  catheter.tendon.present = false;
  return catheter;
}

void Catheter::validate() const {
  rod.validate();
  validate_names(sensors, base);
  const double end_m = rod.length_m() + rod.rigid_tip_m;
  for (const Sensor& sensor : sensors) {
    const std::string name_of = fmt::format("sensor '{}'", sensor.name);
    validate_sensor(sensor, name_of);
    if (!(sensor.arc_length_m >= 0.0 && sensor.arc_length_m <= end_m + kArcTolerance_m)) {
      refuse(name_of + " arc_length_m", sensor.arc_length_m, fmt::format("0..{}, the shaft with its rigid tip", end_m));
    }
  }
  validate_base(base);
  tendon_map.validate();
  require_sigma("tendon offset_m", tendon.offset_m);
  require_sigma("tendon moment_sigma_fraction", tendon.moment_sigma_fraction);
  require_sigma("stiffness_sigma_fraction", stiffness_sigma_fraction);
  if (!(stiffness_correlation >= 0.0 && stiffness_correlation <= 0.999))
    refuse("stiffness_correlation", stiffness_correlation, "0..0.999");
  for (int i = 0; i < 3; ++i) {
    require_sigma(fmt::format("precurvature_sigma_per_m[{}]", i), precurvature_sigma_per_m[i]);
  }
  require_positive("bias_length_m", bias_length_m);
  if (!(bias_memory_s > 0.0 && bias_memory_s <= 1e9))
    refuse("bias_memory_s", bias_memory_s, "more than 0, at most 1e9");
}

}  // namespace palpate
