// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <palpate/sensing/uncertain_parameters.hpp>

namespace palpate {

namespace {

constexpr double kRateMemory_s = 60.0;  // a shaft that warms up or tires goes on doing so for about a minute
constexpr double kConstant = std::numeric_limits<double>::infinity();

/// Builds the list with the sigmas beside it; correlations come last.
class Builder {
 public:
  Builder(const Catheter& catheter, const ParameterChoice& choice) : catheter_(catheter), choice_(choice) {}

  UncertainParameters build() {
    out_.torsion_tied = !choice_.free_torsion;
    add_stiffness();
    add_precurvature();
    add_tendon();
    out_.rod_count = out_.size();
    if (choice_.consider) add_pose_errors();
    if (choice_.estimate_stiffness)
      add({ParameterKind::kStiffnessRate, 0, -1, kRateMemory_s, true}, choice_.stiffness_rate_per_s);
    const auto n = static_cast<Eigen::Index>(sigma_.size());
    const Eigen::Map<const Eigen::VectorXd> sigma(sigma_.data(), n);
    out_.covariance = sigma.cwiseAbs2().asDiagonal();
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < i; ++j)
        out_.covariance(i, j) = out_.covariance(j, i) = sigma(i) * sigma(j) * correlation(out_.all[i], out_.all[j]);
    return std::move(out_);
  }

 private:
  void add(const UncertainParameter& parameter, double sigma) {
    if (!(sigma > 0.0)) return;
    out_.all.push_back(parameter);
    sigma_.push_back(sigma);
  }

  void add_stiffness() {
    double sigma = choice_.consider || choice_.estimate_stiffness ? catheter_.stiffness_sigma_fraction : 0.0;
    if (choice_.estimate_stiffness && sigma == 0.0) sigma = UncertainParameters::kStiffnessPrior;
    const bool estimated = choice_.estimate_stiffness;
    const double drive = estimated ? choice_.stiffness_drift_per_sqrt_s : 0.0;
    for (int axis = 0; axis < (choice_.free_torsion ? 3 : 2); ++axis)
      add({ParameterKind::kLogStiffness, axis, -1, kConstant, estimated, drive}, sigma);
  }

  void add_precurvature() {
    const bool stated = catheter_.precurvature_sigma_per_m.head<2>().maxCoeff() > 0.0;  // then a zero is meant
    for (int axis = 0; axis < 3; ++axis) {
      const bool estimated = choice_.estimate_precurvature && axis < 2;
      double sigma = choice_.consider || estimated ? catheter_.precurvature_sigma_per_m(axis) : 0.0;
      if (estimated && !stated) sigma = UncertainParameters::kPrecurvaturePrior_per_m;
      const double drive = estimated ? choice_.precurvature_drift_per_m_sqrt_s : 0.0;
      add({ParameterKind::kPrecurvature, axis, -1, kConstant, estimated, drive}, sigma);
    }
  }

  void add_tendon() {
    if (!catheter_.tendon.present) return;
    if (choice_.consider)
      add({ParameterKind::kTendonScale, 0, -1, kConstant, false}, catheter_.tendon.moment_sigma_fraction);
    for (int axis = 0; axis < 2; ++axis)
      add({ParameterKind::kTendonMoment, axis, -1, 0.0, false}, kLeastTendonNoise_Nm);
  }

  void add_pose_errors() {
    bool base_matters = false;
    for (const Sensor& sensor : catheter_.sensors) base_matters = base_matters || !sensor.T_tracker_base;
    const BaseRegistration& base = catheter_.base;
    const double share = std::sqrt(1.0 / 3.0);
    const double tracked_m = base.tracked ? share * base.sensor.bias_m : 0.0;
    const double tracked_rad = base.tracked ? share * base.sensor.bias_rad : 0.0;
    for (int axis = 0; base_matters && axis < 3; ++axis)
      add({ParameterKind::kBasePosition, axis, -1, kConstant}, std::hypot(base_sigma(axis), tracked_m));
    for (int axis = 0; base_matters && axis < 3; ++axis)
      add({ParameterKind::kBaseRotation, axis, -1, kConstant}, std::hypot(base_sigma(3 + axis), tracked_rad));
    for (int i = 0; i < static_cast<int>(catheter_.sensors.size()); ++i) {
      const Sensor& sensor = catheter_.sensors[i];
      for (int axis = 0; axis < 3; ++axis)
        add({ParameterKind::kMountPosition, axis, i, kConstant}, sensor.mount_sigma_m);
      for (int axis = 0; axis < 3; ++axis)
        add({ParameterKind::kSensorPosition, axis, i, catheter_.bias_memory_s}, share * sensor.bias_m);
      for (int axis = 0; axis < 3 && sensor.kind != SensorKind::kPosition; ++axis)
        add({ParameterKind::kSensorRotation, axis, i, catheter_.bias_memory_s}, share * sensor.bias_rad);
    }
  }

  double base_sigma(int i) const {
    const BaseRegistration& base = catheter_.base;
    if (base.covariance) return std::sqrt((*base.covariance)(i, i));
    return i < 3 ? base.position_sigma_m : base.rotation_sigma_rad;
  }

  static int base_index(const UncertainParameter& p) {
    if (p.kind == ParameterKind::kBasePosition) return p.axis;
    return p.kind == ParameterKind::kBaseRotation ? 3 + p.axis : -1;
  }

  double correlation(const UncertainParameter& a, const UncertainParameter& b) const {
    const int i = base_index(a), j = base_index(b);
    if (i >= 0 && j >= 0 && catheter_.base.covariance)
      return kNotQuiteOne * (*catheter_.base.covariance)(i, j) / (base_sigma(i) * base_sigma(j));
    if (a.kind != b.kind) return 0.0;
    if (a.kind == ParameterKind::kLogStiffness) return catheter_.stiffness_correlation;
    const bool bias = a.kind == ParameterKind::kSensorPosition || a.kind == ParameterKind::kSensorRotation;
    if (!bias || a.axis != b.axis) return 0.0;
    const Sensor &one = catheter_.sensors[a.sensor], &other = catheter_.sensors[b.sensor];
    if (one.T_tracker_base || other.T_tracker_base) return 0.0;  // two trackers, for all that is known
    const double d = (one.arc_length_m - other.arc_length_m) / catheter_.bias_length_m;
    return kNotQuiteOne * std::exp(-0.5 * d * d);
  }

  static constexpr double kNotQuiteOne = 0.9999;  // two sensors in one place: still a definite covariance

  const Catheter& catheter_;
  const ParameterChoice& choice_;
  UncertainParameters out_;
  std::vector<double> sigma_;
};

}  // namespace

Vector3d force_exponent(const UncertainParameter& parameter) {
  if (parameter.kind != ParameterKind::kLogStiffness || parameter.axis == 2) return Vector3d::Zero();
  return parameter.axis == 0 ? Vector3d(0.0, 1.0, 1.0) : Vector3d::UnitX();
}

int UncertainParameters::find(ParameterKind kind, int axis, int sensor) const {
  for (int i = 0; i < size(); ++i)
    if (all[i].kind == kind && all[i].axis == axis && all[i].sensor == sensor) return i;
  return -1;
}

UncertainParameters uncertain_parameters(const Catheter& catheter, const ParameterChoice& choice) {
  return Builder(catheter, choice).build();
}

}  // namespace palpate
