// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <palpate/sensing/screening.hpp>

namespace palpate {

std::string_view describe(Rejection rejection) {
  constexpr std::array<std::string_view, kRejections> words{
      "none",          "missing",        "not finite", "zero quaternion", "non-unit quaternion",
      "identity pose", "no orientation", "outlier",    "not in the frame"};
  return words[static_cast<std::size_t>(rejection)];
}

Rejection screen(const SensorReading& reading, SensorKind kind) {
  if (reading.status == SensorReading::Status::kAbsent) return Rejection::kAbsent;
  if (reading.status == SensorReading::Status::kMissing) return Rejection::kMissing;
  if (!reading.position_m.allFinite()) return Rejection::kNotFinite;
  const bool exact_origin = reading.position_m.isZero(0.0);
  if (kind == SensorKind::kPosition && !(exact_origin && reading.has_orientation)) return Rejection::kNone;
  if (!reading.has_orientation) return Rejection::kNoOrientation;
  const Eigen::Vector4d& q = reading.quaternion_wxyz;
  if (!q.allFinite()) return Rejection::kNotFinite;
  const double norm = q.norm();
  if (norm < 1e-6) return Rejection::kZeroQuaternion;
  if (std::abs(norm - 1.0) > 0.01) return Rejection::kNonUnitQuaternion;
  const bool identity = std::abs(q(0)) == 1.0 && q.tail<3>().isZero(0.0) && exact_origin;
  return identity ? Rejection::kIdentityPose : Rejection::kNone;
}

}  // namespace palpate
