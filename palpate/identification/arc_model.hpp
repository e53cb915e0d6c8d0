// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/identification/precurvature.hpp>
#include <palpate/rod/base_loads.hpp>
#include <palpate/sensing/sensor_model.hpp>

/// The least-squares problem behind fit_arc.
namespace palpate {

/// x = (k1,0, k2,0, tau0, rho, theta): precurvature, and where the clamp stands, T_frame_base = T_start (exp theta,
/// rho).
using ArcVector = Eigen::Matrix<double, 9, 1>;

/// Something that was seen at one arc length.
struct ArcObservation {
  Sensor sensor;           ///< kind, arc length, mounting
  Pose measured;           ///< in the frame of the data; NaN components of the position are left out
  Vector3d sigma_m;        ///< of the position
  double sigma_rad = 1.0;  ///< of the orientation
};

/// Expectation of one entry of x, with its sigma.
struct ArcPrior {
  int entry = 0;
  double value = 0.0, sigma = 1.0;
};

/// x = x0 + M z: the unknowns are z, of the order of 1 where the shaft bends by a radian. Residuals in sigmas.
class ArcModel {
 public:
  ArcModel(const Catheter& catheter, std::vector<ArcObservation> observations, std::vector<ArcPrior> priors);

  void set_start(const Pose& T_frame_start) { T_start_ = T_frame_start; }
  void set_unknowns(const ArcVector& x0, const Eigen::Matrix<double, 9, Eigen::Dynamic>& M) {
    x0_ = x0;
    M_ = M;
  }
  /// A stated sigma of the points; those of the poses stay.
  void set_point_sigma(double sigma_m);

  int rows() const { return data_rows_ + static_cast<int>(priors_.size()); }
  int data_rows() const { return data_rows_; }
  int unknowns() const { return static_cast<int>(M_.cols()); }
  ArcVector state(const Eigen::VectorXd& z) const { return x0_ + M_ * z; }
  const Eigen::Matrix<double, 9, Eigen::Dynamic>& by_unknowns() const { return M_; }
  const std::vector<ArcObservation>& observations() const { return observations_; }
  Pose T_frame_base(const ArcVector& x) const { return T_start_ * Pose{exp_so3(x.tail<3>()), x.segment<3>(3)}; }

  /// r and, where J is not null, dr/dz. False where the rod has no shape.
  bool evaluate(const Eigen::VectorXd& z, Eigen::VectorXd& r, Eigen::MatrixXd* J) const;
  /// Sensor poses at x in the frame of the data.
  std::vector<Pose> poses(const ArcVector& x) const;
  /// dr by a curvature about d1 or d2 that is 1 1/m larger at the end than at the clamp, its mean unchanged.
  Eigen::VectorXd by_change_along(const Eigen::VectorXd& z, int axis) const;

 private:
  RodSolution<3> solve(const Vector3d& precurvature, const Eigen::Vector2d& change_along, bool& solved) const;
  bool residuals(const ArcVector& x, const Eigen::Vector2d& change_along, Eigen::VectorXd& r,
                 Eigen::Matrix<double, Eigen::Dynamic, 9>* by_x) const;
  PredictedSensor<9> predict(const ArcObservation& seen, const RodPoint& point, const RodPointTangent<3>& tangent,
                             const ArcVector& x) const;

  Rod rod_;
  std::vector<double> arc_lengths_;
  std::vector<ArcObservation> observations_;
  std::vector<ArcPrior> priors_;
  int data_rows_ = 0;
  Pose T_start_;
  ArcVector x0_ = ArcVector::Zero();
  Eigen::Matrix<double, 9, Eigen::Dynamic> M_;
};

}  // namespace palpate
