// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <palpate/sensing/force_seeds.hpp>
#include <palpate/sensing/sensor_model.hpp>

namespace palpate {

namespace {

// Loosened sigmas: the curve is coarse, and the valleys of the cost should be wide.
constexpr double kLooseLength = 1.0 / 70.0;  // of the shaft's length
constexpr double kLooseAngle_rad = 0.02;

constexpr double kFirstWeight = 1.0, kLastWeight = 30.0, kWeightGrowth = 3.0;  // of the defect [1/rad]
constexpr double kPlausibleForces = 5.0;  // buckling loads: sigma of the force, so that no curve asks for absurd ones
constexpr double kStartForces = 3.3;      // buckling loads

std::vector<double> arc_lengths(const Catheter& catheter) {
  std::vector<double> s;
  for (const Sensor& sensor : catheter.sensors) s.push_back(sensor.arc_length_m);
  return s;
}

/// Points of a spiral, spread evenly over the sphere.
Vector3d direction(int i, int count) {
  const double z = 1.0 - 2.0 * (i + 0.5) / count, turn = i * std::numbers::pi * (3.0 - std::sqrt(5.0));
  const double r = std::sqrt(1.0 - z * z);
  return {r * std::cos(turn), r * std::sin(turn), z};
}

}  // namespace

/// The cost at one point, with its Gauss-Newton model.
struct ForceSeeds::Fit {
  double cost = 0.0;
  Eigen::Matrix<double, RelaxedRod::kUnknowns, RelaxedRod::kUnknowns> information;
  Unknowns gradient;  ///< downhill
};

ForceSeeds::ForceSeeds(const Catheter& catheter)
    : sensors_(catheter.sensors), rod_(catheter.rod, arc_lengths(catheter)), shape_(rod_.make_shape()) {}

void ForceSeeds::begin(const Measurement& measurement, unsigned sensors, const TipLoad& load) {
  measurement_ = &measurement;
  selected_ = sensors;
  load_ = load;
  ranked_ = false;
  rows_ = 0;
  for (int k = 0; k < measurement.count; ++k)
    if (sensors >> measurement.poses[k].sensor & 1U) rows_ += rows_of(sensors_[measurement.poses[k].sensor].kind);
}

/// Residuals of the selected sensors with their Jacobian.
void ForceSeeds::compare_poses() {
  poses_.residual.resize(rows_);
  poses_.jacobian.resize(rows_, RelaxedRod::kUnknowns);
  int row = 0;
  for (int k = 0; k < measurement_->count; ++k) {
    const Measurement::SensorPose& pose = measurement_->poses[k];
    if (!(selected_ >> pose.sensor & 1U)) continue;
    const Sensor& sensor = sensors_[pose.sensor];
    append_sensor_rows(sensor.kind,
                       predict_sensor(sensor, shape_.curve.points[pose.sensor], shape_.curve.tangents[pose.sensor]),
                       pose.T_base_sensor, row, poses_);
    const double sigma_m = std::hypot(sensor.noise_m.maxCoeff(), kLooseLength * rod_.length_m());
    const double sigma_rad = std::hypot(sensor.noise_rad, kLooseAngle_rad);
    const int end = row + rows_of(sensor.kind);
    for (int i = row; i < end; ++i) {
      const double sigma = i < row + 3 ? sigma_m : sigma_rad;
      poses_.residual(i) /= sigma;
      poses_.jacobian.row(i) /= sigma;
    }
    row = end;
  }
}

void ForceSeeds::integrate(const Unknowns& z) {
  ++evaluations_;
  rod_.evaluate(load_, z, shape_);
  compare_poses();
}

/// Cost and Gauss-Newton model at `z`, which has just been integrated.
ForceSeeds::Fit ForceSeeds::weigh(const Unknowns& z, double weight) const {
  const double per_N = 1.0 / (kPlausibleForces * rod_.buckling_force_N());
  const double w2 = weight * weight, f2 = per_N * per_N;
  const auto J = poses_.jacobian.leftCols<RelaxedRod::kUnknowns>();
  const auto& D = shape_.defect_by_unknown;
  Fit fit;
  fit.cost = poses_.residual.squaredNorm() + w2 * shape_.defect.squaredNorm() + f2 * z.tail<3>().squaredNorm();
  fit.information = J.transpose().lazyProduct(J);
  fit.information += w2 * D.transpose().lazyProduct(D);
  fit.information.diagonal().tail<3>().array() += f2;
  fit.gradient = J.transpose().lazyProduct(poses_.residual);
  fit.gradient -= w2 * D.transpose().lazyProduct(shape_.defect);
  fit.gradient.tail<3>() -= f2 * z.tail<3>();
  return fit;
}

/// Levenberg-Marquardt; the equilibrium weighs more as soon as a step no longer gains much.
ForceSeeds::Unknowns ForceSeeds::fit(const Unknowns& start) {
  constexpr double kLittleGain = 0.3, kNoGain = 0.02, kLeastDamping = 1e-2, kMostDamping = 1e8;
  Unknowns z = start;
  double weight = kFirstWeight, damping = kLeastDamping;
  integrate(z);
  Fit here = weigh(z, weight);
  for (int used = 1; used < kMostEvaluations && damping < kMostDamping; ++used) {
    auto damped = here.information;
    damped.diagonal() *= 1.0 + damping;
    const Unknowns trial = z + damped.ldlt().solve(here.gradient);
    integrate(trial);
    const Fit there = weigh(trial, weight);
    if (!(there.cost < here.cost)) {
      damping = std::max(8.0 * damping, kLeastDamping);
      continue;
    }
    const double gain = 1.0 - there.cost / here.cost;
    z = trial;
    here = there;
    damping *= 0.2;
    if (weight >= kLastWeight && gain < kNoGain) break;
    if (weight < kLastWeight && gain < kLittleGain) {
      weight = std::min(kWeightGrowth * weight, kLastWeight);
      here = weigh(z, weight);
    }
  }
  return z;
}

void ForceSeeds::rank_directions() {
  TipLoad load = load_;
  for (int i = 0; i < kDirections; ++i) {
    load.force_tip_N = kStartForces * rod_.buckling_force_N() * direction(i, kDirections);
    ++evaluations_;
    starts_[i].z = rod_.start(load, shape_);
    compare_poses();
    starts_[i].cost = poses_.residual.squaredNorm();
  }
  std::sort(starts_.begin(), starts_.end(), [](const Start& a, const Start& b) { return a.cost < b.cost; });
  ranked_ = true;
}

bool ForceSeeds::seed(int k, Vector3d& force_tip_N) {
  if (k > kDirections) return false;
  if (k > 0 && !ranked_) rank_directions();
  force_tip_N = fit(k == 0 ? Unknowns(Unknowns::Zero()) : starts_[k - 1].z).tail<3>();
  return true;
}

}  // namespace palpate
