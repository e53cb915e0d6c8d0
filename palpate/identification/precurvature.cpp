// SPDX-License-Identifier: Apache-2.0
#include <ceres/tiny_solver.h>
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <palpate/identification/arc_start.hpp>
#include <palpate/identification/arc_unknowns.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/math/units.hpp>

namespace palpate {

namespace {

constexpr double kGuessedSigma_m = 1e-4;  // of points without a stated one, until the residuals tell
constexpr double kRare = 1e-3;            // as improbable as that is worth a warning
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// ArcModel as ceres::TinySolver wants it: column-major Jacobian.
struct TinyProblem {
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Eigen::Dynamic };
  const ArcModel& model;

  int NumResiduals() const { return model.rows(); }
  int NumParameters() const { return model.unknowns(); }
  bool operator()(const double* z, double* residuals, double* jacobian) const {
    Eigen::VectorXd r;
    Eigen::MatrixXd J;
    if (!model.evaluate(Eigen::Map<const Eigen::VectorXd>(z, model.unknowns()), r, jacobian ? &J : nullptr))
      return false;
    Eigen::Map<Eigen::VectorXd>(residuals, r.size()) = r;
    if (jacobian) Eigen::Map<Eigen::MatrixXd>(jacobian, J.rows(), J.cols()) = J;
    return true;
  }
};

/// The optimum with its linearisation.
struct Optimum {
  Eigen::VectorXd z, r;
  Eigen::MatrixXd J, covariance;  ///< of z; what is not told has a huge one
  bool converged = false;
};

Optimum minimise(const ArcModel& model, const Eigen::VectorXd& start) {
  Optimum out;
  out.z = start;
  ceres::TinySolver<TinyProblem> solver;
  solver.options.max_num_iterations = 100;
  solver.options.gradient_tolerance = 1e-12;
  solver.options.parameter_tolerance = 1e-14;
  solver.options.function_tolerance = 0.0;
  solver.options.cost_threshold = 0.0;
  const TinyProblem problem{model};
  solver.Solve(problem, &out.z);
  if (!model.evaluate(out.z, out.r, &out.J)) return out;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> spectrum(out.J.transpose() * out.J);
  const Eigen::VectorXd eigenvalues = spectrum.eigenvalues().cwiseMax(1e-12);
  const Eigen::MatrixXd& V = spectrum.eigenvectors();
  out.covariance = V * eigenvalues.cwiseInverse().asDiagonal() * V.transpose();
  // The next step along what is told is a small part of its sigma.
  const Eigen::VectorXd along = V.transpose() * (out.J.transpose() * out.r);
  out.converged = true;
  for (Eigen::Index i = 0; i < along.size(); ++i)
    out.converged = out.converged && (eigenvalues(i) < 1.0 || std::abs(along(i)) < 1e-2 * std::sqrt(eigenvalues(i)));
  return out;
}

void require_one_arc(const Catheter& catheter) {
  const Vector3d& first = catheter.precurvature_per_m();
  for (std::size_t i = 0; i < catheter.rod.sections.size(); ++i) {
    const Section& section = catheter.rod.sections[i];
    if (section.rigid || (section.precurvature_per_m - first).norm() < 1e-9) continue;
    throw InputError(
        fmt::format("catheter: section {}: precurvature_per_m differs from that of the first flexible section: "
                    "expected the same in all, for one constant arc is fitted",
                    i + 1));
  }
}

/// Points without a stated sigma: the residuals tell it, with what is stated of the rest.
Optimum fit_with_noise(ArcModel& model, double stated_m, double& sigma_m) {
  Optimum best = minimise(model, Eigen::VectorXd::Zero(model.unknowns()));
  sigma_m = stated_m;
  if (stated_m > 0.0) return best;
  sigma_m = kGuessedSigma_m;
  for (int pass = 0; pass < 4; ++pass) {
    const int dof = model.rows() - model.unknowns();
    sigma_m = std::max(sigma_m * std::sqrt(best.r.squaredNorm() / dof), 1e-12);
    model.set_point_sigma(sigma_m);
    best = minimise(model, best.z);
  }
  return best;
}

/// Would a curvature that changes linearly along the shaft explain much of what is left? `told`: the sigmas are stated.
void test_constancy(const ArcModel& model, const Optimum& best, const std::array<bool, 3>& measured, bool told,
                    ArcFit& fit) {
  std::vector<int> axes;
  if (measured[1]) axes.push_back(0);
  if (measured[0]) axes.push_back(1);
  const auto q = static_cast<Eigen::Index>(axes.size()), n = best.J.cols();
  const Eigen::Index left = best.r.size() - n - q;
  if (left < 1) return;
  Eigen::MatrixXd A(best.J.rows(), n + q);
  A.leftCols(n) = best.J;
  for (Eigen::Index j = 0; j < q; ++j) A.col(n + j) = model.by_change_along(best.z, axes[static_cast<std::size_t>(j)]);
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor(A);
  if (factor.rank() < n + q) return;
  const Eigen::VectorXd by = factor.solve(-best.r);
  for (Eigen::Index j = 0; j < q; ++j) fit.change_along_per_m(axes[static_cast<std::size_t>(j)]) = by(n + j);
  const double rest = (best.r + A * by).squaredNorm(), gain = std::max(best.r.squaredNorm() - rest, 0.0);
  if (told) {
    const boost::math::chi_squared distribution(static_cast<double>(q));
    fit.change_probability = boost::math::cdf(boost::math::complement(distribution, gain));
  } else if (rest > 0.0) {
    const boost::math::fisher_f distribution(static_cast<double>(q), static_cast<double>(left));
    const double ratio = (gain / static_cast<double>(q)) / (rest / static_cast<double>(left));
    fit.change_probability = boost::math::cdf(boost::math::complement(distribution, ratio));
  }
  // A micrometre of misfit is rounding of the file, however regular.
  if (fit.change_probability > kRare || fit.rms_m < 1e-6) return;
  fit.warnings.push_back(
      fmt::format("the bend is no constant arc: the curvature changes by ({:.2f}, {:.2f}) 1/m from clamp to end "
                  "(probability by noise alone {:.1g})",
                  fit.change_along_per_m.x(), fit.change_along_per_m.y(), fit.change_probability));
}

Optimum fit_from_all_starts(ArcModel& model, const Eigen::Matrix<double, 9, Eigen::Dynamic>& M,
                            const Vector3d& stated_per_m, double length_m, double stated_m, double& sigma_m) {
  Optimum best;
  ArcVector best_start = ArcVector::Zero();
  double least = std::numeric_limits<double>::infinity();
  for (const ArcVector& start : arc_starts(model, M, stated_per_m, length_m)) {
    model.set_unknowns(start, M);
    const Optimum tried = minimise(model, Eigen::VectorXd::Zero(model.unknowns()));
    if (tried.r.size() == 0 || !(tried.r.squaredNorm() < least)) continue;
    least = tried.r.squaredNorm();
    best_start = start;
  }
  model.set_unknowns(best_start, M);
  return std::isfinite(least) ? fit_with_noise(model, stated_m, sigma_m) : best;
}

void warn(const Catheter& catheter, const ArcUnknowns& unknowns, const std::array<bool, 3>& measured, bool told,
          ArcFit& fit) {
  if (!fit.converged) fit.warnings.emplace_back("the fit did not converge: the figures are those of its last step");
  fit.doubtful = !fit.converged;
  if (told && fit.degrees_of_freedom > 0) {
    const boost::math::chi_squared distribution(fit.degrees_of_freedom);
    const double p = boost::math::cdf(boost::math::complement(distribution, fit.chi_square));
    if (p < kRare) {
      fit.doubtful = true;
      fit.covariance *= fit.chi_square / fit.degrees_of_freedom;
      fit.warnings.push_back(
          fmt::format("residuals are larger than the stated sigmas: chi-square {:.1f} for {} degrees of freedom, rms "
                      "{:.3f} mm: no constant arc, a wrong arc length or clamp, or a force on the tip; the sigmas were "
                      "made as much larger",
                      fit.chi_square, fit.degrees_of_freedom, fit.rms_m * kMillimetresPerMetre));
    }
  }
  if (unknowns.keeps_plane())
    fit.warnings.emplace_back(
        "with a free clamp, points do not tell the bending plane: it was kept as the catheter file has it");
  for (int axis = 0; axis < 2; ++axis)
    if (!measured[static_cast<std::size_t>(1 - axis)] && !fit.told[static_cast<std::size_t>(axis)])
      fit.warnings.push_back(fmt::format("k{},0 is not told by a picture from this side: it was kept", axis + 1));
  const Eigen::Matrix2d P = fit.covariance.topLeftCorner<2, 2>();
  const Eigen::Vector2d k = fit.precurvature_per_m.head<2>();
  const bool both = fit.told[0] && fit.told[1];
  if (both && !unknowns.keeps_plane() && k.dot(P.ldlt().solve(k)) < 5.99)
    fit.warnings.emplace_back("the shaft is straight within its sigma: no bending plane is told");
  if (!fit.told[2])
    fit.warnings.push_back(fmt::format("tau0 is not told{}: it was kept at {:.4g} 1/m",
                                       unknowns.tells_torsion() ? " by these poses" : " without orientations",
                                       catheter.precurvature_per_m().z()));
}

/// Precurvature with covariance, and what is told: better than by a radian over the length.
void report_bend(const Catheter& catheter, const ArcModel& model, const Optimum& best, const ArcUnknowns& unknowns,
                 ArcFit& fit) {
  const ArcVector x = model.state(best.z);
  const auto& M = model.by_unknowns();
  const Eigen::Matrix<double, 9, 9> P = M * best.covariance * M.transpose();
  fit.precurvature_per_m = x.head<3>();
  fit.covariance = P.topLeftCorner<3, 3>();
  for (int i = 0; i < 3; ++i) {
    const bool asked = M.row(i).cwiseAbs().maxCoeff() > 0.0 && (i < 2 || unknowns.tells_torsion());
    const bool told = asked && P(i, i) * std::pow(catheter.rod.length_m(), 2) < 1.0;
    fit.told[static_cast<std::size_t>(i)] = told;
    if (!told) fit.precurvature_per_m(i) = catheter.precurvature_per_m()(i);
  }
}

void report_places(const ArcModel& model, const Optimum& best, ArcFit& fit) {
  const ArcVector x = model.state(best.z);
  fit.T_frame_base = model.T_frame_base(x);
  const std::vector<Pose> fitted = model.poses(x);
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < fitted.size(); ++i) {
    const ArcObservation& seen = model.observations()[i];
    ArcFit::Place place{seen.sensor.arc_length_m, seen.measured.p, fitted[i].p, Vector3d::Constant(kNaN)};
    if (seen.sensor.kind == SensorKind::kPose) place.turn_rad = log_so3(fitted[i].R.transpose() * seen.measured.R);
    for (const double error : Vector3d(place.measured_m - place.fitted_m)) {
      if (!std::isfinite(error)) continue;
      sum += error * error;
      ++count;
    }
    fit.places.push_back(place);
  }
  fit.rms_m = std::sqrt(sum / count);
}

}  // namespace

