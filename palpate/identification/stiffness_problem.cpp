// SPDX-License-Identifier: Apache-2.0
#include <Eigen/QR>
#include <memory>
#include <palpate/identification/stiffness_problem.hpp>
#include <utility>

namespace palpate::stiffness {

Problem::Problem(const Catheter& catheter, std::span<const LoadCase> cases, const StiffnessOptions& options)
    : unknowns_(catheter, options) {
  const Unknowns& u = unknowns_;
  const NumbersByUnknown d = u.derivative(u.start(0.0));
  Moving moving;
  moving.shear = u.described().shears();
  moving.turn = !d.middleRows<3>(kTurn).isZero(0.0);
  moving.precurvature = !d.middleRows<3>(kPrecurvature).isZero(0.0);
  for (const LoadCase& load_case : cases) {
    cases_.emplace_back(u.described(), load_case, options.own_weight, moving, Vector3d::Zero());
    measured_ += cases_.back().rows();
    for (const ShapePoint& point : load_case.points) sigma_stated_ = sigma_stated_ && !point.sigma_m.isZero(0.0);
  }
  measured_residual_.resize(measured_);
  by_q_.setZero(measured_, kNumbers);
}

void Problem::set_unknown_sigma(double sigma_m) {
  unknown_sigma_m_ = sigma_m;
  anchor_cost_ = std::numeric_limits<double>::infinity();
  forget();
}

void Problem::leave_branch() {
  forget();
  anchor_.clear();
  anchor_cost_ = std::numeric_limits<double>::infinity();
}

Problem::Start Problem::start() const {
  Start start;
  for (const CaseModel& one : cases_) start.push_back(one.start());
  return start;
}

void Problem::set_start(const Start& start) {
  for (std::size_t i = 0; i < cases_.size(); ++i) cases_[i].set_start(start[i]);
  forget();
}

int Problem::rod_evaluations() const {
  int sum = 0;
  for (const CaseModel& one : cases_) sum += one.evaluations();
  return sum;
}

bool Problem::evaluate_numbers(const Numbers& q, double closed_rad) {
  ++cost_evaluations_;
  int row = 0;
  for (CaseModel& one : cases_) {
    const int rows = one.rows();
    if (!one.evaluate(q, unknown_sigma_m_, measured_residual_.segment(row, rows), by_q_.middleRows(row, rows),
                      closed_rad))
      return false;
    row += rows;
  }
  return true;
}

bool Problem::evaluate(const Eigen::VectorXd& z) {
  if (evaluated_.size() == z.size() && evaluated_ == z) return true;
  forget();
  const Numbers q = unknowns_.numbers(z);
  if (!evaluate_numbers(q, kClosed_rad)) {
    if (anchor_.empty()) return false;
    set_start(anchor_);
    if (!evaluate_numbers(q, kClosed_rad)) {
      set_start(anchor_);
      return false;
    }
  }
  const int nuisances = unknowns_.nuisances();
  residual_.resize(rows());
  residual_ << measured_residual_, z.tail(nuisances);
  jacobian_.setZero(rows(), z.size());
  jacobian_.topRows(measured_) = by_q_ * unknowns_.derivative(z);
  jacobian_.bottomRightCorner(nuisances, nuisances).setIdentity();
  evaluated_ = z;
  if (residual_.squaredNorm() < anchor_cost_) {
    anchor_cost_ = residual_.squaredNorm();
    anchor_ = start();
  }
  return true;
}

/// A step of a stiffness by more than a factor of e: a linear model is of no use there, nor a shape to be followed.
bool Problem::too_far(const Eigen::VectorXd& z, const std::pair<Eigen::VectorXd, double>& from) const {
  const int n = unknowns_.free_stiffnesses();
  return from.first.size() == z.size() && (z - from.first).head(n).cwiseAbs().maxCoeff() > 1.0;
}

Residuals Problem::residuals() {
  using Accepted = std::pair<Eigen::VectorXd, double>;  // what a minimiser goes on from: the least so far
  const auto from = std::make_shared<Accepted>(Eigen::VectorXd(), std::numeric_limits<double>::infinity());
  return [this, from](const Eigen::VectorXd& z, Eigen::VectorXd& r, Eigen::MatrixXd& by_z) {
    if (too_far(z, *from) || !evaluate(z)) return false;
    if (const double cost = residual_.squaredNorm(); cost <= from->second) *from = {z, cost};
    r = residual_;
    by_z = jacobian_;
    return true;
  };
}

double Problem::cost_at_scale(double log_scale) {
  forget();
  if (!evaluate_numbers(unknowns_.scaled(log_scale), kNearlyClosed_rad)) return std::numeric_limits<double>::infinity();
  return 0.5 * measured_residual_.squaredNorm();
}

double Problem::profiled_cost(Eigen::VectorXd& z) {
  const int n = unknowns_.nuisances();
  for (int i = 0; i < 8; ++i) {
    if (!evaluate(z)) return std::numeric_limits<double>::infinity();
    if (n == 0) break;
    const Eigen::VectorXd step = -jacobian_.rightCols(n).householderQr().solve(residual_);
    if (step.norm() < 1e-7) break;
    z.tail(n) += step;
  }
  return evaluate(z) ? 0.5 * residual_.squaredNorm() : std::numeric_limits<double>::infinity();
}

}  // namespace palpate::stiffness
