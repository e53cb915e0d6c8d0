// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <palpate/sensing/catheter.hpp>
#include <vector>

namespace palpate {

/// A number of the catheter file that is not known exactly. p is its deviation from the file.
enum class ParameterKind : std::uint8_t {
  kLogStiffness,    ///< of EI1, EI2, GJ (axis 0, 1, 2)
  kPrecurvature,    ///< k1,0, k2,0, tau0 [1/m]
  kTendonScale,     ///< c, constant error of the tendon channel: the moment is exp(c) (M + w), M as read
  kTendonMoment,    ///< w, its white noise [N m], about d1 and d2: inside the scale, for a moment twice as large shows
                    ///< the noise no better than a shaft half as stiff does
  kBasePosition,    ///< of the clamp, base axes [m]
  kBaseRotation,    ///< of the clamp, base axes [rad]
  kMountPosition,   ///< of a sensor on the shaft, local axes [m]
  kSensorPosition,  ///< slowly varying error of a measured pose, base axes [m]
  kSensorRotation,  ///< likewise [rad]
  kStiffnessRate,   ///< of all log stiffnesses alike [1/s]; moves nothing by itself
};

struct UncertainParameter {
  ParameterKind kind = ParameterKind::kLogStiffness;
  int axis = 0;
  int sensor = -1;         ///< where it belongs to one
  double memory_s = 0.0;   ///< Gauss-Markov; inf: constant; 0: drawn anew at every frame
  bool estimated = false;  ///< otherwise only considered: it widens the force's sigma
  double drive = 0.0;      ///< of an estimated one that wanders: unit / sqrt(s)
};

/// E_i: the tip force that a filter follows is f, with F = exp(sum_i E_i p_i) f axis by axis. A force across d2 or
/// along d3 bends the shaft about d1 and is scaled by EI1, one across d1 by EI2: f is what the force would be if the
/// stiffness were the file's. Shape tells f, whatever the stiffness; and f, not F, is what moves as the filter's law
/// says, for if F were to, each change of it would seem to say how large a newton is.
Vector3d force_exponent(const UncertainParameter& parameter);

/// What is to be made of the catheter file's sigmas.
struct ParameterChoice {
  bool consider = false;  ///< false: what is not estimated is taken as exact
  bool estimate_stiffness = false;
  bool free_torsion = false;  ///< GJ for itself; otherwise it keeps its ratio to EI1 + EI2 (Poisson's ratio)
  bool estimate_precurvature = false;
  double stiffness_rate_per_s = 0.004;  ///< spread of the rate at which an estimated stiffness drifts, as a share of it
  double stiffness_drift_per_sqrt_s = 0.001;      ///< what each log EI wanders besides
  double precurvature_drift_per_m_sqrt_s = 0.05;  ///< of an estimated k1,0
};

/// All uncertain parameters of a catheter as one vector, zero-mean: first those that bend the rod, then those that
/// move the measured poses (and enter the residual linearly). A parameter of sigma zero is not in it, but for those to
/// be estimated: without a sigma in the file they get kStiffnessPrior, kPrecurvaturePrior_per_m.
struct UncertainParameters {
  static constexpr double kStiffnessPrior = 0.2, kPrecurvaturePrior_per_m = 5.0;
  static constexpr int kMaxRod = 9;  ///< stiffness 3, precurvature 3, tendon 3

  std::vector<UncertainParameter> all;
  int rod_count = 0;           ///< the first so many bend the rod
  Eigen::MatrixXd covariance;  ///< of the stationary processes; the tendon noise is that of each frame
  bool torsion_tied = true;

  int size() const { return static_cast<int>(all.size()); }
  int pose_count() const { return size() - rod_count; }
  /// Index of a parameter; -1: not uncertain.
  int find(ParameterKind kind, int axis, int sensor = -1) const;
};

/// A tendon channel without noise is taken to have this much, so that no covariance is singular.
inline constexpr double kLeastTendonNoise_Nm = 1e-12;

/// Throws nothing; `catheter` is valid. Sigmas per axis: a bias of rms b in 3-D is b / sqrt(3) along each axis. Errors
/// of two sensors of one tracker at arc lengths d apart are correlated by exp(-d^2 / 2 l^2), l = bias_length_m. The
/// bias of a tracked base is part of the clamp's error.
UncertainParameters uncertain_parameters(const Catheter& catheter, const ParameterChoice& choice);

}  // namespace palpate
