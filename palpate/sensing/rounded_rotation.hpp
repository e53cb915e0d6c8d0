// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/math/rotation.hpp>

namespace palpate {

/// The quaternion (w, x, y, z) of the rotation nearest to a matrix whose numbers were rounded by a file or a wire. Zero
/// where it is not within 1 % of a rotation, so that screening refuses it. The exact identity, which may be a driver's
/// way to say that something is wrong, stays one.
Eigen::Vector4d nearest_quaternion(const Matrix3d& R);

}  // namespace palpate
