// SPDX-License-Identifier: Apache-2.0
#include <palpate/identification/arc_start.hpp>
#include <palpate/identification/arc_unknowns.hpp>

namespace palpate {

ArcUnknowns::ArcUnknowns(const Catheter& catheter, const ArcData& data, const std::array<bool, 3>& measured,
                         ClampKnowledge clamp)
    : L_(catheter.rod.length_m()) {
  for (std::size_t i = 0; i < data.poses.size(); ++i)
    oriented_ = oriented_ || (data.poses[i].count > 0 && catheter.sensors[i].kind == SensorKind::kPose);
  keeps_plane_ = clamp == ClampKnowledge::kFree && !oriented_;
  if (keeps_plane_) {
    add_bend(kept_direction(catheter, measured));
  } else {
    if (measured[1]) add_bend(Eigen::Vector2d::UnitX());
    if (measured[0]) add_bend(Eigen::Vector2d::UnitY());
  }
  const double tau_sigma = catheter.precurvature_sigma_per_m.z();
  const bool flat = !measured[0] || !measured[1];
  const bool considered = tau_sigma > 0.0 && !keeps_plane_ && !flat;
  if (oriented_ || considered) add(2, 1.0 / L_);
  if (!oriented_ && considered) priors_.push_back({2, catheter.precurvature_per_m().z(), tau_sigma});
  if (clamp != ClampKnowledge::kExact) add_clamp(catheter.base, measured, clamp == ClampKnowledge::kStated);
}

Eigen::Matrix<double, 9, Eigen::Dynamic> ArcUnknowns::matrix() const {
  Eigen::Matrix<double, 9, Eigen::Dynamic> M(9, columns_.size());
  for (std::size_t i = 0; i < columns_.size(); ++i) M.col(static_cast<Eigen::Index>(i)) = columns_[i];
  return M;
}

void ArcUnknowns::add(int entry, double scale) { columns_.emplace_back(scale * ArcVector::Unit(entry)); }

void ArcUnknowns::add_bend(const Eigen::Vector2d& direction) {
  ArcVector column = ArcVector::Zero();
  column.head<2>() = direction / L_;
  columns_.push_back(column);
}

/// In a picture from one side the clamp moves in the plane, and turns about its normal.
void ArcUnknowns::add_clamp(const BaseRegistration& base, const std::array<bool, 3>& measured, bool stated) {
  for (int axis = 0; axis < 3; ++axis) {
    const bool turns =
        measured[static_cast<std::size_t>((axis + 1) % 3)] && measured[static_cast<std::size_t>((axis + 2) % 3)];
    if (measured[static_cast<std::size_t>(axis)]) add_known(3 + axis, L_, stated, base.position_sigma_m);
    if (turns) add_known(6 + axis, 1.0, stated, base.rotation_sigma_rad);
  }
}

void ArcUnknowns::add_known(int entry, double scale, bool stated, double sigma) {
  if (stated && sigma == 0.0) return;
  add(entry, scale);
  if (stated) priors_.push_back({entry, 0.0, sigma});
}

}  // namespace palpate
