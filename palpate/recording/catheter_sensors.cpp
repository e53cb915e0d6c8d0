// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <palpate/math/units.hpp>
#include <palpate/recording/catheter_sensors.hpp>

namespace palpate {
namespace {

constexpr double kArcTolerance_mm = 1e-9;
constexpr NumberRange kAny = {-1e300, 1e300, "a number in mm"};
constexpr NumberRange kQuaternion = {-2.0, 2.0, "part of a unit quaternion"};
constexpr NumberRange kMountPosition = {-1000.0, 1000.0, "a length in mm, at most 1000"};
constexpr NumberRange kBasePosition = {-1e5, 1e5, "a length in mm, at most 1e5"};
constexpr NumberRange kDelay_s = {-1e9, 1e9, "a time in seconds"};
constexpr NumberRange kSigma_mm = {0.0, 100.0, "a standard deviation in mm, 0..100"};
constexpr NumberRange kSigma_deg = {0.0, 90.0, "a standard deviation in degrees, 0..90"};
constexpr NumberRange kNoise_mm = {1e-9, 50.0, "a standard deviation in mm, more than 0, at most 50 (is it in um?)"};
constexpr NumberRange kNoise_deg = {1e-9, 90.0, "a standard deviation in degrees, more than 0, at most 90"};
constexpr NumberRange kBiasLength_mm = {1e-9, 1e6, "a length in mm, more than 0, at most 1e6"};
constexpr NumberRange kBiasMemory_s = {1e-300, 1e9, "seconds, more than 0, at most 1e9"};

Matrix3d read_rotation(const TomlTable& table, std::string_view key) {
  const auto q = table.optional_vector<4>(key, kQuaternion);
  if (!q) return Matrix3d::Identity();
  if (!(std::abs(q->norm() - 1.0) <= 1e-3)) {
    table.refuse(key, fmt::format("a unit quaternion [w, x, y, z], here of norm {:.6g}", q->norm()));
  }
  return Eigen::Quaterniond((*q)[0], (*q)[1], (*q)[2], (*q)[3]).normalized().toRotationMatrix();
}

Vector3d read_position(const TomlTable& table, std::string_view key, const NumberRange& each) {
  return table.optional_vector<3>(key, each).value_or(Vector3d::Zero()) * kMetresPerMillimetre;
}

/// noise_mm, alike along all axes, or noise_axes_mm, one for each base axis.
Vector3d read_position_noise(const TomlTable& table, const Vector3d& fallback_m) {
  if (const auto axes = table.optional_vector<3>("noise_axes_mm", kNoise_mm)) {
    if (table.has("noise_mm")) table.refuse("noise_axes_mm", "either noise_mm or noise_axes_mm");
    return *axes * kMetresPerMillimetre;
  }
  const double alike_mm = table.number("noise_mm", kNoise_mm, fallback_m.x() * kMillimetresPerMetre);
  return Vector3d::Constant(alike_mm * kMetresPerMillimetre);
}

/// What [[sensor]] and a base sensor described in [base] have in common.
Sensor read_properties(const TomlTable& table, std::string name) {
  Sensor sensor;
  sensor.name = std::move(name);
  sensor.T_local_sensor.R = read_rotation(table, "mount_quaternion_wxyz");
  sensor.T_local_sensor.p = read_position(table, "mount_position_mm", kMountPosition);
  sensor.mount_sigma_m = table.number("mount_sigma_mm", kSigma_mm, 0.0) * kMetresPerMillimetre;
  sensor.noise_m = read_position_noise(table, sensor.noise_m);
  sensor.noise_rad = table.number("noise_deg", kNoise_deg, sensor.noise_rad / kRadiansPerDegree) * kRadiansPerDegree;
  sensor.bias_m = table.number("bias_mm", kSigma_mm, 0.0) * kMetresPerMillimetre;
  sensor.bias_rad = table.number("bias_deg", kSigma_deg, 0.0) * kRadiansPerDegree;
  sensor.delay_s = table.number("delay_s", kDelay_s, 0.0);
  sensor.markers = table.texts("markers");
  return sensor;
}

double read_arc_length(const TomlTable& table, double end_mm) {
  const double arc_mm = table.number("arc_length_mm", kAny);
  if (!(arc_mm >= 0.0 && arc_mm <= end_mm + kArcTolerance_mm)) {
    table.refuse("arc_length_mm", fmt::format("0..{:.10g} mm, the shaft with its rigid tip", end_mm));
  }
  if (arc_mm > 0.0 && arc_mm * kMillimetresPerMetre <= end_mm + kArcTolerance_mm) {
    table.refuse("arc_length_mm", fmt::format("millimetres along a shaft of {:.10g} mm (is it in metres?)", end_mm));
  }
  return arc_mm * kMetresPerMillimetre;
}

/// The clamp in the frame of the sensor's own tracker or image, where that is not the one that [base] speaks of.
std::optional<Pose> read_own_base(const TomlTable& table, bool is_base) {
  constexpr std::array<std::string_view, 2> kKeys = {"base_quaternion_wxyz", "base_position_mm"};
  if (std::none_of(kKeys.begin(), kKeys.end(), [&](std::string_view key) { return table.has(key); })) return {};
  for (const std::string_view key : kKeys)
    if (is_base && table.has(key)) table.refuse(key, "no such key, for this is the base sensor");
  for (const std::string_view key : kKeys) {
    if (!table.has(key))
      table.refuse(key, "base_quaternion_wxyz and base_position_mm, both, of the clamp in this sensor's own tracker");
  }
  return Pose{read_rotation(table, kKeys[0]), read_position(table, kKeys[1], kBasePosition)};
}

Sensor read_sensor(const TomlTable& table, const std::string& base_name, double end_mm) {
  Sensor sensor = read_properties(table, table.text("name"));
  sensor.kind = table.choice<SensorKind>(
      "kind", {{"pose", SensorKind::kPose}, {"pose5", SensorKind::kPose5}, {"position", SensorKind::kPosition}},
      SensorKind::kPose);
  const bool is_base = sensor.name == base_name;
  if (is_base && sensor.kind != SensorKind::kPose) table.refuse("kind", "'pose', for this is the base sensor");
  if (!is_base) sensor.arc_length_m = read_arc_length(table, end_mm);
  sensor.T_tracker_base = read_own_base(table, is_base);
  return sensor;
}

void place_sensor(const TomlTable& table, Sensor sensor, Catheter& catheter, std::vector<std::string>& names) {
  if (std::find(names.begin(), names.end(), sensor.name) != names.end()) table.refuse("name", "each name once");
  names.push_back(sensor.name);
  if (catheter.base.tracked && sensor.name == catheter.base.sensor.name) {
    catheter.base.sensor = std::move(sensor);
    return;
  }
  if (catheter.sensors.size() >= static_cast<std::size_t>(kMaxSensors)) {
    table.refuse("name", fmt::format("at most {} sensors on the shaft", kMaxSensors));
  }
  catheter.sensors.push_back(std::move(sensor));
}

constexpr std::string_view kBaseSensorKeys[] = {"mount_quaternion_wxyz",
                                                "mount_position_mm",
                                                "mount_sigma_mm",
                                                "noise_mm",
                                                "noise_axes_mm",
                                                "noise_deg",
                                                "bias_mm",
                                                "bias_deg",
                                                "markers",
                                                "delay_s"};

void refuse_base_sensor_keys(const TomlTable& base, std::string_view expectation) {
  for (const std::string_view key : kBaseSensorKeys) {
    if (base.has(key)) base.refuse(key, expectation);
  }
}

TomlTable find_base(const TomlTable& root) {
  const auto base =
      root.table("base", {"quaternion_wxyz", "position_mm", "position_sigma_mm", "rotation_sigma_deg", "sensor",
                          "mount_quaternion_wxyz", "mount_position_mm", "mount_sigma_mm", "noise_mm", "noise_axes_mm",
                          "noise_deg", "bias_mm", "bias_deg", "markers", "delay_s"});
  if (!base) root.refuse("base", "a table [base] with quaternion_wxyz and position_mm, or with sensor");
  return *base;
}

void read_fixed_base(const TomlTable& table, BaseRegistration& base) {
  refuse_base_sensor_keys(table, "this key only together with base.sensor");
  for (const char* key : {"quaternion_wxyz", "position_mm"}) {
    if (!table.has(key)) table.refuse(key, "quaternion_wxyz and position_mm of the clamp in the tracker, or sensor");
  }
  base.T_tracker_base.R = read_rotation(table, "quaternion_wxyz");
  base.T_tracker_base.p = read_position(table, "position_mm", kBasePosition);
}

void read_base(const TomlTable& table, BaseRegistration& base) {
  base.position_sigma_m = table.number("position_sigma_mm", kSigma_mm, 0.0) * kMetresPerMillimetre;
  base.rotation_sigma_rad = table.number("rotation_sigma_deg", kSigma_deg, 0.0) * kRadiansPerDegree;
  base.tracked = table.has("sensor");
  if (!base.tracked) return read_fixed_base(table, base);
  for (const char* key : {"quaternion_wxyz", "position_mm"}) {
    if (table.has(key)) table.refuse(key, "either this, or sensor");
  }
  base.sensor.name = table.text("sensor");
}

/// The base sensor is one of the [[sensor]] entries, or described by [base] itself.
void finish_base_sensor(const TomlTable& table, const std::vector<std::string>& names, BaseRegistration& base) {
  if (!base.tracked) return;
  if (std::find(names.begin(), names.end(), base.sensor.name) != names.end()) {
    refuse_base_sensor_keys(table, fmt::format("this key in the [[sensor]] entry '{}'", base.sensor.name));
  } else {
    base.sensor = read_properties(table, base.sensor.name);
  }
}

/// How far, in space and time, the tracker's accuracy error stays alike.
void read_tracker(const TomlTable& root, Catheter& catheter) {
  const auto table = root.table("tracker", {"bias_length_mm", "bias_memory_s"});
  if (!table) return;
  catheter.bias_length_m =
      table->number("bias_length_mm", kBiasLength_mm, catheter.bias_length_m * kMillimetresPerMetre) *
      kMetresPerMillimetre;
  catheter.bias_memory_s = table->number("bias_memory_s", kBiasMemory_s, catheter.bias_memory_s);
}

}  // namespace

void read_sensors(const TomlTable& root, Catheter& catheter) {
  const TomlTable base = find_base(root);
  read_base(base, catheter.base);
  const double end_mm = (catheter.rod.length_m() + catheter.rod.rigid_tip_m) * kMillimetresPerMetre;
  std::vector<std::string> names;
  for (const TomlTable& table :
       root.tables("sensor", {"name", "kind", "arc_length_mm", "mount_quaternion_wxyz", "mount_position_mm",
                              "mount_sigma_mm", "noise_mm", "noise_axes_mm", "noise_deg", "bias_mm", "bias_deg",
                              "markers", "delay_s", "base_quaternion_wxyz", "base_position_mm"})) {
    place_sensor(table, read_sensor(table, catheter.base.sensor.name, end_mm), catheter, names);
  }
  if (catheter.sensors.empty()) root.refuse("sensor", "at least one [[sensor]] on the shaft");
  finish_base_sensor(base, names, catheter.base);
  read_tracker(root, catheter);
}

}  // namespace palpate
