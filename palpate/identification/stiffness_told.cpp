// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/QR>
#include <cmath>
#include <limits>
#include <palpate/identification/stiffness_steps.hpp>
#include <palpate/math/errors.hpp>

namespace palpate::stiffness {

namespace {

struct Untold {
  int stiffness = -1;
  double log_sigma = 0.0, alone = 0.0;
};

Untold least_told(const Problem& problem) {
  const Unknowns& unknowns = problem.unknowns();
  Untold worst;
  for (int k = 0; k < static_cast<int>(unknowns.stiffnesses().size()); ++k) {
    const int i = unknowns.index_of(k);
    if (i < 0) continue;
    const double sigma = sigma_of(problem.jacobian(), i);
    if (sigma >= worst.log_sigma) worst = {k, sigma, sigma_of(problem.jacobian(), i, true)};
  }
  return worst;
}

/// Why the loads do not tell it.
std::string cause(const std::string& name, bool alone) {
  if (!alone) return "these loads do not tell it apart from the other unknowns";
  if (name == "EI1") return "all loads bend the shaft about d2, or too little about d1";
  if (name == "EI2") return "all loads bend the shaft about d1, or too little about d2";
  if (name == "GJ") return "no load twists the shaft enough";
  if (name == "shear stiffness") return "no load shears the shaft enough";
  return "no load bends the shaft enough";
}

std::string shown(const Unknowns::Stiffness& s) {
  return fmt::format("{:.6g} {}", s.described, s.name == "shear stiffness" ? "N" : "N m^2");
}

}  // namespace

double sigma_of(const Eigen::MatrixXd& jacobian, Eigen::Index index, bool alone) {
  const Eigen::VectorXd column = jacobian.col(index);
  if (alone || jacobian.cols() == 1) return 1.0 / column.norm();
  Eigen::MatrixXd others(jacobian.rows(), jacobian.cols() - 1);
  others << jacobian.leftCols(index), jacobian.rightCols(jacobian.cols() - 1 - index);
  const Eigen::VectorXd norms = others.colwise().norm().transpose();
  if (norms.isZero(0.0)) return 1.0 / column.norm();  // a pivoted QR of zeros solves to infinity
  for (Eigen::Index i = 0; i < others.cols(); ++i)
    if (norms(i) > 0.0) others.col(i) /= norms(i);
  const Eigen::VectorXd left = column - others * others.colPivHouseholderQr().solve(column);
  return left.norm() > 1e-9 * column.norm() ? 1.0 / left.norm() : std::numeric_limits<double>::infinity();
}

Eigen::MatrixXd covariance_of(const Eigen::MatrixXd& jacobian) {
  const Eigen::VectorXd scale = jacobian.colwise().norm().cwiseInverse().transpose();
  const Eigen::Index n = jacobian.cols();
  const Eigen::MatrixXd R = Eigen::MatrixXd(jacobian * scale.asDiagonal()).householderQr().matrixQR().topRows(n);
  const Eigen::MatrixXd root =
      scale.asDiagonal() * R.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(n, n));
  return root * root.transpose();
}

bool hold_untold(Problem& problem, Eigen::VectorXd& z, std::vector<std::string>& warnings, double most_log_sigma) {
  bool held = false;
  for (;;) {
    if (!problem.evaluate(z)) throw InputError("stiffness: an equilibrium was lost; are the loads right?");
    const Untold worst = least_told(problem);
    if (!(worst.log_sigma > most_log_sigma)) return held;
    Unknowns& unknowns = problem.unknowns();
    if (unknowns.free_stiffnesses() == 1)
      throw InputError(
          "the loaded shapes differ from the unloaded one by no more than the points are unsure of: expected points "
          "that the loads move (not collinear with the unloaded shaft) or heavier loads");
    const Unknowns::Stiffness& s = unknowns.stiffnesses()[static_cast<std::size_t>(worst.stiffness)];
    warnings.push_back(
        fmt::format("{} is not told: {}; it keeps {}", s.name, cause(s.name, worst.alone > kToldLogSigma), shown(s)));
    const Eigen::Index i = unknowns.index_of(worst.stiffness), after = z.size() - 1 - i;
    const Eigen::VectorXd rest = z.tail(after);
    z.conservativeResize(z.size() - 1);
    z.tail(after) = rest;
    unknowns.hold(worst.stiffness);
    held = true;
  }
}

}  // namespace palpate::stiffness
