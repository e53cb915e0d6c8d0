// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <palpate/math/errors.hpp>

#include "arrays.hpp"
#include "bindings.hpp"
#include "catheter_parts.hpp"

/// What describes a catheter can be pickled and copied, so that it reaches another process; what lives in this one, as
/// an observer or a recording, says that it cannot.
namespace palpate::python {
namespace {

void require_size(const py::tuple& state, std::size_t size, const char* name) {
  if (state.size() != size)
    throw InputError(
        fmt::format("{}: pickled with {} parts: expected {}, as this version writes it", name, state.size(), size));
}

/// By hand, because Eigen's caster gives GCC 12 a false alarm.
template <class Matrix>
Matrix matrix(py::handle part) {
  const auto array = py::array_t<double, py::array::f_style | py::array::forcecast>::ensure(part);
  if (!array || array.size() != Matrix::SizeAtCompileTime)
    throw InputError(fmt::format("pickled with another array than one of {} numbers", int{Matrix::SizeAtCompileTime}));
  return Eigen::Map<const Matrix>(array.data());
}

template <class Matrix>
std::optional<Matrix> matrix_or_none(py::handle part) {
  if (part.is_none()) return std::nullopt;
  return matrix<Matrix>(part);
}

py::tuple state_of(const Pose& pose) { return py::make_tuple(pose.R, pose.p); }
Pose pose_from(const py::tuple& state) {
  require_size(state, 2, "Pose");
  return {matrix<Matrix3d>(state[0]), matrix<Vector3d>(state[1])};
}

py::tuple state_of(const Sensor& s) {
  return py::make_tuple(s.name, static_cast<int>(s.kind), s.arc_length_m, s.T_local_sensor, s.mount_sigma_m, s.noise_m,
                        s.noise_rad, s.bias_m, s.bias_rad, s.T_tracker_base, s.delay_s, s.markers);
}
Sensor sensor_from(const py::tuple& state) {
  require_size(state, 12, "Sensor");
  const int kind = state[1].cast<int>();
  if (kind < 0 || kind > static_cast<int>(SensorKind::kPosition))
    throw InputError(fmt::format("Sensor: pickled with kind {}: expected 0 to 2", kind));
  return {.name = state[0].cast<std::string>(),
          .kind = static_cast<SensorKind>(kind),
          .arc_length_m = state[2].cast<double>(),
          .T_local_sensor = state[3].cast<Pose>(),
          .mount_sigma_m = state[4].cast<double>(),
          .noise_m = matrix<Vector3d>(state[5]),
          .noise_rad = state[6].cast<double>(),
          .bias_m = state[7].cast<double>(),
          .bias_rad = state[8].cast<double>(),
          .T_tracker_base = state[9].cast<std::optional<Pose>>(),
          .delay_s = state[10].cast<double>(),
          .markers = state[11].cast<std::vector<std::string>>()};
}

py::tuple state_of(const ShaftSection& s) {
  return py::make_tuple(s.from_m, s.to_m, s.bending_stiffness_Nm2, s.torsional_stiffness_Nm2, s.precurvature_per_m,
                        s.rigid);
}
ShaftSection section_from(const py::tuple& state) {
  require_size(state, 6, "Section");
  return {.from_m = state[0].cast<double>(),
          .to_m = state[1].cast<double>(),
          .bending_stiffness_Nm2 = matrix_or_none<Eigen::Vector2d>(state[2]),
          .torsional_stiffness_Nm2 = state[3].cast<std::optional<double>>(),
          .precurvature_per_m = matrix_or_none<Vector3d>(state[4]),
          .rigid = state[5].cast<bool>()};
}

/// A catheter file, and what no file says.
py::tuple state_of(const CatheterFile& file) {
  return py::make_tuple(catheter_toml(file), as_dict(file.observer), file.catheter.base.covariance,
                        shown(file.warnings));
}
CatheterFile catheter_from(const py::tuple& state) {
  require_size(state, 4, "Catheter");
  CatheterFile file = catheter_from_text(word(state[0], "Catheter: pickled text"), "pickled");
  set_options(state[1].cast<py::dict>(), file.observer);
  file.catheter.base.covariance = matrix_or_none<Eigen::Matrix<double, 6, 6>>(state[2]);
  file.warnings = state[3].cast<std::vector<std::string>>();
  return file;
}

template <class T, T (*from)(const py::tuple&)>
void make_picklable(const py::module_& m, const char* name) {
  py::class_<T>(m.attr(name)).def(py::pickle([](const T& value) { return state_of(value); }, from));
}

/// For every protocol and for copy alike: left to object's own, protocols 0 and 1 end the process.
py::tuple reduce(const py::object& self, const py::object& /*protocol*/) {
  const py::type kind = py::type::of(self);
  if (!py::hasattr(kind, "__setstate__"))
    throw py::type_error(
        fmt::format("palpate.{}: cannot be pickled or copied", kind.attr("__name__").cast<std::string>()));
  const py::object make = py::module_::import("copyreg").attr("__newobj__");
  return py::make_tuple(make, py::make_tuple(kind), self.attr("__getstate__")());
}

}  // namespace

void bind_pickle(py::module_& m) {
  make_picklable<Pose, pose_from>(m, "Pose");
  make_picklable<Sensor, sensor_from>(m, "Sensor");
  make_picklable<ShaftSection, section_from>(m, "Section");
  make_picklable<CatheterFile, catheter_from>(m, "Catheter");
  const py::dict names = m.attr("__dict__");
  for (const auto& [name, value] : names) {
    if (!PyType_Check(value.ptr()) || PyExceptionClass_Check(value.ptr())) continue;
    value.attr("__reduce_ex__") = py::cpp_function(&reduce, py::name("__reduce_ex__"), py::is_method(value));
  }
}

}  // namespace palpate::python
