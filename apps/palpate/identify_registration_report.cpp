// SPDX-License-Identifier: Apache-2.0
#include "identify_registration_report.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <palpate/math/units.hpp>
#include <vector>

namespace palpate::app {

namespace {

std::vector<double> wxyz(const Matrix3d& R) {
  Eigen::Quaterniond q(R);
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  const auto tidy = [](double part) { return std::round(part * 1e12) * 1e-12 + 0.0; };  // no -1e-20
  return {tidy(q.w()), tidy(q.x()), tidy(q.y()), tidy(q.z())};
}

std::vector<double> mm(const Vector3d& v) {
  return {v.x() * kMillimetresPerMetre, v.y() * kMillimetresPerMetre, v.z() * kMillimetresPerMetre};
}

std::vector<double> deg(const Vector3d& v) {
  return {v.x() / kRadiansPerDegree, v.y() / kRadiansPerDegree, v.z() / kRadiansPerDegree};
}

std::string row(const std::vector<double>& v, int decimals) {
  std::string text;
  for (const double value : v) text += fmt::format("{}{:.{}f}", text.empty() ? "" : ", ", value, decimals);
  return "[" + text + "]";
}

/// Tables [[sensor]] of the file: one of them may be the base sensor's, which is not among Catheter::sensors.
std::size_t table_of_sensor(const TomlEdit& edit, const Catheter& catheter, std::size_t sensor) {
  if (!catheter.base.tracked) return sensor;
  std::size_t table = 0, base_table = catheter.sensors.size();
  bool inside = false;
  for (const std::string& line : edit.lines()) {
    if (line.starts_with('[')) {
      inside = line.starts_with("[[sensor]]");
      table += inside ? 1 : 0;
    }
    const bool names_it = line.find(fmt::format("\"{}\"", catheter.base.sensor.name)) != std::string::npos;
    if (inside && line.starts_with("name") && names_it) base_table = table - 1;
  }
  return sensor + (sensor >= base_table ? 1 : 0);
}

bool base_sensor_has_table(const TomlEdit& edit, const Catheter& catheter) {
  return table_of_sensor(edit, catheter, catheter.sensors.size() - 1) == catheter.sensors.size();
}

/// Table of the base sensor: the one that the others leave out.
std::size_t table_of_base_sensor(const TomlEdit& edit, const Catheter& catheter) {
  for (std::size_t i = 0; i < catheter.sensors.size(); ++i)
    if (table_of_sensor(edit, catheter, i) != i) return i;
  return catheter.sensors.size();
}

int frames_of(const Registration& found) {
  int frames = 0;
  for (const auto& position : found.positions) {
    int most = 0;
    for (const auto& residual : position.residuals) most = std::max(most, residual.frames);
    frames += most;
  }
  return frames;
}

void put_base(const Registration& found, const std::string& comment, TomlEdit& edit) {
  const BaseRegistration& base = found.catheter.base;
  const Pose& T = base.tracked ? base.sensor.T_local_sensor : base.T_tracker_base;
  const std::string rotation = toml_array(wxyz(T.R), 9), position = toml_array(mm(T.p), 7);
  const std::string prefix = base.tracked ? "mount_" : "";
  if (base.tracked && base_sensor_has_table(edit, found.catheter)) {
    const std::size_t table = table_of_base_sensor(edit, found.catheter);
    edit.set("sensor", table, "mount_quaternion_wxyz", rotation, comment);
    edit.set("sensor", table, "mount_position_mm", position, comment);
  } else {
    edit.set("base", prefix + "quaternion_wxyz", rotation, comment);
    edit.set("base", prefix + "position_mm", position, comment);
  }
  edit.set("base", "position_sigma_mm", toml_number(base.position_sigma_m * kMillimetresPerMetre, 3),
           "identified: its least certain axis");
  edit.set("base", "rotation_sigma_deg", toml_number(base.rotation_sigma_rad / kRadiansPerDegree, 3),
           "identified: its least certain axis");
}

}  // namespace

void put_registration(const Registration& found, bool mounting, TomlEdit& edit) {
  const std::string comment =
      fmt::format("identified: {} knob positions, {} frames", found.positions.size(), frames_of(found));
  put_base(found, comment, edit);
  const auto& sensors = found.catheter.sensors;
  for (std::size_t i = 0; mounting && i < sensors.size(); ++i) {
    if (sensors[i].T_tracker_base) continue;
    const std::size_t table = table_of_sensor(edit, found.catheter, i);
    const double turned_deg = found.mountings[i].sigma_rad.maxCoeff() / kRadiansPerDegree;
    edit.set(
        "sensor", table, "mount_quaternion_wxyz", toml_array(wxyz(sensors[i].T_local_sensor.R), 9),
        sensors[i].kind == SensorKind::kPosition ? comment : fmt::format("{}; +- {:.2g} deg", comment, turned_deg));
    edit.set("sensor", table, "mount_position_mm", toml_array(mm(sensors[i].T_local_sensor.p), 6), comment);
    edit.set("sensor", table, "mount_sigma_mm", toml_number(sensors[i].mount_sigma_m * kMillimetresPerMetre, 3),
             "identified: its least certain axis");
  }
}

namespace {

void print_base(const Registration& found) {
  const bool tracked = found.catheter.base.tracked;
  const Pose& T = tracked ? found.catheter.base.sensor.T_local_sensor : found.T_reference_base;
  const Eigen::Matrix<double, 6, 1> sigma = found.base_covariance.diagonal().cwiseSqrt();
  fmt::print("{}: position {} mm, quaternion (w, x, y, z) {}\n",
             tracked ? fmt::format("base sensor \"{}\" in the clamp's frame", found.catheter.base.sensor.name)
                     : std::string("base in the tracker's frame"),
             row(mm(T.p), 3), row(wxyz(T.R), 6));
  fmt::print("  sigma of the clamp along e1, e2, e3 {} mm; about them {} deg\n", row(mm(sigma.head<3>()), 3),
             row(deg(sigma.tail<3>()), 3));
}

void print_positions(const Registration& found) {
  fmt::print("  {:<28}{:>18}{:>18}  residual of each sensor\n", "knob position", "k1 [1/m]", "k2 [1/m]");
  for (const auto& position : found.positions) {
    std::string residuals;
    for (const auto& r : position.residuals)
      residuals += r.seen ? fmt::format("  {:.3f} mm {:.3f} deg", r.position_m.norm() * kMillimetresPerMetre,
                                        r.rotation_rad.norm() / kRadiansPerDegree)
                          : std::string("  not seen");
    fmt::print("  {:<28}{:>18}{:>18}{}\n", position.name,
               fmt::format("{:.2f} +- {:.2f}", position.precurvature_per_m.x(), position.sigma_per_m.x()),
               fmt::format("{:.2f} +- {:.2f}", position.precurvature_per_m.y(), position.sigma_per_m.y()), residuals);
  }
}

void print_mountings(const Registration& found) {
  for (std::size_t i = 0; i < found.mountings.size(); ++i) {
    const auto& mounting = found.mountings[i];
    fmt::print("  mounting of \"{}\": position {} +- {} mm, turned by {} +- {} deg\n", found.catheter.sensors[i].name,
               row(mm(mounting.T_local_sensor.p), 3), row(mm(mounting.sigma_m), 3),
               row(deg(log_so3(mounting.T_local_sensor.R)), 3), row(deg(mounting.sigma_rad), 3));
  }
}

bool states_bias(const Catheter& catheter) {
  return std::any_of(catheter.sensors.begin(), catheter.sensors.end(),
                     [](const Sensor& sensor) { return sensor.bias_m > 0.0 || sensor.bias_rad > 0.0; });
}

}  // namespace

void print_registration(const Registration& found, bool mounting, const std::string& out) {
  fmt::print("{} knob positions, {} sensors, {} frames -> {}\n", found.positions.size(), found.catheter.sensors.size(),
             frames_of(found), out);
  print_base(found);
  print_positions(found);
  if (mounting) print_mountings(found);
  fmt::print("rms residual {:.3f} mm, {:.3f} deg; chi-square {:.1f} for {} degrees of freedom (stated noise)\n",
             found.position_rms_m * kMillimetresPerMetre, found.rotation_rms_rad / kRadiansPerDegree, found.chi_square,
             found.degrees_of_freedom);
  if (!states_bias(found.catheter))
    fmt::print("sigmas are of white noise alone, for the catheter file states no bias_mm or bias_deg\n");
}

void print_registration_json(const Registration& found, bool mounting, const std::string& out) {
  const BaseRegistration& base = found.catheter.base;
  const Pose& T = base.tracked ? base.sensor.T_local_sensor : base.T_tracker_base;
  const Eigen::Matrix<double, 6, 1> sigma = found.base_covariance.diagonal().cwiseSqrt();
  nlohmann::json json{
      {"out", out},
      {"converged", found.converged},
      {"frames", frames_of(found)},
      {base.tracked ? "base_sensor_mounting" : "base", {{"quaternion_wxyz", wxyz(T.R)}, {"position_mm", mm(T.p)}}},
      {"base_sigma_mm", mm(sigma.head<3>())},
      {"base_sigma_deg", deg(sigma.tail<3>())},
      {"position_rms_mm", found.position_rms_m * kMillimetresPerMetre},
      {"rotation_rms_deg", found.rotation_rms_rad / kRadiansPerDegree},
      {"chi_square", found.chi_square},
      {"degrees_of_freedom", found.degrees_of_freedom},
      {"sigma_inflation", found.sigma_inflation},
      {"starts", found.starts},
      {"iterations", found.iterations},
      {"warnings", found.warnings}};
  for (const auto& position : found.positions) {
    nlohmann::json entry{{"name", position.name},
                         {"k1_per_m", position.precurvature_per_m.x()},
                         {"k2_per_m", position.precurvature_per_m.y()},
                         {"tau_per_m", position.precurvature_per_m.z()},
                         {"k1_sigma_per_m", position.sigma_per_m.x()},
                         {"k2_sigma_per_m", position.sigma_per_m.y()}};
    for (std::size_t i = 0; i < position.residuals.size(); ++i)
      if (const auto& r = position.residuals[i]; r.seen)
        entry["residuals"][found.catheter.sensors[i].name] = {
            {"frames", r.frames}, {"position_mm", mm(r.position_m)}, {"rotation_deg", deg(r.rotation_rad)}};
    json["positions"].push_back(entry);
  }
  for (std::size_t i = 0; mounting && i < found.mountings.size(); ++i)
    json["mountings"][found.catheter.sensors[i].name] = {{"position_mm", mm(found.mountings[i].T_local_sensor.p)},
                                                         {"quaternion_wxyz", wxyz(found.mountings[i].T_local_sensor.R)},
                                                         {"sigma_mm", mm(found.mountings[i].sigma_m)},
                                                         {"sigma_deg", deg(found.mountings[i].sigma_rad)}};
  fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

}  // namespace palpate::app
