// SPDX-License-Identifier: Apache-2.0
#include "identify_stiffness_recordings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <palpate/identification/mean_poses.hpp>
#include <palpate/identification/tare.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/math/units.hpp>

#include "estimate_input.hpp"

namespace palpate::app {

namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// What a tare leaves open of the clamp (position, rotation; base axes), P. Of that the file's clamp pose, of
/// covariance C, brings in P C^-1 P; it is alike in all recordings. The rest is the noise of this one reference.
struct ClampCovariance {
  Matrix6d common = Matrix6d::Zero(), own = Matrix6d::Zero();
};

ClampCovariance clamp_covariance(const BaseRegistration& before, const Catheter& after) {
  if (!after.base.covariance) return {};
  const Matrix6d& P = *after.base.covariance;
  const auto weight = [](double sigma) { return Vector3d::Constant(sigma > 0.0 ? 1.0 / (sigma * sigma) : 0.0); };
  Eigen::Matrix<double, 6, 1> weights;
  weights << weight(before.position_sigma_m), weight(before.rotation_sigma_rad);
  const Matrix6d common = P * weights.asDiagonal() * P;
  return {common, P - common};
}

/// A clamp off by (rho, theta) moves what is seen at p by -(rho + theta x p) in the base frame. All points of a case
/// are moved at once: each gets the variance of as many as there are, so that their mean is not surer than the clamp.
void widen(const Matrix6d& own, std::vector<ShapePoint>& points) {
  const auto count = static_cast<double>(points.size());
  for (ShapePoint& point : points) {
    Eigen::Matrix<double, 3, 6> J;
    J << -Matrix3d::Identity(), hat(point.position_base_m);
    const Vector3d variance = (J * own * J.transpose()).diagonal().cwiseMax(0.0);
    point.sigma_m = (point.sigma_m.cwiseAbs2() + count * variance).cwiseSqrt();
    const double turn = std::max(0.0, own.diagonal().tail<3>().mean());
    if (point.R_base_sensor) point.sigma_rad = std::sqrt(point.sigma_rad * point.sigma_rad + count * turn);
  }
}

/// A sensor's mean pose: precision of the mean, stated bias and mounting error, and how well the reference holds.
ShapePoint shape_point(const Sensor& sensor, const MeanPose& mean, double reference_sigma_m) {
  const double count = mean.count;
  ShapePoint point;
  point.arc_length_m = sensor.arc_length_m;
  point.T_local_sensor = sensor.T_local_sensor;
  point.position_base_m = mean.T_base_sensor.p;
  Vector3d variance = sensor.noise_m.cwiseAbs2() / count;
  variance.array() += sensor.bias_m * sensor.bias_m / 3.0 + sensor.mount_sigma_m * sensor.mount_sigma_m +
                      reference_sigma_m * reference_sigma_m;
  point.sigma_m = variance.cwiseSqrt();
  if (sensor.kind != SensorKind::kPose) return point;  // five angles of six are no rotation: its place alone
  point.R_base_sensor = mean.T_base_sensor.R;
  point.sigma_rad = std::sqrt(sensor.noise_rad * sensor.noise_rad / count + sensor.bias_rad * sensor.bias_rad / 3.0);
  return point;
}

struct Recorded {
  std::size_t index = 0;  ///< of the case
  TrackerRecording recording;
  std::optional<Tare> tare;
  ClampCovariance clamp;
};

class RecordingLoader {
 public:
  RecordingLoader(const CatheterFile& file, const LoadCaseFile& cases, StiffnessInput& input)
      : file_(file), cases_(cases), input_(input) {}

  void load() {
    for (std::size_t i = 0; i < cases_.cases.size(); ++i)
      if (cases_.cases[i].recorded()) read(i);
    refuse_cases_without_tare();
    if (cases_.clamp_fixed) turn_alike();
    for (const Recorded& one : recorded_) make_case(one);
    take_over_tares();
  }

