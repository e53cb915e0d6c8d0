// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <palpate/identification/stiffness_fit.hpp>

namespace palpate {

namespace {

using stiffness::Fitted;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

struct Squares {
  double sum = 0.0;
  int count = 0;
  double rms() const { return count > 0 ? std::sqrt(sum / count) : 0.0; }
};

/// Measured minus fitted; nothing where not measured, or where z told the place along the shaft.
StiffnessFit::Case case_of(const stiffness::CaseModel& model, Squares& all) {
  StiffnessFit::Case out;
  out.name = model.load_case().name;
  Squares own;
  for (std::size_t i = 0; i < model.points().size(); ++i) {
    const ShapePoint& measured = model.load_case().points[i];
    const Pose& fitted = model.points()[i].T_base_point;
    Vector3d residual = measured.position_base_m - fitted.p;
    if (std::isnan(measured.arc_length_m)) residual.z() = kNone;
    for (int axis = 0; axis < 3; ++axis) {
      if (std::isnan(residual(axis))) continue;
      own.sum += residual(axis) * residual(axis);
      ++own.count;
    }
    out.residual_m.push_back(residual);
    out.T_base_point.push_back(fitted);
  }
  out.rms_m = own.rms();
  all.sum += own.sum;
  all.count += own.count;
  return out;
}

/// Rms of the sigmas of the measured components.
double stated_sigma_m(std::span<const LoadCase> cases) {
  Squares squares;
  for (const LoadCase& one : cases)
    for (const ShapePoint& point : one.points)
      for (int axis = 0; axis < 3; ++axis) {
        if (std::isnan(point.position_base_m(axis))) continue;
        squares.sum += point.sigma_m(axis) * point.sigma_m(axis);
        ++squares.count;
      }
  return squares.rms();
}

void put_covariance(const Fitted& fitted, StiffnessFit& out) {
  const auto& unknowns = fitted.problem.unknowns();
  const auto n = static_cast<int>(unknowns.stiffnesses().size());
  out.log_covariance = Eigen::MatrixXd::Zero(n, n);
  out.correlation = Eigen::MatrixXd::Identity(n, n);
  for (int a = 0; a < n; ++a) {
    const int i = unknowns.index_of(a);
    out.log_covariance(a, a) = i < 0 ? std::numeric_limits<double>::infinity() : fitted.covariance(i, i);
    for (int b = 0; b < n; ++b) {
      const int j = unknowns.index_of(b);
      if (i < 0 || j < 0 || a == b) continue;
      out.log_covariance(a, b) = fitted.covariance(i, j);
      out.correlation(a, b) = fitted.covariance(i, j) / std::sqrt(fitted.covariance(i, i) * fitted.covariance(j, j));
    }
  }
}

}  // namespace

namespace stiffness {

std::vector<StiffnessUnknown> unknowns_of(const Fitted& fitted) {
  const Unknowns& unknowns = fitted.problem.unknowns();
  std::vector<StiffnessUnknown> out;
  for (int k = 0; k < static_cast<int>(unknowns.stiffnesses().size()); ++k) {
    const Unknowns::Stiffness& s = unknowns.stiffnesses()[static_cast<std::size_t>(k)];
    const int i = unknowns.index_of(k);
    if (i < 0)
      out.push_back({s.name, s.described, std::numeric_limits<double>::infinity()});
    else
      out.push_back({s.name, s.described * std::exp(fitted.z(i)), std::sqrt(fitted.covariance(i, i))});
  }
  return out;
}

}  // namespace stiffness

StiffnessFit identify_stiffness(const Catheter& catheter, std::span<const LoadCase> cases,
                                const StiffnessOptions& options) {
  Fitted fitted = stiffness::fit(catheter, cases, options);
  stiffness::Problem& problem = fitted.problem;
  StiffnessFit out;
  out.converged = fitted.minimum.converged;
  out.rod = problem.unknowns().identified(fitted.z);
  out.unknowns = stiffness::unknowns_of(fitted);
  put_covariance(fitted, out);
  Squares all;
  for (const stiffness::CaseModel& one : problem.cases()) out.cases.push_back(case_of(one, all));
  out.rms_m = all.rms();
  out.chi_square = fitted.chi_square;
  out.degrees_of_freedom = fitted.degrees_of_freedom;
  out.point_sigma_m = problem.sigma_stated() ? stated_sigma_m(cases) : problem.unknown_sigma_m();
  out.iterations = fitted.minimum.iterations;
  out.cost_evaluations = problem.cost_evaluations();
  out.rod_evaluations = problem.rod_evaluations();
  out.warnings = std::move(fitted.warnings);
  return out;
}

}  // namespace palpate