ArcFit fit_arc(const Catheter& catheter, const ArcData& data, ClampKnowledge clamp) {
  require_one_arc(catheter);
  const std::array<bool, 3> measured = check_points(catheter, data);
  const ArcUnknowns unknowns(catheter, data, measured, clamp);
  ArcModel model(catheter, observations_of(catheter, data), unknowns.priors());
  const Eigen::Matrix<double, 9, Eigen::Dynamic> M = unknowns.matrix();
  if (model.rows() <= M.cols())
    throw InputError(fmt::format("{} numbers were measured for {} unknowns: expected more points or sensors",
                                 model.data_rows(), M.cols() - static_cast<int>(unknowns.priors().size())));
  const bool told = data.points.empty() || data.point_sigma_m > 0.0;
  model.set_point_sigma(told && !data.points.empty() ? data.point_sigma_m : kGuessedSigma_m);
  const ArcStart start = start_of(catheter, model, measured, clamp);
  model.set_start(start.T_frame_base);
  model.set_unknowns((ArcVector() << start.precurvature_per_m, 0, 0, 0, 0, 0, 0).finished(), M);

  ArcFit fit;
  const double stated_m = told ? std::max(data.point_sigma_m, kGuessedSigma_m * 1e-9) : 0.0;
  const Optimum best = clamp == ClampKnowledge::kFree
                           ? fit_with_noise(model, stated_m, fit.point_sigma_m)
                           : fit_from_all_starts(model, M, start.precurvature_per_m, catheter.rod.length_m(), stated_m,
                                                 fit.point_sigma_m);
  if (!best.r.allFinite() || best.r.size() == 0)
    throw InputError("no unloaded shaft comes near the data: expected places of this catheter");
  if (data.points.empty()) fit.point_sigma_m = 0.0;
  fit.converged = best.converged;
  fit.chi_square = best.r.squaredNorm();
  fit.degrees_of_freedom = model.rows() - model.unknowns();
  fit.interval_factor = told ? 1.959964 : boost::math::quantile(boost::math::students_t(fit.degrees_of_freedom), 0.975);
  report_bend(catheter, model, best, unknowns, fit);
  if (!fit.told[0] && !fit.told[1])
    throw InputError(
        "the data tell neither k1,0 nor k2,0 to a radian over the length: expected more points or sensors");
  report_places(model, best, fit);
  warn(catheter, unknowns, measured, told, fit);
  test_constancy(model, best, measured, told, fit);
  return fit;
}

std::vector<Vector3d> fitted_curve(const Catheter& catheter, const ArcFit& fit, int count) {
  std::vector<ArcObservation> along(static_cast<std::size_t>(count) + 1);
  for (int i = 0; i <= count; ++i) {
    along[static_cast<std::size_t>(i)].sensor.kind = SensorKind::kPosition;
    along[static_cast<std::size_t>(i)].sensor.arc_length_m = catheter.rod.length_m() * i / count;
  }
  ArcModel model(catheter, std::move(along), {});
  model.set_start(fit.T_frame_base);
  std::vector<Vector3d> curve;
  curve.reserve(static_cast<std::size_t>(count) + 1);
  for (const Pose& pose : model.poses((ArcVector() << fit.precurvature_per_m, 0, 0, 0, 0, 0, 0).finished()))
    curve.push_back(pose.p);
  return curve;
}

}  // namespace palpate
