// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/sensing/tracker_frame.hpp>

#include "arrays.hpp"

namespace palpate::python {

/// Poses as arrays: (n, 3) positions and, unless None, (n, 4) quaternions. A row that is NaN throughout was not seen,
/// or has no orientation; a row that is so in part is passed on as it is, for the observer to refuse.
class SensorArrays {
 public:
  /// Throws InputError; `prefix` stands before the arguments' names in messages.
  SensorArrays(py::handle position_m, py::handle quaternion_wxyz, py::ssize_t rows, const std::string& prefix = "");
  SensorReading reading(py::ssize_t row) const;
  py::ssize_t rows() const { return position_.shape(0); }

 private:
  Array position_, quaternion_;
  bool oriented_ = false;
};

}  // namespace palpate::python
