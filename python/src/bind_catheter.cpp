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
      .def_property_readonly("sections",
                             [](const CatheterFile& f) {
                               std::vector<ShaftSection> out;
                               for (const Section& one : f.catheter.rod.sections) out.push_back(told_section(one));
                               return out;
                             })
      .def_property_readonly("shear_stiffness_N",
                             [](const CatheterFile& f) { return f.catheter.rod.shear_stiffness_N; })
      .def_property_readonly("axial_stiffness_N",
                             [](const CatheterFile& f) { return f.catheter.rod.axial_stiffness_N; })
      .def_property_readonly("tendon", &tendon_model)
      .def_property_readonly("tendon_offset_m", [](const CatheterFile& f) { return f.catheter.tendon.offset_m; })
      .def_property_readonly("tendon_moment_sigma_fraction",
                             [](const CatheterFile& f) { return f.catheter.tendon.moment_sigma_fraction; });
}

void bind_uncertainty(py::class_<CatheterFile>& c) {
  c.def_property_readonly("base_position_sigma_m",
                          [](const CatheterFile& f) { return f.catheter.base.position_sigma_m; })
      .def_property_readonly("base_rotation_sigma_rad",
                             [](const CatheterFile& f) { return f.catheter.base.rotation_sigma_rad; })
      .def_property_readonly("stiffness_sigma_fraction",
                             [](const CatheterFile& f) { return f.catheter.stiffness_sigma_fraction; })
      .def_property_readonly("stiffness_correlation",
                             [](const CatheterFile& f) { return f.catheter.stiffness_correlation; })
      .def_property_readonly("precurvature_sigma_per_m",
                             [](const CatheterFile& f) { return f.catheter.precurvature_sigma_per_m; })
      .def_property_readonly("bias_length_m", [](const CatheterFile& f) { return f.catheter.bias_length_m; })
      .def_property_readonly("bias_memory_s", [](const CatheterFile& f) { return f.catheter.bias_memory_s; });
}

}  // namespace

CatheterFile catheter_from_text(const std::string& text, const std::string& name) {
  TextFile file{.name = name, .lines = {}};
  for (const std::string_view line : split(text, '\n')) file.lines.emplace_back(line);
  return parse_catheter(file);
}

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
  bind_catheter_parts(m);
  py::class_<CatheterFile> c(
      m, "Catheter",
      "One catheter in one setup: shaft, sensors, base, how well each number is known, and how to estimate with "
      "it.\n\nCatheter.from_toml(path) and Catheter.from_text(text) read a catheter file (docs/reference/formats.md), "
      "to_toml() writes one. By keywords:\n\n"
      "length_m                       clamp to the end of the flexible shaft\n"
      "bending_stiffness_Nm2          (2,) EI1 about d1, EI2 about d2\n"
      "torsional_stiffness_Nm2        GJ; or poisson_ratio. In place of all: youngs_modulus_Pa, diameter_m, "
      "poisson_ratio\n"
      "precurvature_per_m             (3,) k1,0 k2,0 tau0 of the unloaded shaft; default 0\n"
      "sections                       list of Section: stretches that are not as the rest, from the clamp on\n"
      "shear_stiffness_N, axial_stiffness_N  kGA and EA, both or neither; default 0: no shear, no stretch\n"
      "rigid_tip_m                    stiff electrode beyond the flexible end; default 0\n"
      "contact_offset_m               (3,) where the force acts, from the flexible end, local axes there; default the "
      "end of the rigid tip\n"
      "distributed_load_base_N_per_m  (3,) own weight, base frame\n"
      "sensors                        list of Sensor, 1 to 8\n"
      "base                           Pose T_tracker_base of the clamp; or base_sensor, a Sensor that measures it: "
      "T_local_sensor is its mounting in the clamp's frame\n"
      "tendon                         \"couple\" or \"end_moment\": how its moment acts; tendon_offset_m, "
      "tendon_moment_sigma_fraction\n"
      "stiffness_sigma_fraction, stiffness_correlation, precurvature_sigma_per_m (3,), base_position_sigma_m, "
      "base_rotation_sigma_rad  one standard deviation of what is not known exactly; default 0, correlation 0.9\n"
      "bias_length_m, bias_memory_s   over which the tracker's accuracy error is alike; default 0.05, 60\n"
      "ignore_sensors                 names in recordings that are not on this catheter\n"
      "observer_options               dict of options of ForceObserver that are to be its defaults\n"
      "name\n\n"
      "A file alone can say [tendon_map], [reference] and [[known_load]].\n\n"
      "Immutable. Pickled and copied as to_toml() has it, with what a file does not say beside it: to another process "
      "it "
      "comes with numbers to the last bit or the next. Raises InputError `FILE:LINE: KEY = VALUE: expected ...`, or "
      "naming the argument.");
  c.def(py::init([](const py::args& placed, const py::kwargs& given) {
     if (!placed.empty())
       throw py::type_error(fmt::format("Catheter: {} arguments by place: expected keywords alone", placed.size()));
     return catheter_from_keywords(given);
   }))
      .def_static(
          "from_toml", [](const py::object& path) { return read_catheter_file(path_text(path, "path")); },
          py::arg("path"), "Reads a catheter file. Raises InputError naming file, line, key and value.")
      .def_static(
          "from_text",
          [](const py::object& text, const py::object& name) {
            return catheter_from_text(word(text, "text"), word(name, "name"));
          },
          py::arg("text"), py::arg("name") = "catheter", "The same of a text; name: for messages.")
      .def("to_toml", &catheter_toml,
           "A catheter file as text: from_text() reads back the same catheter, numbers to the last bit or the next, "
           "rotations to 1e-15. Of a base whose position and rotation are known together (a tare, a registration) it "
           "has the two sigmas; forecast_s, smoothing_lag_frames and report_convergence_index are of a run, not of a "
           "catheter. Raises InputError where a file may not say it, as a length of half a millimetre.");
  bind_shaft_properties(c);
  bind_uncertainty(c);
  c.def_property_readonly("sensors", [](const CatheterFile& f) { return f.catheter.sensors; })
      .def_property_readonly("base_sensor",
                             [](const CatheterFile& f) {
                               return f.catheter.base.tracked ? std::optional(f.catheter.base.sensor) : std::nullopt;
                             })
      .def_property_readonly("T_tracker_base", [](const CatheterFile& f) { return f.catheter.base.T_tracker_base; })
      .def_property_readonly("ignore_sensors", [](const CatheterFile& f) { return f.ignore_sensors; })
      .def_property_readonly("observer_options", [](const CatheterFile& f) { return as_dict(f.observer); })
      .def_property_readonly("warnings", [](const CatheterFile& f) { return f.warnings; });
}

}  // namespace palpate::python
