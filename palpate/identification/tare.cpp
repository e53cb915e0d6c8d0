// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <palpate/estimation/kalman.hpp>
#include <palpate/identification/mean_poses.hpp>
#include <palpate/identification/tare.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/rod/base_loads.hpp>
#include <palpate/sensing/sensor_model.hpp>

namespace palpate {

namespace {

/// What tendon and handle do meanwhile; the tare must not take it for precurvature.
TipLoad mean_tendon_load(const Catheter& catheter, std::span<const TrackerFrame> frames, const TareInterval& interval) {
  Vector3d sum = Vector3d::Zero(), bend = Vector3d::Zero();
  int count = 0, bends = 0;
  for (const TrackerFrame& frame : frames) {
    if (!(frame.time_s >= interval.from_s && frame.time_s <= interval.to_s)) continue;
    if (frame.bend.present) {
      bend.head<2>() += frame.bend.change_per_m;
      ++bends;
      continue;  // the tendon's moment would bend twice
    }
    if (!frame.tendon.present) continue;
    sum.head<2>() += frame.tendon.moment_Nm;
    ++count;
  }
  TipLoad load;
  if (interval.straight) return load;
  if (bends > 0) load.precurvature_per_m = bend / bends;
  if (count == 0) return load;
  const bool couple = catheter.tendon.model == TendonModel::kCouple;
  (couple ? load.tendon_couple_Nm : load.moment_tip_Nm) = sum / count;
  return load;
}

/// The unloaded shaft seen from a base that may stand elsewhere. State: x = (change of u0 [1/m], rho [m], theta [rad]);
/// the clamp moves to T_base_nominal = (exp(theta), rho).
class UnloadedModel {
 public:
  UnloadedModel(const Catheter& catheter, const std::vector<MeanPose>& mean, const TipLoad& load, bool straight)
      : catheter_(catheter), mean_(mean), load_(load), straight_(straight) {
    for (const Sensor& sensor : catheter.sensors) arc_lengths_.push_back(sensor.arc_length_m);
    for (std::size_t i = 0; i < mean.size(); ++i)
      if (mean[i].count > 0) rows_ += rows_of(catheter.sensors[i].kind);
  }

  int rows() const { return rows_; }

  void noise(ResidualMatrix& R) const {
    R.setZero(rows_, rows_);
    int row = 0;
    for (std::size_t i = 0; i < mean_.size(); ++i) {
      const MeanPose& entry = mean_[i];
      if (entry.count == 0) continue;
      const Sensor& s = catheter_.sensors[i];
      const int rows = rows_of(s.kind);
      const auto variance = [&](double white, double bias) { return white * white / entry.count + bias * bias / 3.0; };
      for (int axis = 0; axis < 3; ++axis) R(row + axis, row + axis) = variance(s.noise_m(axis), s.bias_m);
      R.diagonal().segment(row + 3, rows - 3).setConstant(variance(s.noise_rad, s.bias_rad));
      row += rows;
    }
  }

  bool linearize(const StateVector& x, Linearization& at) {
    const Pose T_nominal_base{exp_so3(x.tail<3>()), x.segment<3>(3)};
    if (!solve_shape(x.head<3>(), T_nominal_base.R)) return false;
    at.residual.resize(rows_);
    at.jacobian.resize(rows_, 9);
    position_rms_m = 0.0;
    int row = 0, used = 0;
    for (std::size_t i = 0; i < mean_.size(); ++i) {
      if (mean_[i].count == 0) continue;
      const Sensor& sensor = catheter_.sensors[i];
      append_sensor_rows(sensor.kind, predict(sensor, i, T_nominal_base), mean_[i].T_base_sensor, row, at);
      position_rms_m += at.residual.segment<3>(row).squaredNorm();
      row += rows_of(sensor.kind);
      ++used;
    }
    position_rms_m = std::sqrt(position_rms_m / used);
    return at.residual.allFinite();
  }

  double position_rms_m = 0.0;  ///< of the last linearization

 private:
  /// The weight keeps its direction while the clamp turns, R -> R exp(delta): w = R^T w_nominal, dw = w x delta.
  bool solve_shape(const Vector3d& precurvature_change, const Matrix3d& R_nominal_base) {
    Rod rod = catheter_.rod;
    for (Section& section : rod.sections) {
      if (straight_) section.precurvature_per_m.setZero();
      if (!section.rigid) section.precurvature_per_m += precurvature_change;
    }
    if (straight_) rod.distributed_load_base_N_per_m.setZero();
    rod.distributed_load_base_N_per_m = R_nominal_base.transpose() * rod.distributed_load_base_N_per_m;
    const RodSolver solver(rod, arc_lengths_, Accuracy::kReference);
    shape_ = solver.make_solution<6>();
    WeightWorkspace<6> workspace = make_weight_workspace<6>(solver);
    LoadDirections<6> directions;
    directions.precurvature_per_m.leftCols<3>().setIdentity();
    directions.distributed_tip_N_per_m.rightCols<3>() = hat(rod.distributed_load_base_N_per_m);
    return solve_under_weight(solver, load_, directions, workspace, shape_).converged;
  }

