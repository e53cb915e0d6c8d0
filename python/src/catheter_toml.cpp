// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <apps/palpate/estimate_options.hpp>
#include <cmath>
#include <palpate/math/units.hpp>
#include <palpate/recording/catheter_tendon_map.hpp>

#include "catheter_parts.hpp"
#include "toml_text.hpp"

namespace palpate::python {
namespace {

constexpr double kMm = kMetresPerMillimetre, kDeg = kRadiansPerDegree, kPercent = 0.01;

void put_stiffness(const Section& section, TomlText& out) {
  out.numbers("bending_stiffness_Nm2", section.stiffness_Nm2.head<2>());
  out.number("torsional_stiffness_Nm2", section.stiffness_Nm2.z());
}

void put_sections(const Rod& rod, TomlText& out) {
  if (rod.sections.size() == 1 && !rod.sections.front().rigid) return;
  for (const Section& section : rod.sections) {
    out.entry("catheter.section");
    out.number("from_mm", section.from_m, kMm);
    out.number("to_mm", section.to_m, kMm);
    if (section.rigid)
      out.raw("rigid", "true");
    else
      put_stiffness(section, out);
    out.numbers("precurvature_per_m", section.precurvature_per_m);
  }
}

void put_shaft(const Catheter& catheter, TomlText& out) {
  const Rod& rod = catheter.rod;
  const Section& shaft = rod.first_flexible();
  out.table("catheter");
  if (!catheter.name.empty()) out.text("name", catheter.name);
  out.number("length_mm", rod.length_m(), kMm);
  if (!shaft.rigid) put_stiffness(shaft, out);
  out.number("stiffness_sigma_percent", catheter.stiffness_sigma_fraction, kPercent);
  out.number("stiffness_correlation", catheter.stiffness_correlation);
  out.numbers("precurvature_per_m", shaft.precurvature_per_m);
  out.numbers("precurvature_sigma_per_m", catheter.precurvature_sigma_per_m);
  out.number_unless(0.0, "shear_stiffness_N", rod.shear_stiffness_N);
  out.number_unless(0.0, "axial_stiffness_N", rod.axial_stiffness_N);
  out.number("rigid_tip_mm", rod.rigid_tip_m, kMm);
  out.numbers("contact_offset_mm", rod.contact_offset_m, kMm);
  const Vector3d& load_N_per_m = rod.distributed_load_base_N_per_m;
  const double weight_N_per_m = std::hypot(load_N_per_m.x(), load_N_per_m.y(), load_N_per_m.z());
  out.number_unless(0.0, "weight_N_per_m", weight_N_per_m);
  put_sections(rod, out);
  if (!rod.has_distributed_load()) return;
  out.table("gravity");
  out.numbers("direction_in_base", Vector3d(load_N_per_m / weight_N_per_m));
}

void put_tendon(const Catheter& catheter, TomlText& out) {
  const Tendon& tendon = catheter.tendon;
  if (tendon.present) {
    out.table("tendon");
    out.text("model", tendon.model == TendonModel::kCouple ? "couple" : "end_moment");
    out.number_unless(0.0, "offset_mm", tendon.offset_m, kMm);
    out.number("moment_sigma_percent", tendon.moment_sigma_fraction, kPercent);
  }
  const TendonMap& map = catheter.tendon_map;
  if (!map.present) return;
  const auto axis = [&](const char* key, const std::vector<Eigen::Vector2d>& branch, int i) {
    std::vector<double> values;
    values.reserve(branch.size());
    for (const Eigen::Vector2d& k : branch) values.push_back(k(i));
    out.numbers(key, values);
  };
  out.table("tendon_map");
  out.text("input", palpate::name_of(map.input));
  out.numbers("position", map.position, si_per_unit(map.input));
  axis("pull_k1_per_m", map.pull_per_m, 0);
  axis("release_k1_per_m", map.release_per_m, 0);
  axis("pull_k2_per_m", map.pull_per_m, 1);
  axis("release_k2_per_m", map.release_per_m, 1);
  out.numbers("sigma_per_m", map.sigma_per_m);
}

/// What [[sensor]] and a base sensor in [base] have in common.
void put_properties(const Sensor& sensor, TomlText& out) {
  const Pose& mount = sensor.T_local_sensor;
  if (!mount.R.isIdentity(0.0)) out.rotation("mount_quaternion_wxyz", mount.R);
  if (!mount.p.isZero(0.0)) out.numbers("mount_position_mm", mount.p, kMm);
  out.number_unless(0.0, "mount_sigma_mm", sensor.mount_sigma_m, kMm);
  if ((sensor.noise_m.array() == sensor.noise_m.x()).all())
    out.number("noise_mm", sensor.noise_m.x(), kMm);
  else
    out.numbers("noise_axes_mm", sensor.noise_m, kMm);
  out.number("noise_deg", sensor.noise_rad, kDeg);
  out.number_unless(0.0, "bias_mm", sensor.bias_m, kMm);
  out.number_unless(0.0, "bias_deg", sensor.bias_rad, kDeg);
  out.number_unless(0.0, "delay_s", sensor.delay_s);
  if (!sensor.markers.empty()) out.texts("markers", sensor.markers);
}

void put_base(const BaseRegistration& base, TomlText& out) {
  out.table("base");
  if (base.tracked) {
    out.text("sensor", base.sensor.name);
    put_properties(base.sensor, out);
  } else {
    out.rotation("quaternion_wxyz", base.T_tracker_base.R);
    out.numbers("position_mm", base.T_tracker_base.p, kMm);
  }
  out.number("position_sigma_mm", base.position_sigma_m, kMm);
  out.number("rotation_sigma_deg", base.rotation_sigma_rad, kDeg);
}

void put_sensors(const Catheter& catheter, TomlText& out) {
  for (const Sensor& sensor : catheter.sensors) {
    out.entry("sensor");
    out.text("name", sensor.name);
    out.text("kind", name_of(sensor.kind));
    out.number("arc_length_mm", sensor.arc_length_m, kMm);
    put_properties(sensor, out);
    if (!sensor.T_tracker_base) continue;
    out.rotation("base_quaternion_wxyz", sensor.T_tracker_base->R);
    out.numbers("base_position_mm", sensor.T_tracker_base->p, kMm);
  }
  out.table("tracker");
  out.number("bias_length_mm", catheter.bias_length_m, kMm);
  out.number("bias_memory_s", catheter.bias_memory_s);
}

/// What is not as it is anyway.
void put_estimator(const ObserverOptions& options, TomlText& out) {
  const ObserverOptions usual;
  using O = ObserverOptions;
  const auto choice = [&](const char* key, auto member) {
    if (options.*member != usual.*member) out.text(key, app::name_of(options.*member));
  };
  const auto number = [&](const char* key, double O::*member, double unit = 1.0) {
    out.number_unless(usual.*member, key, options.*member, unit);
  };
  const auto whole = [&](const char* key, int O::*member) {
    if (options.*member != usual.*member) out.raw(key, fmt::format("{}", options.*member));
  };
  out.table("estimator");
  std::vector<std::string> state{"force"};
  if (options.estimate_stiffness) state.emplace_back("stiffness");
  if (options.estimate_precurvature) state.emplace_back("precurvature");
  out.texts("state", state);
  choice("method", &O::method);
  choice("measurement", &O::measurement);
  choice("force_model", &O::force_model);
  if (options.free_torsion) out.text("torsion", "free");
  if (!options.consider_uncertainty) out.raw("consider", "false");
  number("stiffness_rate_percent_per_s", &O::stiffness_rate_per_s, kPercent);
  number("stiffness_drift_percent_per_sqrt_s", &O::stiffness_drift_per_sqrt_s, kPercent);
  number("precurvature_drift_per_m_sqrt_s", &O::precurvature_drift_per_m_sqrt_s);
  number("force_rate_N_per_sqrt_s", &O::force_rate_N_per_sqrt_s);
  number("force_acceleration_N_per_s_sqrt_s", &O::force_acceleration_N_per_s_sqrt_s);
  number("force_memory_s", &O::force_memory_s);
  number("disturbance_rms_N", &O::disturbance_rms_N);
  number("disturbance_memory_s", &O::disturbance_memory_s);
  number("initial_force_sigma_N", &O::initial_force_sigma_N);
  whole("max_iterations", &O::max_iterations);
  whole("adaptation_window", &O::adaptation_window);
  number("outlier_probability", &O::outlier_probability);
  number("jump_probability", &O::jump_probability);
  number("noise_tail_degrees", &O::noise_tail_degrees);
}

/// What is said of recordings of it.
void put_recordings(const CatheterFile& file, TomlText& out) {
  if (!file.ignore_sensors.empty()) {
    out.table("recording");
    out.texts("ignore_sensors", file.ignore_sensors);
  }
  if (file.reference.given) {
    out.table("reference");
    out.number("from_s", file.reference.from_s);
    out.number("to_s", file.reference.to_s);
    out.text("shape", file.reference.straight ? "straight" : "unloaded");
  }
  for (const KnownLoadInterval& interval : file.known_loads) {
    out.entry("known_load");
    out.number("from_s", interval.from_s);
    out.number("to_s", interval.to_s);
    out.numbers(interval.load.in_base ? "force_base_N" : "force_tip_N", interval.load.force_N);
    out.number("sigma_N", interval.load.sigma_N);
  }
}

}  // namespace

std::string catheter_toml(const CatheterFile& file) {
  TomlText out;
  put_shaft(file.catheter, out);
  put_tendon(file.catheter, out);
  put_base(file.catheter.base, out);
  put_sensors(file.catheter, out);
  put_estimator(file.observer, out);
  put_recordings(file, out);
  std::string text = out.take();
  catheter_from_text(text, "to_toml");  // a file may not say all that arguments may
  return text;
}

}  // namespace palpate::python
