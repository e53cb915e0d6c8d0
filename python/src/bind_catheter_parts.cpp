// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <palpate/math/errors.hpp>
#include <palpate/recording/text_table.hpp>

#include "arrays.hpp"
#include "bindings.hpp"
#include "catheter_parts.hpp"

namespace palpate::python {
namespace {

constexpr std::array<std::pair<std::string_view, SensorKind>, 3> kKinds{
    {{"pose", SensorKind::kPose}, {"pose5", SensorKind::kPose5}, {"position", SensorKind::kPosition}}};

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
                   const py::object& noise_m, const py::object& noise_rad, const py::object& T_local_sensor,
                   const py::object& mount_sigma_m, const py::object& bias_m, const py::object& bias_rad,
                   const py::object& delay_s, const py::object& T_tracker_base, const py::object& markers) {
  Sensor sensor;
  sensor.name = word(name, "name");
  sensor.kind = kind_of(word(kind, "kind"));
  sensor.arc_length_m = number(arc_length_m, "arc_length_m");
  if (!noise_m.is_none()) sensor.noise_m = alike_or_by_axis(noise_m, "noise_m");
  set(sensor.noise_rad, noise_rad, "noise_rad");
  if (!T_local_sensor.is_none())
    sensor.T_local_sensor = object_of<Pose>(T_local_sensor, "T_local_sensor", "palpate.Pose");
  set(sensor.mount_sigma_m, mount_sigma_m, "mount_sigma_m");
  set(sensor.bias_m, bias_m, "bias_m");
  set(sensor.bias_rad, bias_rad, "bias_rad");
  set(sensor.delay_s, delay_s, "delay_s");
  if (!T_tracker_base.is_none())
    sensor.T_tracker_base = object_of<Pose>(T_tracker_base, "T_tracker_base", "palpate.Pose");
  sensor.markers = words(markers, "markers");
  return sensor;
}

const std::vector<std::string_view> kSensorArguments{"name",      "kind",           "arc_length_m",   "noise_m",
                                                     "noise_rad", "T_local_sensor", "mount_sigma_m",  "bias_m",
                                                     "bias_rad",  "delay_s",        "T_tracker_base", "markers"};
const std::vector<std::string_view> kSectionArguments{
    "from_m", "to_m", "bending_stiffness_Nm2", "torsional_stiffness_Nm2", "precurvature_per_m", "rigid"};

/// What is wrong with arguments that fit no constructor: the first `required` must be there.
[[noreturn]] void refuse_arguments(std::string_view kind, const std::vector<std::string_view>& known,
                                   std::size_t required, const py::args& placed, const py::kwargs& given) {
  require_known(given, kind, known);
  for (std::size_t i = placed.size(); i < required; ++i)
    if (!given.contains(known[i]))
      throw py::type_error(fmt::format("{}: {}: not given: expected this argument", kind, known[i]));
  throw py::type_error(
      fmt::format("{}: {} arguments by place, {} by keyword: expected each once, and by keyword what "
                  "its docstring says",
                  kind, placed.size(), given.size()));
}

void bind_sensor(py::module_& m) {
  py::class_<Pose>(m, "Pose",
                   "Rigid motion T_a_b: p_a = R p_b + p.\n\nR (3, 3) a rotation matrix, p (3,) [m]; default: none. "
                   "T_a_b @ T_b_c; inverse(); apply(point (3,)). Raises InputError where R is no rotation.")
      .def(py::init(&make_pose), py::arg("R") = py::none(), py::arg("p") = py::none())
      .def(py::init([](const py::args& placed, const py::kwargs& given) -> Pose {
        refuse_arguments("Pose", {"R", "p"}, 0, placed, given);
      }))
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
      "3-D\ndelay_s         its time stamps are later than the event by this much\nT_tracker_base  the clamp in the "
      "frame of this sensor's own tracker or image; None: the catheter's\nmarkers         optical capture: names of "
      "the "
      "markers whose midpoint (position) or triad (pose) it is\n\nRaises InputError naming the argument. Source: "
      "palpate/sensing/catheter.hpp.")
      .def(py::init(&make_sensor), py::arg("name"), py::arg("kind") = "pose", py::arg("arc_length_m") = 0.0,
           py::arg("noise_m") = py::none(), py::arg("noise_rad") = py::none(), py::kw_only(),
           py::arg("T_local_sensor") = py::none(), py::arg("mount_sigma_m") = py::none(),
           py::arg("bias_m") = py::none(), py::arg("bias_rad") = py::none(), py::arg("delay_s") = py::none(),
           py::arg("T_tracker_base") = py::none(), py::arg("markers") = py::tuple())
      .def(py::init([](const py::args& placed, const py::kwargs& given) -> Sensor {
        refuse_arguments("Sensor", kSensorArguments, 1, placed, given);
      }))
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
      .def_property_readonly("T_tracker_base", [](const Sensor& s) { return s.T_tracker_base; })
      .def_property_readonly("markers", [](const Sensor& s) { return s.markers; })
      .def("__repr__", [](const Sensor& s) {
        return fmt::format("Sensor({:?}, kind='{}', arc_length_m={:g})", s.name, name_of(s.kind), s.arc_length_m);
      });
}

