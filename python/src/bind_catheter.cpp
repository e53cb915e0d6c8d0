// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <palpate/math/errors.hpp>
#include <palpate/recording/text_table.hpp>

#include "arrays.hpp"
#include "bindings.hpp"

namespace palpate::python {
namespace {

constexpr std::array<std::pair<std::string_view, SensorKind>, 3> kKinds{
    {{"pose", SensorKind::kPose}, {"pose5", SensorKind::kPose5}, {"position", SensorKind::kPosition}}};

std::string_view name_of(SensorKind kind) { return kKinds[static_cast<std::size_t>(kind)].first; }

SensorKind kind_of(const std::string& text) {
  for (const auto& [name, kind] : kKinds)
    if (name == text) return kind;
  throw InputError(fmt::format("kind = '{}': expected pose, pose5 or position", printable(text)));
}

Pose make_pose(const py::object& R, const py::object& p) {
  Pose pose;
  if (!R.is_none()) pose.R = rotation(R, "R");
  if (!p.is_none()) pose.p = vector3(p, "p");
  return pose;
}

Vector3d alike_or_by_axis(const py::object& value, std::string_view name) {
  if (py::isinstance<py::float_>(value) || PyLong_Check(value.ptr())) return Vector3d::Constant(number(value, name));
  return vector3(value, name);
}

void set(double& out, const py::object& value, std::string_view name) {
  if (!value.is_none()) out = number(value, name);
}

Sensor make_sensor(const py::object& name, const py::object& kind, const py::object& arc_length_m,
                   const py::object& noise_m, const py::object& noise_rad, const std::optional<Pose>& T_local_sensor,
                   const py::object& mount_sigma_m, const py::object& bias_m, const py::object& bias_rad,
                   const py::object& delay_s) {
  Sensor sensor;
  sensor.name = word(name, "name");
  sensor.kind = kind_of(word(kind, "kind"));
  sensor.arc_length_m = number(arc_length_m, "arc_length_m");
  if (!noise_m.is_none()) sensor.noise_m = alike_or_by_axis(noise_m, "noise_m");
  set(sensor.noise_rad, noise_rad, "noise_rad");
  if (T_local_sensor) sensor.T_local_sensor = *T_local_sensor;
  set(sensor.mount_sigma_m, mount_sigma_m, "mount_sigma_m");
  set(sensor.bias_m, bias_m, "bias_m");
  set(sensor.bias_rad, bias_rad, "bias_rad");
  set(sensor.delay_s, delay_s, "delay_s");
  return sensor;
}

void bind_sensor(py::module_& m) {
  py::class_<Pose>(m, "Pose",
                   "Rigid motion T_a_b: p_a = R p_b + p.\n\nR (3, 3) a rotation matrix, p (3,) [m]; default: none. "
                   "T_a_b @ T_b_c; inverse(); apply(point (3,)). Raises InputError where R is no rotation.")
      .def(py::init(&make_pose), py::arg("R") = py::none(), py::arg("p") = py::none())
      .def_readonly("R", &Pose::R)
      .def_readonly("p", &Pose::p)
      .def("inverse", &Pose::inverse)
      .def(
          "__matmul__", [](const Pose& a, const Pose& b) { return a * b; }, py::is_operator())
      .def(
          "apply", [](const Pose& a, const py::object& point) { return Vector3d(a * vector3(point, "point")); },
          py::arg("point"))
      .def("__repr__", [](const Pose& pose) {
        return fmt::format("Pose(p=[{:g}, {:g}, {:g}] m, ...)", pose.p.x(), pose.p.y(), pose.p.z());
      });
  py::class_<Sensor>(
      m, "Sensor",
      "A tracked sensor on the shaft.\n\nname\nkind            \"pose\" (6 degrees of freedom), \"pose5\" (no roll "
      "about its z axis), \"position\"\narc_length_m    from the clamp, up to length plus rigid tip\nnoise_m         "
      "white, one sigma, a number or (3,) along the base axes; noise_rad per axis\nT_local_sensor  mounting: Pose in "
      "the local frame (d1, d2, d3); mount_sigma_m\nbias_m, bias_rad  slowly varying accuracy error, rms in "
      "3-D\ndelay_s         its time stamps are later than the event by this much\n\nRaises InputError naming the "
      "argument. Source: palpate/sensing/catheter.hpp.")
      .def(py::init(&make_sensor), py::arg("name"), py::arg("kind") = "pose", py::arg("arc_length_m") = 0.0,
           py::arg("noise_m") = py::none(), py::arg("noise_rad") = py::none(), py::kw_only(),
           py::arg("T_local_sensor") = py::none(), py::arg("mount_sigma_m") = py::none(),
           py::arg("bias_m") = py::none(), py::arg("bias_rad") = py::none(), py::arg("delay_s") = py::none())
      .def_readonly("name", &Sensor::name)
      .def_property_readonly("kind", [](const Sensor& s) { return std::string(name_of(s.kind)); })
      .def_readonly("arc_length_m", &Sensor::arc_length_m)
      .def_readonly("T_local_sensor", &Sensor::T_local_sensor)
      .def_readonly("noise_m", &Sensor::noise_m)
      .def_readonly("noise_rad", &Sensor::noise_rad)
      .def_readonly("mount_sigma_m", &Sensor::mount_sigma_m)
      .def_readonly("bias_m", &Sensor::bias_m)
      .def_readonly("bias_rad", &Sensor::bias_rad)
      .def_readonly("delay_s", &Sensor::delay_s)
      .def("__repr__", [](const Sensor& s) {
        return fmt::format("Sensor({:?}, kind='{}', arc_length_m={:g})", s.name, name_of(s.kind), s.arc_length_m);
      });
}

/// From keywords: one section, an untracked base.
CatheterFile make_catheter(const py::object& length_m, const py::object& bending_stiffness_Nm2,
                           const py::object& torsional_stiffness_Nm2, const py::object& precurvature_per_m,
                           const std::vector<Sensor>& sensors, const std::optional<Pose>& base, const py::object& name,
                           const py::object& rigid_tip_m, const py::object& contact_offset_m,
                           const py::object& distributed_load_base_N_per_m, const py::object& stiffness_sigma_fraction,
                           const py::object& precurvature_sigma_per_m, const py::object& base_position_sigma_m,
                           const py::object& base_rotation_sigma_rad) {
  CatheterFile file;
  Catheter& catheter = file.catheter;
  const Eigen::Vector2d EI = vector2(bending_stiffness_Nm2, "bending_stiffness_Nm2");
  const double GJ = number(torsional_stiffness_Nm2, "torsional_stiffness_Nm2");
  catheter.rod = uniform_rod(number(length_m, "length_m"), {EI.x(), EI.y(), GJ},
                             vector3(precurvature_per_m, "precurvature_per_m"));
  set(catheter.rod.rigid_tip_m, rigid_tip_m, "rigid_tip_m");
  catheter.rod.contact_offset_m = vector3(contact_offset_m, "contact_offset_m");
  catheter.rod.distributed_load_base_N_per_m = vector3(distributed_load_base_N_per_m, "distributed_load_base_N_per_m");
  catheter.name = word(name, "name");
  catheter.sensors = sensors;
  if (base) catheter.base.T_tracker_base = *base;
  set(catheter.base.position_sigma_m, base_position_sigma_m, "base_position_sigma_m");
  set(catheter.base.rotation_sigma_rad, base_rotation_sigma_rad, "base_rotation_sigma_rad");
  set(catheter.stiffness_sigma_fraction, stiffness_sigma_fraction, "stiffness_sigma_fraction");
  catheter.precurvature_sigma_per_m = vector3(precurvature_sigma_per_m, "precurvature_sigma_per_m");
  catheter.validate();
  return file;
}

CatheterFile catheter_from_text(const std::string& text, const std::string& name) {
  TextFile file{.name = name, .lines = {}};
  for (const std::string_view line : split(text, '\n')) file.lines.emplace_back(line);
  return parse_catheter(file);
}

py::object tendon_model(const CatheterFile& file) {
  const Tendon& tendon = file.catheter.tendon;
  if (!tendon.present) return py::none();
  return py::str(tendon.model == TendonModel::kCouple ? "couple" : "end_moment");
}

void bind_shaft_properties(py::class_<CatheterFile>& c) {
  const auto shaft = [](const CatheterFile& f) -> const Section& { return f.catheter.rod.first_flexible(); };
  c.def_property_readonly("name", [](const CatheterFile& f) { return f.catheter.name; })
      .def_property_readonly("length_m", [](const CatheterFile& f) { return f.catheter.rod.length_m(); })
      .def_property_readonly("rigid_tip_m", [](const CatheterFile& f) { return f.catheter.rod.rigid_tip_m; })
      .def_property_readonly("contact_offset_m", [](const CatheterFile& f) { return f.catheter.rod.contact_offset_m; })
      .def_property_readonly(
          "bending_stiffness_Nm2",
          [shaft](const CatheterFile& f) { return Eigen::Vector2d(shaft(f).stiffness_Nm2.head<2>()); })
      .def_property_readonly("torsional_stiffness_Nm2",
                             [shaft](const CatheterFile& f) { return shaft(f).stiffness_Nm2.z(); })
      .def_property_readonly("precurvature_per_m",
                             [](const CatheterFile& f) { return Vector3d(f.catheter.precurvature_per_m()); })
      .def_property_readonly("distributed_load_base_N_per_m",
                             [](const CatheterFile& f) { return f.catheter.rod.distributed_load_base_N_per_m; })
      .def_property_readonly("sections", [](const CatheterFile& f) { return f.catheter.rod.sections.size(); })
      .def_property_readonly("tendon", &tendon_model);
}

}  // namespace

std::size_t readings_of(const Catheter& catheter) { return catheter.sensors.size() + (catheter.base.tracked ? 1 : 0); }

void require_readings(const Catheter& catheter, std::size_t readings, const char* argument) {
  if (readings == readings_of(catheter)) return;
  std::string names;
  for (const Sensor& sensor : catheter.sensors) names += fmt::format("{}{}", names.empty() ? "" : ", ", sensor.name);
  if (catheter.base.tracked) names += fmt::format(", {}", catheter.base.sensor.name);
  throw InputError(fmt::format("{}: of {} sensors: expected {}, in the order of the catheter: {}", argument, readings,
                               readings_of(catheter), names));
}

void bind_catheter(py::module_& m) {
  bind_sensor(m);
  py::class_<CatheterFile> c(
      m, "Catheter",
      "One catheter in one setup: shaft, sensors, base, how well each number is known, and how to estimate with "
      "it.\n\nCatheter.from_toml(path) and Catheter.from_text(text) read a catheter file (docs/reference/formats.md), "
      "with its [estimator]; by keywords, one section and a base that is not tracked:\n\n"
      "length_m                       clamp to the end of the flexible shaft\n"
      "bending_stiffness_Nm2          (2,) EI1 about d1, EI2 about d2; torsional_stiffness_Nm2: GJ\n"
      "precurvature_per_m             (3,) k1,0 k2,0 tau0 of the unloaded shaft\n"
      "sensors                        list of Sensor, 1 to 8\n"
      "base                           Pose T_tracker_base of the clamp\n"
      "rigid_tip_m, contact_offset_m  (3,) where the force acts, from the flexible end, local axes there\n"
      "distributed_load_base_N_per_m  (3,) own weight, base frame\n"
      "*_sigma_*                      one standard deviation of what is not known exactly\n\n"
      "Immutable. Raises InputError `FILE:LINE: KEY = VALUE: expected ...`, or naming the argument.");
  const auto zero = py::make_tuple(0.0, 0.0, 0.0);
  c.def(py::init(&make_catheter), py::kw_only(), py::arg("length_m"), py::arg("bending_stiffness_Nm2"),
        py::arg("torsional_stiffness_Nm2"), py::arg("precurvature_per_m") = zero, py::arg("sensors"),
        py::arg("base") = py::none(), py::arg("name") = "", py::arg("rigid_tip_m") = 0.0,
        py::arg("contact_offset_m") = zero, py::arg("distributed_load_base_N_per_m") = zero,
        py::arg("stiffness_sigma_fraction") = 0.0, py::arg("precurvature_sigma_per_m") = zero,
        py::arg("base_position_sigma_m") = 0.0, py::arg("base_rotation_sigma_rad") = 0.0);
  c.def_static(
      "from_toml", [](const py::object& path) { return read_catheter_file(path_text(path, "path")); }, py::arg("path"));
  c.def_static(
      "from_text",
      [](const py::object& text, const py::object& name) {
        return catheter_from_text(word(text, "text"), word(name, "name"));
      },
      py::arg("text"), py::arg("name") = "catheter");
  bind_shaft_properties(c);
  c.def_property_readonly("sensors", [](const CatheterFile& f) { return f.catheter.sensors; })
      .def_property_readonly("base_sensor",
                             [](const CatheterFile& f) {
                               return f.catheter.base.tracked ? std::optional(f.catheter.base.sensor) : std::nullopt;
                             })
      .def_property_readonly("T_tracker_base", [](const CatheterFile& f) { return f.catheter.base.T_tracker_base; })
      .def_property_readonly("base_position_sigma_m",
                             [](const CatheterFile& f) { return f.catheter.base.position_sigma_m; })
      .def_property_readonly("base_rotation_sigma_rad",
                             [](const CatheterFile& f) { return f.catheter.base.rotation_sigma_rad; })
      .def_property_readonly("stiffness_sigma_fraction",
                             [](const CatheterFile& f) { return f.catheter.stiffness_sigma_fraction; })
      .def_property_readonly("precurvature_sigma_per_m",
                             [](const CatheterFile& f) { return f.catheter.precurvature_sigma_per_m; })
      .def_property_readonly("observer_options", [](const CatheterFile& f) { return as_dict(f.observer); })
      .def_property_readonly("warnings", [](const CatheterFile& f) { return f.warnings; });
}

}  // namespace palpate::python
