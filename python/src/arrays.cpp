// SPDX-License-Identifier: Apache-2.0
#include "arrays.hpp"

#include <fmt/format.h>
#include <pybind11/stl/filesystem.h>

#include <cmath>
#include <palpate/math/errors.hpp>

namespace palpate::python {

namespace {

std::string in_words(const std::vector<py::ssize_t>& shape) {
  if (shape.empty()) return "a single number";
  std::string text;
  for (const py::ssize_t n : shape)
    text += fmt::format("{}{}", text.empty() ? "" : ", ", n == kAnyLength ? "n" : std::to_string(n));
  return fmt::format("shape ({}{})", text, shape.size() == 1 ? "," : "");
}

std::vector<py::ssize_t> shape_of(const py::array& array) { return {array.shape(), array.shape() + array.ndim()}; }

/// As a message shows it: short.
std::string shown(py::handle value) {
  std::string text;
  try {
    text = py::repr(value).cast<std::string>();
  } catch (const std::exception&) {
    text = "?";
  }
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  for (char& c : text)
    if (c == '\n') c = ' ';
  return text;
}

[[noreturn]] void refuse(std::string_view name, py::handle value, std::string_view expected) {
  throw InputError(fmt::format("{} = {}: expected {}", name, shown(value), expected));
}

/// Masked entries would otherwise come through as numbers.
py::array as_array(py::handle value, std::string_view name, const std::vector<py::ssize_t>& shape) {
  const std::string expected = fmt::format("numbers of {}", in_words(shape));
  if (py::hasattr(value, "mask") && py::hasattr(value, "filled"))
    refuse(name, value, "an array without a mask (what is unknown may be NaN where the documentation says so)");
  py::array raw = py::array::ensure(value);
  if (!raw) refuse(name, value, expected);
  const char kind = raw.dtype().kind();
  const bool empty = raw.size() == 0 && kind == 'f';
  if (!empty && kind != 'f' && kind != 'i' && kind != 'u') refuse(name, value, expected);
  return raw;
}

void require_shape(const py::array& array, std::string_view name, const std::vector<py::ssize_t>& shape) {
  bool same = static_cast<std::size_t>(array.ndim()) == shape.size();
  for (std::size_t i = 0; same && i < shape.size(); ++i)
    same = shape[i] == kAnyLength || shape[i] == array.shape(static_cast<py::ssize_t>(i));
  if (!same) throw InputError(fmt::format("{}: {}: expected {}", name, in_words(shape_of(array)), in_words(shape)));
}

void require_finite(const Array& array, std::string_view name) {
  const double* data = array.data();
  for (py::ssize_t i = 0; i < array.size(); ++i) {
    if (std::isfinite(data[i])) continue;
    std::string place;
    py::ssize_t rest = i;
    for (py::ssize_t axis = array.ndim() - 1; axis >= 0; --axis) {
      place = fmt::format("{}{}{}", rest % array.shape(axis), place.empty() ? "" : ", ", place);
      rest /= array.shape(axis);
    }
    const std::string where = place.empty() ? "" : fmt::format("[{}]", place);
    throw InputError(fmt::format("{}{} = {}: expected a finite number", name, where, data[i]));
  }
}

}  // namespace

Array numbers(py::handle value, std::string_view name, const std::vector<py::ssize_t>& shape, Values which) {
  const py::array raw = as_array(value, name, shape);
  require_shape(raw, name, shape);
  using Converted = py::array_t<double, kInOrder | int{py::array::forcecast}>;
  Array array = py::reinterpret_steal<Array>(Converted::ensure(raw).release());
  if (!array) refuse(name, value, fmt::format("numbers of {}", in_words(shape)));
  if (which == Values::kFinite) require_finite(array, name);
  return array;
}

double number(py::handle value, std::string_view name, Values which) {
  if (PyBool_Check(value.ptr())) refuse(name, value, "a number");
  return *numbers(value, name, {}, which).data();
}

long whole_number(py::handle value, std::string_view name) {
  if (PyBool_Check(value.ptr()) || !PyIndex_Check(value.ptr())) refuse(name, value, "a whole number");
  const auto whole = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
  const long out = whole ? PyLong_AsLong(whole.ptr()) : -1;
  if (out == -1 && PyErr_Occurred()) {
    PyErr_Clear();
    refuse(name, value, whole ? "a whole number of usual size" : "a whole number");
  }
  return out;
}

bool truth_value(py::handle value, std::string_view name) {
  if (!PyBool_Check(value.ptr())) refuse(name, value, "True or False");
  return value.ptr() == Py_True;
}

std::string word(py::handle value, std::string_view name) {
  if (!py::isinstance<py::str>(value)) refuse(name, value, "a str");
  py::ssize_t size = 0;
  const char* const text = PyUnicode_AsUTF8AndSize(value.ptr(), &size);
  if (text == nullptr) {
    PyErr_Clear();
    refuse(name, value, "text that UTF-8 can say, without surrogates");
  }
  std::string out(text, static_cast<std::size_t>(size));
  if (out.find('\0') != std::string::npos) refuse(name, value, "text without a NUL");
  return out;
}

std::vector<std::string> words(py::handle value, std::string_view name) {
  if (!py::isinstance<py::sequence>(value) || py::isinstance<py::str>(value) || py::isinstance<py::bytes>(value))
    refuse_class(value, name, "a list of str");
  std::vector<std::string> out;
  for (const py::handle one : value) out.push_back(word(one, fmt::format("{}[{}]", name, out.size())));
  return out;
}

void refuse_class(py::handle value, std::string_view name, std::string_view expected) {
  throw py::type_error(
      fmt::format("{}: {}: expected {}", name, py::type::of(value).attr("__name__").cast<std::string>(), expected));
}

Vector3d vector3(py::handle value, std::string_view name) {
  return Eigen::Map<const Vector3d>(numbers(value, name, {3}).data());
}

Eigen::Vector2d vector2(py::handle value, std::string_view name) {
  const Array array = numbers(value, name, {2});
  return {array.data()[0], array.data()[1]};
}

Matrix3d rotation(py::handle value, std::string_view name) {
  const Array array = numbers(value, name, {3, 3});
  Matrix3d R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(array.data());
  const double error = (R.transpose() * R - Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(error <= 1e-6) || !(R.determinant() > 0.0))
    throw InputError(
        fmt::format("{}: largest entry of R^T R - I is {:.3g}, determinant {:.3g}: expected a rotation "
                    "matrix",
                    name, error, R.determinant()));
  return R;
}

std::span<const Vector3d> rows3(const Array& array) {
  static_assert(sizeof(Vector3d) == 3 * sizeof(double) && alignof(Vector3d) <= alignof(double));
  return {reinterpret_cast<const Vector3d*>(array.data()), static_cast<std::size_t>(array.shape(0))};
}

std::span<const double> values(const Array& array) { return {array.data(), static_cast<std::size_t>(array.size())}; }

std::vector<double> to_vector(py::handle value, std::string_view name) {
  const Array array = numbers(value, name, {kAnyLength});
  return {array.data(), array.data() + array.size()};
}

std::vector<Vector3d> to_vectors(py::handle value, std::string_view name) {
  const Array array = numbers(value, name, {kAnyLength, 3});
  const auto rows = rows3(array);
  return {rows.begin(), rows.end()};
}

std::string path_text(py::handle value, std::string_view name) {
  const py::object path = py::reinterpret_steal<py::object>(PyOS_FSPath(value.ptr()));
  if (!path) PyErr_Clear();
  if (!path || !py::isinstance<py::str>(path)) refuse(name, value, "a path (str or os.PathLike)");
  const auto bytes = py::reinterpret_steal<py::bytes>(PyUnicode_EncodeFSDefault(path.ptr()));
  if (!bytes) {
    PyErr_Clear();
    refuse(name, value, "a path that the file system's encoding can say");
  }
  std::string out(bytes);
  if (out.find('\0') != std::string::npos) refuse(name, value, "a path without a NUL");
  return out;
}

py::str shown(std::string_view text) {
  PyObject* const decoded =
      PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "backslashreplace");
  if (decoded == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(decoded);
}

py::list shown(const std::vector<std::string>& texts) {
  py::list out;
  for (const std::string& text : texts) out.append(shown(text));
  return out;
}

}  // namespace palpate::python
