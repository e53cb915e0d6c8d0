// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/identification/arc_model.hpp>

namespace palpate {

/// Which entries of x are looked for, each scaled to a radian of bend or to the length of the shaft, and what is
/// believed of them beforehand.
class ArcUnknowns {
 public:
  /// `measured`: components of the points' positions.
  ArcUnknowns(const Catheter& catheter, const ArcData& data, const std::array<bool, 3>& measured, ClampKnowledge clamp);

  /// M of x = x0 + M z.
  Eigen::Matrix<double, 9, Eigen::Dynamic> matrix() const;
  const std::vector<ArcPrior>& priors() const { return priors_; }
  bool tells_torsion() const { return oriented_; }
  bool keeps_plane() const { return keeps_plane_; }  ///< a free clamp and points alone

 private:
  void add(int entry, double scale);
  void add_bend(const Eigen::Vector2d& direction);
  void add_clamp(const BaseRegistration& base, const std::array<bool, 3>& measured, bool stated);
  void add_known(int entry, double scale, bool stated, double sigma);

  double L_;
  bool oriented_ = false, keeps_plane_ = false;
  std::vector<ArcVector> columns_;
  std::vector<ArcPrior> priors_;
};

}  // namespace palpate
