// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/estimation/smoother.hpp>
#include <palpate/observer/observability.hpp>
#include <palpate/observer/options.hpp>
#include <vector>

namespace palpate {

/// What the catheter's uncertain numbers make of a force: where its sigma comes from, what is believed of the shaft,
/// what a frame cannot tell. No call but the constructor allocates or throws.
class ForceUncertainty {
 public:
  ForceUncertainty(const Catheter& catheter, const ObserverOptions& options, const UncertainParameters& parameters);

  /// The parameters as the filter takes them.
  const ParameterPrior& prior() const { return prior_; }

  /// A share of the buckling load: an axial force that a frame knows no better is not asked of it (hide_axial_force).
  double weak_force_N() const;

  /// f of a force F, the shaft being as it is believed to be (ParameterPrior::force_exponents).
  Vector3d followed(const Vector3d& force_tip_N, const Belief& belief) const;

  /// One source after the other is taken as known (the belief conditioned on it): what that takes off the force's
  /// variance is its share, considered sources first, then the estimated ones; what is left is noise. About 10 us with
  /// thirty parameters, nothing without.
  SigmaBudget budget(const ComponentRow& reported, const Belief& belief);

  /// The same of a smoothed frame; what the estimated parameters make of it counts as noise here.
  SigmaBudget budget(const SmoothedFrame& frame) const;

  ShaftEstimate shaft(const Eigen::VectorXd& parameters, const Eigen::MatrixXd& covariance) const;
  /// Of a smoothed frame, which tells the estimated parameters alone.
  ShaftEstimate shaft(const SmoothedFrame& frame) const;

  /// Of the frame that `line` speaks of, all parameters being as uncertain as before any frame; `belief` after it.
  Observability observability(const FrameLine& line, const Belief& belief, const Matrix3d& R_base_tip) const;

 private:
  /// Whitened information of one frame on the force and the estimated parameters.
  StateMatrix information(const FrameLine& line) const;
  ParameterPrior make_prior() const;
  Vector3d force_scale(const Belief& belief) const;
  double scale_sigma(const Eigen::MatrixXd& covariance) const;
  void find_weakest(const StateMatrix& information, const Belief& belief, Observability& out) const;

  Catheter catheter_;
  UncertainParameters parameters_;
  ParameterPrior prior_;
  double force_sigma_N_, buckling_N_;
  Eigen::Matrix<double, 3, Eigen::Dynamic> force_exponents_;
  std::vector<int> estimated_;  ///< but for the stiffness's rate, which no frame sees
  std::vector<int> lasting_;    ///< considered, and not drawn anew at every frame
  struct Group {
    UncertaintySource source;
    std::vector<int> members;  ///< of the parameters
  };
  std::vector<Group> groups_;  ///< considered ones first
  Eigen::MatrixXd work_;       ///< covariance of (F, p)
};

}  // namespace palpate
