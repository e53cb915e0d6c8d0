// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <palpate/identification/smooth_branch.hpp>

namespace palpate {

namespace {

/// Derivatives of the slopes, times the step, by the values at the knots: as TendonPlay makes them, but for its limits.
Eigen::MatrixXd slopes(Eigen::Index n) {
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(n, n);
  S(0, 0) = S(n - 1, n - 2) = -1.0;
  S(0, 1) = S(n - 1, n - 1) = 1.0;
  for (Eigen::Index i = 1; i + 1 < n; ++i) {
    S(i, i - 1) = -0.5;
    S(i, i + 1) = 0.5;
  }
  return S;
}

Eigen::MatrixXd basis(const std::vector<double>& x, const std::vector<double>& knots) {
  const auto n = static_cast<Eigen::Index>(knots.size());
  const Eigen::MatrixXd S = slopes(n);
  Eigen::MatrixXd B = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(x.size()), n);
  const double step = (knots.back() - knots.front()) / static_cast<double>(n - 1);
  for (std::size_t k = 0; k < x.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const double place = (x[k] - knots.front()) / step;
    const Eigen::Index i = std::clamp<Eigen::Index>(static_cast<Eigen::Index>(std::floor(place)), 0, n - 2);
    const double t = place - static_cast<double>(i), t2 = t * t, t3 = t2 * t;
    B(row, i) += 2.0 * t3 - 3.0 * t2 + 1.0;
    B(row, i + 1) += 3.0 * t2 - 2.0 * t3;
    B.row(row) += (t3 - 2.0 * t2 + t) * S.row(i) + (t3 - t2) * S.row(i + 1);
  }
  return B;
}

Eigen::MatrixXd second_differences(Eigen::Index n) {
  Eigen::MatrixXd D = Eigen::MatrixXd::Zero(std::max<Eigen::Index>(n - 2, 0), n);
  for (Eigen::Index i = 0; i < D.rows(); ++i) D.row(i).segment<3>(i) << 1.0, -2.0, 1.0;
  return D;
}

}  // namespace

SmoothBranch smooth_branch(const std::vector<double>& x, const std::vector<double>& y,
                           const std::vector<double>& knots) {
  const auto n = static_cast<Eigen::Index>(x.size()), k = static_cast<Eigen::Index>(knots.size());
  const Eigen::Map<const Eigen::VectorXd> values(y.data(), n);
  const Eigen::MatrixXd B = basis(x, knots), D = second_differences(k);
  const Eigen::MatrixXd BtB = B.transpose() * B, DtD = D.transpose() * D;
  SmoothBranch best;
  double least = std::numeric_limits<double>::infinity();
  for (int i = -24; i <= 16; ++i) {
    const double lambda = std::pow(10.0, 0.25 * i);
    const Eigen::LDLT<Eigen::MatrixXd> factor(BtB + lambda * DtD);
    const double trace = factor.solve(BtB).trace();
    const Eigen::VectorXd v = factor.solve(B.transpose() * values);
    const double rss = (values - B * v).squaredNorm(), left = static_cast<double>(n) - trace;
    const double score = left > 0.5 ? static_cast<double>(n) * rss / (left * left) : least;
    if (!(score < least)) continue;
    least = score;
    best = {v, factor.solve(Eigen::MatrixXd::Identity(k, k)).diagonal(), rss, trace};
  }
  return best;
}

}  // namespace palpate