  /// Sensor pose in the nominal base frame: T_nominal_base T_base_sensor, with columns (u0, rho, theta). To a sensor
  /// with a registration of its own the nominal base frame is the true one; only the weight turns against it.
  PredictedSensor<9> predict(const Sensor& sensor, std::size_t i, const Pose& T_nominal_base) const {
    const PredictedSensor<6> own = predict_sensor(sensor, shape_.points[i], shape_.tangents[i]);
    const auto by_precurvature = [](const auto& m) { return m.template leftCols<3>(); };
    const auto by_turn = [](const auto& m) { return m.template rightCols<3>(); };
    const Matrix3d turn = right_jacobian_of(T_nominal_base.R), R = own.T_base_sensor.R;
    PredictedSensor<9> seen;
    if (sensor.T_tracker_base) {
      seen.T_base_sensor = own.T_base_sensor;
      seen.rotation << by_precurvature(own.rotation), Matrix3d::Zero(), by_turn(own.rotation) * turn;
      seen.position_m << by_precurvature(own.position_m), Matrix3d::Zero(), by_turn(own.position_m) * turn;
      return seen;
    }
    seen.T_base_sensor = T_nominal_base * own.T_base_sensor;
    seen.rotation << by_precurvature(own.rotation), Matrix3d::Zero(), (R.transpose() + by_turn(own.rotation)) * turn;
    seen.position_m << T_nominal_base.R * by_precurvature(own.position_m), Matrix3d::Identity(),
        T_nominal_base.R * (by_turn(own.position_m) - hat(own.T_base_sensor.p)) * turn;
    return seen;
  }

  static Matrix3d right_jacobian_of(const Matrix3d& R) { return inverse_right_jacobian(log_so3(R)).inverse(); }

  const Catheter& catheter_;
  const std::vector<MeanPose>& mean_;
  TipLoad load_;
  bool straight_;
  std::vector<double> arc_lengths_;
  int rows_ = 0;
  RodSolution<6> shape_;
};

constexpr double kFixed = 1e-12;  // sigma of what stays: small enough not to move, definite all the same

Gaussian stated_prior(const Catheter& catheter, bool straight) {
  StateVector sigma = StateVector::Constant(9, kFixed);
  if (!straight) sigma.head<3>() = sigma.head<3>().cwiseMax(catheter.precurvature_sigma_per_m);
  if (!catheter.base.tracked) {
    sigma.segment<3>(3).array() += catheter.base.position_sigma_m;
    sigma.tail<3>().array() += catheter.base.rotation_sigma_rad;
  }
  return {StateVector::Zero(9), sigma.cwiseAbs2().asDiagonal()};
}

/// What had sigma 0 in the prior stays to the last bit.
void hold_fixed(const Gaussian& prior, Gaussian& found) {
  for (Eigen::Index i = 0; i < found.mean.size(); ++i) {
    if (prior.covariance(i, i) > 2.0 * kFixed * kFixed) continue;
    found.mean(i) = 0.0;
    found.covariance.row(i).setZero();
    found.covariance.col(i).setZero();
  }
}

void correct(Tare& tare, const Gaussian& found, bool straight) {
  tare.precurvature_change_per_m = found.mean.head<3>();
  tare.base_shift_m = found.mean.segment<3>(3);
  tare.base_rotation_rad = found.mean.tail<3>();
  Catheter& catheter = tare.catheter;
  for (Section& section : catheter.rod.sections)
    if (!section.rigid) section.precurvature_per_m += tare.precurvature_change_per_m;
  const Pose T_nominal_base{exp_so3(tare.base_rotation_rad), tare.base_shift_m};
  catheter.rod.distributed_load_base_N_per_m =
      T_nominal_base.R.transpose() * catheter.rod.distributed_load_base_N_per_m;
  const StateVector variance = found.covariance.diagonal();
  if (!straight) catheter.precurvature_sigma_per_m = variance.head<3>().cwiseSqrt();
  if (catheter.base.tracked) return;
  catheter.base.T_tracker_base = catheter.base.T_tracker_base * T_nominal_base;
  catheter.base.position_sigma_m = std::sqrt(variance.segment<3>(3).mean());
  catheter.base.rotation_sigma_rad = std::sqrt(variance.tail<3>().mean());
  Eigen::Matrix<double, 6, 6> turn = Eigen::Matrix<double, 6, 6>::Zero();  // into the axes of the new base frame
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = T_nominal_base.R.transpose();
  catheter.base.covariance = turn * found.covariance.bottomRightCorner(6, 6) * turn.transpose();
}

}  // namespace

Tare tare(const Catheter& catheter, std::span<const TrackerFrame> frames, const TareInterval& interval) {
  const std::vector<MeanPose> mean = mean_poses(catheter, frames, interval.from_s, interval.to_s);
  Tare out{.catheter = catheter};
  for (const MeanPose& pose : mean) {
    out.frames = std::max(out.frames, pose.count);
    out.outliers += pose.outliers;
  }
  if (out.frames == 0)
    throw InputError(fmt::format("reference {}:{} s: no usable frame in the interval", interval.from_s, interval.to_s));

  UnloadedModel model(catheter, mean, mean_tendon_load(catheter, frames, interval), interval.straight);
  const Gaussian prior = stated_prior(catheter, interval.straight);
  Linearization at;
  model.linearize(prior.mean, at);
  out.residual_before_m = model.position_rms_m;
  Update update;
  iterated_update(model, prior, prior.mean, {.max_iterations = 50, .step_tolerance = 1e-4}, update);
  if (update.status != UpdateStatus::kConverged)
    throw InputError(
        fmt::format("reference {}:{} s: no base and precurvature near the stated ones explain the poses; "
                    "is the shaft really unloaded there?",
                    interval.from_s, interval.to_s));
  hold_fixed(prior, update.posterior);
  correct(out, update.posterior, interval.straight);
  out.largest_change_sigmas =
      update.posterior.mean.cwiseQuotient(prior.covariance.diagonal().cwiseSqrt()).cwiseAbs().maxCoeff();
  model.linearize(update.posterior.mean, at);
  out.residual_after_m = model.position_rms_m;
  return out;
}

}  // namespace palpate