 private:
  void read(std::size_t index) {
    const LoadCaseEntry& entry = cases_.cases[index];
    CatheterFile setup = file_;
    setup.reference = entry.reference;
    setup.known_loads.clear();  // those of another recording
    EstimateOptions options;
    options.recordings = {entry.recording.string()};
    Recorded& one = recorded_.emplace_back();
    one.index = index;
    one.recording = load_recording(options, setup, input_.warnings);
    if (!entry.reference.given) return;
    one.tare = tare_of(file_.catheter, one);
    one.clamp = clamp_covariance(file_.catheter.base, one.tare->catheter);
    if (one.tare->largest_change_sigmas > 4.0)
      warn(entry, fmt::format("reference_s: a correction is {:.1f} times the sigma stated for it: is the tip free of "
                              "force in this interval?",
                              one.tare->largest_change_sigmas));
  }

  Tare tare_of(const Catheter& catheter, const Recorded& one) const {
    const ReferenceInterval& reference = cases_.cases[one.index].reference;
    return tare(catheter, one.recording.frames, {reference.from_s, reference.to_s, reference.straight});
  }

  int tared() const {
    return static_cast<int>(
        std::count_if(recorded_.begin(), recorded_.end(), [](const Recorded& one) { return one.tare.has_value(); }));
  }

  /// Where the file's clamp is unsure, a case as the file has it and one as its tare has it have no clamp in common.
  void refuse_cases_without_tare() const {
    const BaseRegistration& base = file_.catheter.base;
    if (tared() == 0 || (base.position_sigma_m == 0.0 && base.rotation_sigma_rad == 0.0)) return;
    for (const LoadCaseEntry& entry : cases_.cases)
      if (!entry.reference.given)
        throw InputError(fmt::format(
            "{}: case \"{}\": expected a recording with reference_s, for other cases have one and [base] of the "
            "catheter file is unsure",
            cases_.source, entry.name));
  }

  /// A clamp that stands fast is turned alike in all recordings, by the mean of what the tares say; what a reference
  /// holds beyond that is a shift.
  void turn_alike() {
    if (tared() == 0) return;
    Vector3d turn_rad = Vector3d::Zero(), shift_m = Vector3d::Zero();
    for (const Recorded& one : recorded_) {
      if (!one.tare) continue;
      turn_rad += one.tare->base_rotation_rad / tared();
      shift_m += one.tare->base_shift_m / tared();
    }
    Catheter turned = file_.catheter;
    turned.base.T_tracker_base = turned.base.T_tracker_base * Pose{exp_so3(turn_rad), shift_m};
    turned.base.rotation_sigma_rad = 0.0;
    turned.rod.distributed_load_base_N_per_m = exp_so3(turn_rad).transpose() * turned.rod.distributed_load_base_N_per_m;
    for (Recorded& one : recorded_)
      if (one.tare) one.tare = tare_of(turned, one);
  }

  void make_case(const Recorded& one) {
    const LoadCaseEntry& entry = cases_.cases[one.index];
    const Catheter& catheter = one.tare ? one.tare->catheter : file_.catheter;
    const Matrix3d R_base_file = catheter.base.T_tracker_base.R.transpose() * file_.catheter.base.T_tracker_base.R;
    LoadCase made{entry.name, R_base_file * entry.force_base_N, {}};
    const auto means = mean_poses(catheter, one.recording.frames, entry.from_s, entry.to_s);
    for (std::size_t i = 0; i < means.size(); ++i)
      if (means[i].count > 0)
        made.points.push_back(shape_point(catheter.sensors[i], means[i], entry.reference_sigma_m));
    if (made.points.empty())
      throw InputError(fmt::format(
          "{}: case \"{}\": interval_s {}:{} s of {}: expected usable frames; the recording goes from {} s to {} s",
          cases_.source, entry.name, entry.from_s, entry.to_s, one.recording.source,
          one.recording.frames.front().time_s, one.recording.frames.back().time_s));
    widen(one.clamp.own, made.points);
    warn_of_motion(entry, catheter, one.recording);
    input_.cases[one.index] = std::move(made);
  }

