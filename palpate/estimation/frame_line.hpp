// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/estimation/force_gaussian.hpp>
#include <palpate/estimation/motion_state.hpp>
#include <palpate/math/linearization.hpp>

namespace palpate {

/// What one frame says, as a straight line: r(F, p) = residual - J_F (F - F_0) - J_p (p - p_0), up to N(0, noise).
struct FrameLine {
  template <int Columns, int MaxColumns = Columns>
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Columns, Eigen::ColMajor, kMaxResiduals, MaxColumns>;

  Vector3d force_N = Vector3d::Zero();  ///< F_0
  Eigen::VectorXd parameters;           ///< p_0
  ResidualVector residual;
  Rows<3> by_force;
  Rows<Eigen::Dynamic, kMaxParameters> by_parameters;
  ResidualMatrix noise;
  /// Projector on directions of the force that the first so many rows are not asked about (hide_axial_force).
  Matrix3d hidden = Matrix3d::Zero();
  Eigen::Index hiding_rows = 0;
};

/// The same said in three rows with unit noise, where it speaks of the force alone: of the rows whitened, those that an
/// orthogonal transformation leaves with the force in them. What is lost, the misfit, no correction depends on. Left as
/// it is where there are parameters, no more than three rows, or the noise is not positive definite.
void compress(FrameLine& line);

/// Hides the axial force from a frame that knows it worse than `weak_N`, noise and parameters (of covariance P_pp)
/// together; true where it did. An axial force acts on a shaft through its bend, as 1 / (1 - F / F_E) does on a column:
/// beyond some share of the buckling load F_E its effect is no straight line, and where there is hardly a bend, it is a
/// product of errors. Taken for information, frame after frame, it drives the force off with a small sigma. It is
/// considered instead, as a parameter is: part of S, and not corrected.
///
/// Once hidden (`hidden_before`) it stays so until a frame knows it to 0.6 weak_N. What a frame knows depends on the
/// force it is solved for: one threshold would let in just the frames whose noise makes them look informed.
bool hide_axial_force(double weak_N, bool hidden_before, const Eigen::MatrixXd& parameter_covariance, FrameLine& line);

/// A line that says the same as a likelihood of the force alone; of `parameters` parameters it says nothing.
FrameLine line_of(const ForceLikelihood& likelihood, Eigen::Index parameters);

}  // namespace palpate