ShaftSection make_section(const py::object& from_m, const py::object& to_m, const py::object& bending_stiffness_Nm2,
                          const py::object& torsional_stiffness_Nm2, const py::object& precurvature_per_m,
                          const py::object& rigid) {
  ShaftSection section{.from_m = number(from_m, "from_m"), .to_m = number(to_m, "to_m")};
  if (!bending_stiffness_Nm2.is_none())
    section.bending_stiffness_Nm2 = vector2(bending_stiffness_Nm2, "bending_stiffness_Nm2");
  if (!torsional_stiffness_Nm2.is_none())
    section.torsional_stiffness_Nm2 = number(torsional_stiffness_Nm2, "torsional_stiffness_Nm2");
  if (!precurvature_per_m.is_none()) section.precurvature_per_m = vector3(precurvature_per_m, "precurvature_per_m");
  section.rigid = truth_value(rigid, "rigid");
  return section;
}

void bind_section(py::module_& m) {
  py::class_<ShaftSection>(
      m, "Section",
      "A stretch of shaft that is not as the rest: from_m to to_m along it.\n\nbending_stiffness_Nm2 (2,), "
      "torsional_stiffness_Nm2, precurvature_per_m (3,): None: the catheter's.\nrigid: keeps its precurvature under "
      "any "
      "load.\n\nRaises InputError naming the argument. Source: palpate/rod/rod.hpp.")
      .def(py::init(&make_section), py::arg("from_m"), py::arg("to_m"), py::kw_only(),
           py::arg("bending_stiffness_Nm2") = py::none(), py::arg("torsional_stiffness_Nm2") = py::none(),
           py::arg("precurvature_per_m") = py::none(), py::arg("rigid") = false)
      .def(py::init([](const py::args& placed, const py::kwargs& given) -> ShaftSection {
        refuse_arguments("Section", kSectionArguments, 2, placed, given);
      }))
      .def_readonly("from_m", &ShaftSection::from_m)
      .def_readonly("to_m", &ShaftSection::to_m)
      .def_property_readonly("bending_stiffness_Nm2", [](const ShaftSection& s) { return s.bending_stiffness_Nm2; })
      .def_property_readonly("torsional_stiffness_Nm2", [](const ShaftSection& s) { return s.torsional_stiffness_Nm2; })
      .def_property_readonly("precurvature_per_m", [](const ShaftSection& s) { return s.precurvature_per_m; })
      .def_readonly("rigid", &ShaftSection::rigid)
      .def("__repr__", [](const ShaftSection& s) {
        return fmt::format("Section({:g}, {:g}{})", s.from_m, s.to_m, s.rigid ? ", rigid=True" : "");
      });
}

}  // namespace

std::string_view name_of(SensorKind kind) { return kKinds[static_cast<std::size_t>(kind)].first; }

ShaftSection told_section(const Section& section) {
  ShaftSection out{.from_m = section.from_m, .to_m = section.to_m, .rigid = section.rigid};
  out.precurvature_per_m = section.precurvature_per_m;
  if (section.rigid) return out;
  out.bending_stiffness_Nm2 = section.stiffness_Nm2.head<2>();
  out.torsional_stiffness_Nm2 = section.stiffness_Nm2.z();
  return out;
}

void bind_catheter_parts(py::module_& m) {
  bind_sensor(m);
  bind_section(m);
}

}  // namespace palpate::python
