// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/identification/followed_shape.hpp>

/// One load case: what is measured of it, minus what the shaft would show.
namespace palpate::stiffness {

/// How far open a loop may be when the tangent closes it: to 1e-8 rad for a fit, to 1e-4 rad for a search.
inline constexpr double kClosed_rad = 1e-4, kNearlyClosed_rad = 1e-2;

/// All shapes that one case needs, its points and their residuals.
class CaseModel {
 public:
  CaseModel(const Rod& rod, const LoadCase& load_case, StiffnessOptions::OwnWeight own_weight, Moving moving,
            const Vector3d& force_direction);

  int rows() const { return rows_; }
  /// Measured minus predicted over sigma, and its derivative by q. `unknown_sigma_m` where the points state none.
  /// False where the equilibrium was lost.
  bool evaluate(const Numbers& q, double unknown_sigma_m, Eigen::Ref<Eigen::VectorXd> residual,
                Eigen::Ref<Eigen::Matrix<double, Eigen::Dynamic, kNumbers>> by_q, double closed_rad = kClosed_rad);

  /// At the last q.
  const std::vector<Place>& points() const { return points_; }
  const LoadCase& load_case() const { return *case_; }
  FollowedShape& loaded() { return shapes_.front().shape; }
  int evaluations() const;

  using Start = std::vector<FollowedShape::Start>;
  Start start() const;
  void set_start(const Start& start);

 private:
  struct Signed {
    double sign;
    FollowedShape shape;
  };
  void place_points(const Numbers& q);

  const LoadCase* case_;
  std::vector<Pose> mounts_;           ///< of the stations
  std::vector<int> station_of_point_;  ///< -1: on the grid
  int grid_from_ = 0;                  ///< first of the stations between which places are interpolated
  std::vector<double> stations_m_;
  std::vector<Signed> shapes_;
  std::vector<Place> places_, points_;
  int rows_ = 0;
};

/// Numbers that one point tells: measured components, less the one that says where along the shaft it is.
int rows_of(const ShapePoint& point);

}  // namespace palpate::stiffness
