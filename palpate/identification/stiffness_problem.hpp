// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <palpate/identification/minimisers.hpp>
#include <palpate/identification/stiffness_case.hpp>

/// All load cases and the prior of the nuisances as one least-squares problem in z.
namespace palpate::stiffness {

class Problem {
 public:
  Problem(const Catheter& catheter, std::span<const LoadCase> cases, const StiffnessOptions& options);

  Unknowns& unknowns() { return unknowns_; }
  const Unknowns& unknowns() const { return unknowns_; }
  std::vector<CaseModel>& cases() { return cases_; }

  int measured() const { return measured_; }  ///< components
  int rows() const { return measured_ + unknowns_.nuisances(); }

  /// r(z): the cases' residuals, then the nuisances. The last z is remembered. False: an equilibrium was lost.
  bool evaluate(const Eigen::VectorXd& z);
  const Eigen::VectorXd& residual() const { return residual_; }
  const Eigen::MatrixXd& jacobian() const { return jacobian_; }
  Residuals residuals();

  /// |r|^2 / 2 of the cases where all stiffnesses have the same logarithm; infinite where an equilibrium is lost.
  double cost_at_scale(double log_scale);

  /// |r|^2 / 2 at these stiffnesses and at the nuisances that suit them best; `z` gets them. Infinite: lost.
  double profiled_cost(Eigen::VectorXd& z);

  bool sigma_stated() const { return sigma_stated_; }
  double unknown_sigma_m() const { return unknown_sigma_m_; }
  void set_unknown_sigma(double sigma_m);
  void forget() { evaluated_.resize(0); }
  /// The shapes met so far lay on another branch: none of them is a place to start again from.
  void leave_branch();

  /// Where the next evaluation follows the shapes from.
  using Start = std::vector<CaseModel::Start>;
  Start start() const;
  void set_start(const Start& start);

  int cost_evaluations() const { return cost_evaluations_; }
  int rod_evaluations() const;

 private:
  bool too_far(const Eigen::VectorXd& z, const std::pair<Eigen::VectorXd, double>& from) const;
  bool evaluate_numbers(const Numbers& q, double closed_rad);

  Unknowns unknowns_;
  std::vector<CaseModel> cases_;
  int measured_ = 0;
  bool sigma_stated_ = true;
  double unknown_sigma_m_ = 1e-3;
  Eigen::VectorXd evaluated_, residual_, measured_residual_;
  Eigen::MatrixXd jacobian_;
  Eigen::Matrix<double, Eigen::Dynamic, kNumbers> by_q_;
  Start anchor_;  ///< at the least cost met: where to start again from when a far step lost the shapes
  double anchor_cost_ = std::numeric_limits<double>::infinity();
  int cost_evaluations_ = 0;
};

}  // namespace palpate::stiffness
