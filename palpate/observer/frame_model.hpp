// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/estimation/adaptation.hpp>
#include <palpate/estimation/belief.hpp>
#include <palpate/estimation/update.hpp>
#include <palpate/sensing/shape_model.hpp>

/// One frame as the filters see it. Its unknowns are x = (F, p_rod), force and parameters that bend the rod; errors of
/// the measured poses, b, enter linearly and are integrated out:
///
///   b | x ~ N(Gamma (x - x0), P_b|x),   Gamma = P_bx P_xx^-1,   P_b|x = P_bb - Gamma P_xb
///   r(x) - B Gamma (x - x0),   J + B Gamma,   R + B P_b|x B^T
namespace palpate {

/// Prior of one frame. Allocates at its first set() only.
struct FramePrior {
  Gaussian x;
  Eigen::MatrixXd pose_by_x;        ///< Gamma, pose errors x states
  Eigen::MatrixXd pose_covariance;  ///< P_b|x

  /// Of the first `states` of (F, p); the rest are pose errors. `wider_N` is added to the sigma of the force.
  void set(const SeenBelief& seen, int states, double wider_N = 0.0);
};

/// A MeasurementModel, BlockModel and SeededModel: the sensors selected in `shape`, their noise as adapted so far.
class FrameModel {
 public:
  FrameModel(ShapeModel& shape, const NoiseAdaptation* adaptation, const FramePrior& prior);

  int rows() const { return shape_.rows(); }
  int block_end(int row) const { return shape_.block_end(row); }
  void noise(ResidualMatrix& R) const;
  bool linearize(const StateVector& x, Linearization& at);
  bool seed(int k, StateVector& x, int& evaluations) { return shape_.seed(k, x, evaluations); }

  /// What an update made of the frame, pose errors as parameters of their own again.
  void line(const UpdateLine& update, FrameLine& out) const;

 private:
  void white_noise(ResidualMatrix& R) const;

  ShapeModel& shape_;
  const NoiseAdaptation* adaptation_;
  const FramePrior& prior_;
  PoseErrorMatrix pose_errors_;     ///< B
  JacobianMatrix along_x_;          ///< B Gamma
  ResidualMatrix pose_covariance_;  ///< B P_b|x B^T
};

}  // namespace palpate
