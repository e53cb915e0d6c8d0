// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <palpate/identification/registration_checks.hpp>

namespace palpate {

namespace {

constexpr std::array<std::string_view, 3> kAxes = {"d1", "d2", "d3"};
constexpr std::array<std::string_view, 3> kBaseAxes = {"e1", "e2", "e3"};

std::string_view plural(int count) { return count == 1 ? "" : "s"; }

bool measures_roll(const RegistrationModel& model) {
  return std::any_of(model.readings().begin(), model.readings().end(),
                     [](const RegistrationReading& reading) { return reading.rows == 6; });
}

/// Unknowns of the mounting that are really asked for.
int mounting_unknowns(const RegistrationModel& model) {
  if (!model.mounting()) return 0;
  int count = measures_roll(model) ? -1 : 0;
  for (const Sensor& sensor : model.catheter().sensors)
    if (!sensor.T_tracker_base) count += rows_of(sensor.kind);
  return count;
}

std::string name_of(const RegistrationModel& model, int column) {
  const auto axis = static_cast<std::size_t>(column % 3);
  if (column < 3) return fmt::format("the base's position along {}", kBaseAxes[axis]);
  if (column < 6) return fmt::format("the base's rotation about {}", kBaseAxes[axis]);
  if (column == RegistrationModel::kTwistColumn) return "the shaft's twist";
  if (column < RegistrationModel::bend_column(model.positions()))
    return fmt::format("the bend of knob position {}", (column - RegistrationModel::bend_column(0)) / 2 + 1);
  const int offset = column - model.mount_column(0);
  return fmt::format("the mounting of sensor \"{}\", {} {}",
                     model.catheter().sensors[static_cast<std::size_t>(offset / 6)].name,
                     offset % 6 < 3 ? "position along" : "rotation about", kAxes[static_cast<std::size_t>(offset % 3)]);
}

double scale_of(const RegistrationModel& model, int column) {
  constexpr double kUntold_m = 0.03, kUntold_rad = 0.35;
  if (column < 6) return column < 3 ? kUntold_m : kUntold_rad;
  if (column < RegistrationModel::bend_column(model.positions())) return kUntold_rad / model.catheter().rod.length_m();
  return (column - model.mount_column(0)) % 6 < 3 ? kUntold_m : kUntold_rad;
}

void warn_of_what_is_not_told(const RegistrationModel& model, std::vector<std::string>& warnings) {
  if (!measures_roll(model))
    warnings.emplace_back(
        "no sensor of kind \"pose\": the base's roll is not told by these sensors; it rests on the shaft bending about "
        "d1 alone (k2 as stated), to the side of the stated k1");
  if (!model.mounting()) return;
  if (measures_roll(model)) {
    const auto first = std::find_if(model.readings().begin(), model.readings().end(),
                                    [](const RegistrationReading& reading) { return reading.rows == 6; });
    warnings.push_back(
        fmt::format("mounting: a common roll of base and sensors is not told by any pose: sensor \"{}\" keeps its roll "
                    "about d3, and base and other sensors are found against it",
                    model.catheter().sensors[static_cast<std::size_t>(first->sensor)].name));
  }
  warnings.emplace_back(
      "mounting: a common shift, and a common tilt, of base and sensors are told through the bends alone, a shift "
      "along "
      "the axis about which all of them bend not at all: see the sigmas");
}

void warn_of_priors(const RegistrationModel& model, const RegistrationWeights& weights, const Registration& found,
                    std::vector<std::string>& warnings) {
  if (!model.mounting()) return;
  constexpr double kHardly = 0.7;  // of the prior sigma that is left
  for (int i = 0; i < model.sensors(); ++i) {
    const auto& mounting = found.mountings[static_cast<std::size_t>(i)];
    Eigen::Matrix<double, 6, 1> sigma;
    sigma << mounting.sigma_m, mounting.sigma_rad;
    for (int k = 0; k < 6; ++k) {
      const double prior = weights.prior_sigma(model.mount_column(i) + k);
      if (prior <= RegistrationWeights::kFixed || sigma(k) < kHardly * prior * found.sigma_inflation) continue;
      warnings.push_back(fmt::format("{}: hardly told by these poses: it stays near what was stated",
                                     name_of(model, model.mount_column(i) + k)));
    }
  }
}

/// Widest angle between the tips of two knob positions.
void warn_of_like_bends(const RegistrationModel& model, const Registration& found, std::vector<std::string>& warnings) {
  constexpr double kLeastSpread_rad = 0.3;
  double widest_per_m = 0.0;
  for (const auto& one : found.positions)
    for (const auto& other : found.positions)
      widest_per_m = std::max(widest_per_m, (one.precurvature_per_m - other.precurvature_per_m).norm());
  const double spread_rad = widest_per_m * model.catheter().rod.length_m();
  if (spread_rad >= kLeastSpread_rad) return;
  warnings.push_back(fmt::format(
      "{}: the base rests on the angle between the sensors alone; expected knob positions whose bends differ by "
      "{:.0f} deg and more",
      found.positions.size() == 1
          ? std::string("a single knob position")
          : fmt::format("the bends differ by {:.1f} deg at most", spread_rad / kRadiansPerDegree),
      kLeastSpread_rad / kRadiansPerDegree));
}

void warn_of_large_sigmas(const Registration& found, std::vector<std::string>& warnings) {
  constexpr double kLarge_m = 1e-3, kLarge_rad = 1.0 * kRadiansPerDegree;
  const Eigen::Matrix<double, 6, 1> sigma = found.base_covariance.diagonal().cwiseSqrt();
  for (int axis = 0; axis < 3; ++axis) {
    const std::string_view name = kBaseAxes[static_cast<std::size_t>(axis)];
    if (sigma(axis) > kLarge_m)
      warnings.push_back(fmt::format("the base's position along {} is told to {:.2g} mm only", name,
                                     sigma(axis) * kMillimetresPerMetre));
    if (sigma(3 + axis) > kLarge_rad)
      warnings.push_back(fmt::format("the base's rotation about {}{} is told to {:.2g} deg only", name,
                                     axis == 2 ? ", its roll," : "", sigma(3 + axis) / kRadiansPerDegree));
  }
}

/// The catheter file has no key for how far a mounting may be turned, so the force's sigma leaves it out.
void warn_of_turned_mountings(const RegistrationModel& model, const Registration& found,
                              std::vector<std::string>& warnings) {
  constexpr double kLarge_rad = 0.2 * kRadiansPerDegree;
  for (std::size_t i = 0; i < found.mountings.size(); ++i)
    if (const double sigma_rad = found.mountings[i].sigma_rad.maxCoeff(); sigma_rad > kLarge_rad)
      warnings.push_back(fmt::format(
          "sensor \"{}\": how its mounting is turned is told to {:.2g} deg only, and the force's sigma leaves that out",
          model.catheter().sensors[i].name, sigma_rad / kRadiansPerDegree));
}

void warn_of_large_residuals(const RegistrationModel& model, const Registration& found,
                             std::vector<std::string>& warnings) {
  if (found.sigma_inflation == 1.0) return;
  const RegistrationReading* worst = nullptr;
  double largest = 0.0;
  for (const RegistrationReading& reading : model.readings()) {
    const auto& residual =
        found.positions[static_cast<std::size_t>(reading.position)].residuals[static_cast<std::size_t>(reading.sensor)];
    if (residual.chi_square / reading.rows < largest) continue;
    largest = residual.chi_square / reading.rows;
    worst = &reading;
  }
  const auto& position = found.positions[static_cast<std::size_t>(worst->position)];
  const auto& residual = position.residuals[static_cast<std::size_t>(worst->sensor)];
  warnings.push_back(fmt::format(
      "the poses are off by {:.1f} times what the stated noise allows, most at {}, sensor \"{}\" ({:.2f} mm, {:.2f} "
      "deg): did the shaft touch something, or move? All sigmas are raised by that",
      found.sigma_inflation, position.name, model.catheter().sensors[static_cast<std::size_t>(worst->sensor)].name,
      residual.position_m.norm() * kMillimetresPerMetre, residual.rotation_rad.norm() / kRadiansPerDegree));
}

/// Another minimum that explains the poses as well.
void warn_of_rivals(std::span<const RegistrationFit> fits, const Registration& found,
                    std::vector<std::string>& warnings) {
  constexpr double kAsGood = 12.0, kElsewhere_m = 2e-3, kElsewhere_rad = 0.035;
  for (const RegistrationFit& fit : fits) {
    if (!fit.converged || !(fit.chi_square < found.chi_square + kAsGood)) continue;
    const Pose T = found.T_reference_base.inverse() * fit.state.T_reference_base;
    const double turned_rad = log_so3(T.R).norm();
    if (T.p.norm() < kElsewhere_m && turned_rad < kElsewhere_rad) continue;
    warnings.push_back(fmt::format(
        "another base explains the poses as well, {:.1f} mm and {:.1f} deg away: expected more knob positions",
        T.p.norm() * kMillimetresPerMetre, turned_rad / kRadiansPerDegree));
    return;
  }
}

}  // namespace

void require_in_range(std::string_view field, double value, double most) {
  if (value > 0.0 && value <= most) return;
  throw InputError(fmt::format("registration: {} = {}: expected more than 0, at most {}", field, value, most));
}

void require_enough_readings(const RegistrationModel& model, std::span<const KnobPosition> positions) {
  constexpr double kFarthest_m = 100.0;
  if (positions.empty()) throw InputError("registration: expected at least one knob position");
  for (int j = 0; j < model.positions(); ++j) {
    const auto of_position = [&](const RegistrationReading& reading) { return reading.position == j; };
    if (std::any_of(model.readings().begin(), model.readings().end(), of_position)) continue;
    throw InputError(
        fmt::format("{}: no usable reading of any sensor: expected the unloaded shaft in view, on sensors without a "
                    "base of their own",
                    positions[static_cast<std::size_t>(j)].name));
  }
  for (const RegistrationReading& reading : model.readings())
    if (!(reading.mean->T_base_sensor.p.norm() < kFarthest_m))
      throw InputError(fmt::format("{}: sensor \"{}\" is {:.3g} m from the tracker: expected a place in its volume",
                                   positions[static_cast<std::size_t>(reading.position)].name,
                                   model.catheter().sensors[static_cast<std::size_t>(reading.sensor)].name,
                                   reading.mean->T_base_sensor.p.norm()));
  const int mounting = mounting_unknowns(model), bends = 2 * model.positions();
  const int base = measures_roll(model) ? 6 : 5;
  if (model.rows() >= base + bends + mounting) return;
  throw InputError(fmt::format(
      "{} knob position{} give{} {} numbers for {} unknowns ({} of the base, {} of bends{}): expected more knob "
      "positions",
      model.positions(), plural(model.positions()), model.positions() == 1 ? "s" : "", model.rows(),
      base + bends + mounting, base, bends, mounting > 0 ? fmt::format(", {} of mountings", mounting) : std::string()));
}

void require_all_told(const RegistrationModel& model, const RegistrationWeights& weights,
                      const Eigen::MatrixXd& information) {
  Eigen::VectorXd scale(model.unknowns());
  for (int k = 0; k < model.unknowns(); ++k) {
    const bool fixed = weights.prior_sigma(k) == RegistrationWeights::kFixed;
    scale(k) = fixed ? 10.0 * RegistrationWeights::kFixed : scale_of(model, k);
  }
  const Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(scaled);
  if (axes.eigenvalues()(0) >= 1.0) return;
  Eigen::Index largest = 0;
  axes.eigenvectors().col(0).cwiseAbs().maxCoeff(&largest);
  throw InputError(
      fmt::format("registration: {} is not told by these poses: expected more knob positions with other "
                  "bends, or sensors of kind \"pose\"",
                  name_of(model, static_cast<int>(largest))));
}

void require_near(const RegistrationModel& model, const Registration& found) {
  constexpr double kFarOff = 0.1;  // of the length
  const double length_m = model.catheter().rod.length_m();
  if (found.position_rms_m < kFarOff * length_m) return;
  throw InputError(fmt::format(
      "registration: no unloaded shaft of {:.4g} mm comes nearer to the poses than {:.4g} mm (rms): expected poses of "
      "this catheter in millimetres, its sensors at the stated arc lengths",
      length_m * kMillimetresPerMetre, found.position_rms_m * kMillimetresPerMetre));
}

std::vector<std::string> registration_warnings(const RegistrationModel& model, const RegistrationWeights& weights,
                                               std::span<const RegistrationFit> fits, const Registration& found) {
  std::vector<std::string> warnings;
  for (const Sensor& sensor : model.catheter().sensors)
    if (sensor.T_tracker_base)
      warnings.push_back(fmt::format("sensor \"{}\" has a base of its own and is left out", sensor.name));
  if (!found.converged) warnings.emplace_back("the fit did not converge: the result may be off");
  warn_of_large_residuals(model, found, warnings);
  warn_of_rivals(fits, found, warnings);
  warn_of_like_bends(model, found, warnings);
  warn_of_large_sigmas(found, warnings);
  warn_of_turned_mountings(model, found, warnings);
  warn_of_what_is_not_told(model, warnings);
  warn_of_priors(model, weights, found, warnings);
  return warnings;
}

}  // namespace palpate
