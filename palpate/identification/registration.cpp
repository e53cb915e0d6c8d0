// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <palpate/estimation/consistency.hpp>
#include <palpate/identification/registration.hpp>
#include <palpate/identification/registration_checks.hpp>
#include <palpate/identification/registration_fit.hpp>
#include <palpate/identification/registration_starts.hpp>

namespace palpate {

namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

double largest_axis(const Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, axes.eigenvalues().maxCoeff()));
}

constexpr int kMostIterations = 60;

void sort_by_cost(std::vector<RegistrationFit>& fits) {
  std::sort(fits.begin(), fits.end(),
            [](const RegistrationFit& one, const RegistrationFit& other) { return one.chi_square < other.chi_square; });
}

/// Of two bases rolled by 180 deg against each other, which nothing but a sign tells apart, the one with which the
/// shaft bends to the stated side.
void keep_stated_side(RegistrationModel& model, const RegistrationWeights& weights,
                      std::vector<RegistrationFit>& fits) {
  constexpr double kAsGood = 12.0;
  if (fits.empty() || !std::isfinite(fits.front().chi_square)) return;
  if (bend_towards_stated(model, fits.front().state) < 0.0)
    fits.push_back(fit_registration(model, weights, rolled_half_a_turn(model, fits.front().state), kMostIterations));
  const double enough = fits.front().chi_square + kAsGood;
  const auto as_stated = [&](const RegistrationFit& fit) {
    return fit.chi_square < enough && bend_towards_stated(model, fit.state) >= 0.0;
  };
  if (std::any_of(fits.begin(), fits.end(), as_stated))
    std::erase_if(fits, [&](const RegistrationFit& fit) { return !as_stated(fit); });
  sort_by_cost(fits);
}

std::vector<RegistrationFit> fit_from_all_starts(RegistrationModel& model, const RegistrationWeights& weights) {
  constexpr int kStarts = 8, kStartsWithoutPoses = 24;
  const bool whole = std::any_of(model.readings().begin(), model.readings().end(),
                                 [](const RegistrationReading& reading) { return reading.rows == 6; });
  std::vector<RegistrationFit> fits;
  for (const RegistrationState& start : registration_starts(model, whole ? kStarts : kStartsWithoutPoses))
    fits.push_back(fit_registration(model, weights, start, kMostIterations));
  sort_by_cost(fits);
  if (!whole) keep_stated_side(model, weights, fits);
  return fits;
}

/// Residuals, sensor by sensor; the base axes are those found.
void add_residuals(const RegistrationModel& model, const RegistrationWeights& weights,
                   const RegistrationModel::Evaluation& at, Registration& out) {
  const Matrix3d R_base_reference = out.T_reference_base.R.transpose();
  const Eigen::MatrixXd noise = weights.noise_factor * weights.noise_factor.transpose();
  double position = 0.0, rotation = 0.0;
  int oriented = 0;
  for (const RegistrationReading& reading : model.readings()) {
    const Eigen::VectorXd r = at.residual.segment(reading.first_row, reading.rows);
    Registration::Residual residual{.seen = true, .frames = reading.mean->count};
    residual.position_m = R_base_reference * r.head<3>();
    residual.rotation_rad.head(reading.rows - 3) = r.tail(reading.rows - 3);
    const Eigen::MatrixXd own = noise.block(reading.first_row, reading.first_row, reading.rows, reading.rows);
    residual.chi_square = r.dot(own.llt().solve(r));
    residual.sigma_m = std::sqrt(own(0, 0));
    if (reading.rows > 3) residual.sigma_rad = std::sqrt(own(3, 3));
    position += residual.position_m.squaredNorm();
    rotation += residual.rotation_rad.squaredNorm();
    oriented += reading.rows > 3 ? 1 : 0;
    out.positions[static_cast<std::size_t>(reading.position)].residuals[static_cast<std::size_t>(reading.sensor)] =
        residual;
  }
  out.position_rms_m = std::sqrt(position / static_cast<double>(model.readings().size()));
  if (oriented > 0) out.rotation_rms_rad = std::sqrt(rotation / oriented);
}

/// Unknowns that a prior holds fast are none.
void add_chi_square(const RegistrationModel& model, const RegistrationWeights& weights, double chi_square,
                    Registration& out) {
  const auto is_prior = [](double sigma) {
    return sigma > RegistrationWeights::kFixed && sigma < RegistrationWeights::kFree;
  };
  const auto& sigma = weights.prior_sigma;
  const auto priors = static_cast<int>(std::count_if(sigma.begin(), sigma.end(), is_prior));
  const auto fixed = static_cast<int>(std::count(sigma.begin(), sigma.end(), RegistrationWeights::kFixed));
  out.chi_square = chi_square;
  out.degrees_of_freedom = model.rows() + priors + fixed - model.unknowns();
  constexpr double kTail = 1e-3;
  if (out.degrees_of_freedom > 0 && chi_square > chi_square_tail_quantile(kTail, out.degrees_of_freedom))
    out.sigma_inflation = std::sqrt(chi_square / out.degrees_of_freedom);
}

