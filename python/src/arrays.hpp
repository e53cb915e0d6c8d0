// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <palpate/math/pose.hpp>
#include <span>
#include <string_view>
#include <vector>

/// What comes from Python, checked once at the border: every message names the argument, what was found and what was
/// expected. Lists, other number types, strided, read-only and unaligned arrays are copied; what fits is not.
namespace palpate::python {

namespace py = pybind11;

/// Row by row, without gaps, each number where a double may lie.
inline constexpr int kInOrder = int{py::array::c_style} | int{py::detail::npy_api::NPY_ARRAY_ALIGNED_};
using Array = py::array_t<double, kInOrder>;

enum class Values { kFinite, kAny };

inline constexpr py::ssize_t kAnyLength = -1;

/// Throws InputError on what is not real numbers of this shape (kAnyLength: any); with Values::kFinite on NaN, inf.
Array numbers(py::handle value, std::string_view name, const std::vector<py::ssize_t>& shape,
              Values values = Values::kFinite);

[[noreturn]] void refuse_class(py::handle value, std::string_view name, std::string_view expected);

double number(py::handle value, std::string_view name, Values values = Values::kFinite);
/// A whole number. Throws InputError.
long whole_number(py::handle value, std::string_view name);
bool truth_value(py::handle value, std::string_view name);
/// Throws InputError on what is no str, or has what UTF-8 cannot say, or a NUL.
std::string word(py::handle value, std::string_view name);
std::vector<std::string> words(py::handle value, std::string_view name);
/// Of a class of ours, or of several of them; `kind`: in words. Throws py::type_error.
template <class T>
T object_of(const py::object& value, std::string_view name, std::string_view kind) {
  try {
    return value.cast<T>();
  } catch (const py::cast_error&) {
    refuse_class(value, name, kind);
  }
}
Vector3d vector3(py::handle value, std::string_view name);
Eigen::Vector2d vector2(py::handle value, std::string_view name);
/// A 3 x 3 rotation matrix. Throws InputError where R^T R is off by more than 1e-6.
Matrix3d rotation(py::handle value, std::string_view name);

/// Rows of an (n, 3) array where they lie.
std::span<const Vector3d> rows3(const Array& array);
std::span<const double> values(const Array& array);
std::vector<double> to_vector(py::handle value, std::string_view name);
std::vector<Vector3d> to_vectors(py::handle value, std::string_view name);

/// A path as str or os.PathLike, in the file system's encoding. Throws InputError on anything else.
std::string path_text(py::handle value, std::string_view name);

/// As Python's text, whatever the bytes are: what is no UTF-8, as in a file of another encoding, as "\\xfc".
py::str shown(std::string_view text);
py::list shown(const std::vector<std::string>& texts);

/// An array of shape (count, inner...); `put(i, out)` writes row i.
template <class Number = double, class Put>
py::array_t<Number> filled(std::size_t count, std::vector<py::ssize_t> inner, const Put& put) {
  py::ssize_t width = 1;
  for (const py::ssize_t n : inner) width *= n;
  inner.insert(inner.begin(), static_cast<py::ssize_t>(count));
  py::array_t<Number> array(inner);
  Number* out = array.mutable_data();
  for (std::size_t i = 0; i < count; ++i, out += width) put(i, out);
  return array;
}

/// Writes a vector, or a matrix row by row, as numpy has it.
template <class Matrix>
void put_rows(const Matrix& matrix, double* out) {
  for (Eigen::Index i = 0; i < matrix.rows(); ++i)
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) *out++ = matrix(i, j);
}

}  // namespace palpate::python
