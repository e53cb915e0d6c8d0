// SPDX-License-Identifier: Apache-2.0
#include "frame_arguments.hpp"

#include <fmt/format.h>

namespace palpate::python {

SensorArrays::SensorArrays(py::handle position_m, py::handle quaternion_wxyz, py::ssize_t rows,
                           const std::string& prefix)
    : position_(numbers(position_m, prefix + "position_m", {rows, 3}, Values::kAny)),
      oriented_(!quaternion_wxyz.is_none()) {
  if (oriented_)
    quaternion_ = numbers(quaternion_wxyz, prefix + "quaternion_wxyz", {position_.shape(0), 4}, Values::kAny);
}

SensorReading SensorArrays::reading(py::ssize_t row) const {
  SensorReading out;
  out.position_m = Eigen::Map<const Vector3d>(position_.data() + 3 * row);
  if (oriented_) {
    out.quaternion_wxyz = Eigen::Map<const Eigen::Vector4d>(quaternion_.data() + 4 * row);
    out.has_orientation = !out.quaternion_wxyz.array().isNaN().all();
  }
  const bool seen = !out.position_m.array().isNaN().all();
  out.status = seen ? SensorReading::Status::kOk : SensorReading::Status::kMissing;
  return out;
}

}  // namespace palpate::python