void add_unknowns(const RegistrationModel& model, const RegistrationFit& fit, const Eigen::MatrixXd& covariance,
                  Registration& out) {
  const Eigen::VectorXd sigma = covariance.diagonal().cwiseSqrt();
  out.base_covariance = covariance.topLeftCorner<6, 6>();
  Vector3d stated = Vector3d::Zero();
  for (const Section& section : model.catheter().rod.sections) {
    if (section.rigid) continue;
    stated = section.precurvature_per_m;
    break;
  }
  for (int j = 0; j < model.positions(); ++j) {
    Registration::Position& position = out.positions[static_cast<std::size_t>(j)];
    const Eigen::Vector2d& bend = fit.state.bend_change_per_m[static_cast<std::size_t>(j)];
    position.precurvature_per_m = stated + Vector3d(bend.x(), bend.y(), fit.state.twist_change_per_m);
    position.sigma_per_m << sigma.segment<2>(RegistrationModel::bend_column(j)), sigma(RegistrationModel::kTwistColumn);
  }
  for (int i = 0; i < model.sensors(); ++i) {
    Registration::Mounting mounting{.T_local_sensor = fit.state.T_local_sensor[static_cast<std::size_t>(i)]};
    if (model.mounting()) {
      mounting.sigma_m = sigma.segment<3>(model.mount_column(i));
      mounting.sigma_rad = sigma.segment<3>(model.mount_column(i) + 3);
    }
    out.mountings.push_back(mounting);
  }
}

/// The base sensor is the point about which the estimator turns a tracked base.
void put_into_catheter(bool mounting, Registration& out) {
  BaseRegistration& base = out.catheter.base;
  Matrix6d about_pivot = Matrix6d::Identity();
  if (base.tracked) {
    base.sensor.T_local_sensor = out.T_reference_base.inverse();
    about_pivot.topRightCorner<3, 3>() = -hat(base.sensor.T_local_sensor.p);
  } else {
    base.T_tracker_base = out.T_reference_base;
  }
  const Matrix6d covariance = about_pivot * out.base_covariance * about_pivot.transpose();
  base.covariance = covariance;
  base.position_sigma_m = largest_axis(covariance.topLeftCorner<3, 3>());
  base.rotation_sigma_rad = largest_axis(covariance.bottomRightCorner<3, 3>());
  for (std::size_t i = 0; mounting && i < out.mountings.size(); ++i) {
    Sensor& sensor = out.catheter.sensors[i];
    if (sensor.T_tracker_base) continue;
    sensor.T_local_sensor = out.mountings[i].T_local_sensor;
    sensor.mount_sigma_m = out.mountings[i].sigma_m.maxCoeff();
  }
}

std::vector<Registration::Position> empty_positions(std::span<const KnobPosition> positions) {
  std::vector<Registration::Position> out;
  for (const KnobPosition& position : positions) {
    out.push_back({.name = position.name});
    out.back().residuals.resize(position.poses.size());
  }
  return out;
}

}  // namespace

void RegistrationOptions::validate() const {
  require_in_range("mount_sigma_m", mount_sigma_m, 0.1);
  require_in_range("mount_sigma_rad", mount_sigma_rad, 1.5708);
}

Registration identify_registration(const Catheter& catheter, std::span<const KnobPosition> positions,
                                   const RegistrationOptions& options) {
  options.validate();
  RegistrationModel model(catheter, positions, options.mounting);
  require_enough_readings(model, positions);
  const RegistrationWeights weights = weights_of(model, options);
  const std::vector<RegistrationFit> fits = fit_from_all_starts(model, weights);
  if (fits.empty() || !std::isfinite(fits.front().chi_square))
    throw InputError("registration: no base explains the poses: expected those of this catheter's unloaded shaft");

  const RegistrationFit& best = fits.front();
  Registration out{.converged = best.converged, .catheter = catheter};
  out.starts = static_cast<int>(fits.size());
  for (const RegistrationFit& fit : fits) out.iterations += fit.iterations;
  out.T_reference_base = best.state.T_reference_base;
  out.positions = empty_positions(positions);
  RegistrationState from = model.stated();
  from.T_reference_base = best.state.T_reference_base;
  WhitenedRegistration at;
  whiten(model, weights, from, best.x, at);
  RegistrationModel::Evaluation raw;
  model.evaluate(from, best.x, raw);
  add_residuals(model, weights, raw, out);
  require_near(model, out);
  add_chi_square(model, weights, best.chi_square, out);
  const Eigen::MatrixXd information = at.jacobian.transpose() * at.jacobian;
  require_all_told(model, weights, information);
  const Eigen::MatrixXd covariance =
      information.llt().solve(Eigen::MatrixXd::Identity(model.unknowns(), model.unknowns()));
  add_unknowns(model, best, std::pow(out.sigma_inflation, 2) * covariance, out);
  put_into_catheter(options.mounting, out);
  out.warnings = registration_warnings(model, weights, fits, out);
  return out;
}

}  // namespace palpate