  /// A shaft that still swings has a mean, but not one of rest.
  void warn_of_motion(const LoadCaseEntry& entry, const Catheter& catheter, const TrackerRecording& recording) {
    const double middle_s = 0.5 * (entry.from_s + entry.to_s);
    const auto first = mean_poses(catheter, recording.frames, entry.from_s, middle_s);
    const auto second = mean_poses(catheter, recording.frames, middle_s, entry.to_s);
    for (std::size_t i = 0; i < first.size(); ++i) {
      if (first[i].count == 0 || second[i].count == 0) continue;
      const double moved_m = (second[i].T_base_sensor.p - first[i].T_base_sensor.p).norm();
      if (moved_m <= catheter.sensors[i].noise_m.maxCoeff()) continue;
      warn(entry,
           fmt::format("between the halves of interval_s sensor \"{}\" moves by {:.3f} mm: is the shaft at rest?",
                       catheter.sensors[i].name, moved_m * kMillimetresPerMetre));
    }
  }

  /// What the tares leave open alike is the clamp's prior in the fit. The weight's direction and the precurvature are
  /// means over the tares.
  void take_over_tares() {
    if (tared() == 0) return;
    Catheter& catheter = input_.catheter;
    Matrix6d clamp = Matrix6d::Zero();
    Vector3d weight_N_per_m = Vector3d::Zero(), change_per_m = Vector3d::Zero(), variance = Vector3d::Zero();
    for (const Recorded& one : recorded_) {
      if (!one.tare) continue;
      weight_N_per_m += one.tare->catheter.rod.distributed_load_base_N_per_m / tared();
      clamp += one.clamp.common / tared();
      change_per_m += one.tare->precurvature_change_per_m / tared();
      variance += one.tare->catheter.precurvature_sigma_per_m.cwiseAbs2() / tared();
    }
    warn_of_turned_weight(weight_N_per_m);
    catheter.rod.distributed_load_base_N_per_m = weight_N_per_m;
    for (Section& section : catheter.rod.sections)
      if (!section.rigid) section.precurvature_per_m += change_per_m;
    catheter.precurvature_sigma_per_m = variance.cwiseSqrt();
    catheter.base.covariance = clamp;
    catheter.base.position_sigma_m = std::sqrt(clamp.diagonal().head<3>().mean());
    catheter.base.rotation_sigma_rad = std::sqrt(clamp.diagonal().tail<3>().mean());
  }

  void warn_of_turned_weight(const Vector3d& mean_N_per_m) {
    if (mean_N_per_m.isZero(0.0)) return;
    double largest = 0.0;
    for (const Recorded& one : recorded_)
      if (one.tare)
        largest = std::max(
            largest,
            one.tare->catheter.rod.distributed_load_base_N_per_m.normalized().cross(mean_N_per_m.normalized()).norm());
    if (largest < 3.0 * kRadiansPerDegree) return;
    input_.warnings.push_back(
        fmt::format("{}: the tares turn the clamp by {:.1f} deg from their mean: the weight is taken along its mean "
                    "direction",
                    cases_.source, largest / kRadiansPerDegree));
  }

  void warn(const LoadCaseEntry& entry, const std::string& what) {
    input_.warnings.push_back(fmt::format("{}: case \"{}\": {}", cases_.source, entry.name, what));
  }

  const CatheterFile& file_;
  const LoadCaseFile& cases_;
  StiffnessInput& input_;
  std::vector<Recorded> recorded_;
};

}  // namespace

void load_recorded_cases(const CatheterFile& file, const LoadCaseFile& cases, StiffnessInput& input) {
  RecordingLoader(file, cases, input).load();
}

}  // namespace palpate::app
