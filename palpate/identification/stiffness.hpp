// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <palpate/sensing/catheter.hpp>
#include <span>
#include <string>
#include <vector>

/// Stiffness from the shape that known loads give the shaft: the paper's Eq. (20), here squared and weighted,
///
///   K = arg min  sum over cases e, points i of  |W_i (y_ei - h(s_i; F_e, K))|^2 ,
///
/// h the equilibrium under dead loads (rod/base_loads.hpp), W the inverse of each point's sigma. Stiffness is positive:
/// the unknowns are logarithms. What the catheter file is unsure of (clamp pose, precurvature) is unknown too, with its
/// sigma as prior, so that it widens the answer.
namespace palpate {

/// What was seen of the shaft at one place, in the base frame.
struct ShapePoint {
  /// NaN: not known; it is where the shaft is as far along e3 of the base as the point (position_base_m.z() measured).
  double arc_length_m = 0.0;
  Pose T_local_sensor;                          ///< a sensor's mounting; a point of the centre line: identity
  Vector3d position_base_m = Vector3d::Zero();  ///< NaN: this component was not measured
  std::optional<Matrix3d> R_base_sensor;        ///< where the orientation was measured, too
  Vector3d sigma_m = Vector3d::Zero();          ///< along the base axes; all zero: unknown, told by the residuals
  double sigma_rad = 0.0;                       ///< per axis; needed where the orientation was measured
};

/// The shaft at rest under one dead load.
struct LoadCase {
  std::string name;
  Vector3d force_base_N = Vector3d::Zero();  ///< at Rod::contact_offset_m
  std::vector<ShapePoint> points;
};

struct StiffnessOptions {
  enum class Unknowns {
    kScale,              ///< one factor for EI1, EI2 and GJ
    kBending,            ///< EI1 and EI2; GJ follows them
    kBendingAndTorsion,  ///< EI1, EI2 and GJ
  };
  enum class Method {
    kLevenbergMarquardt,  ///< Ceres, exact sensitivities
    kNelderMead,          ///< NLopt, the paper's
  };
  enum class OwnWeight {
    kIncluded,    ///< the shapes are as they hang
    kSubtracted,  ///< of every point the place under own weight alone was taken off and that without any load put back
  };
  Unknowns unknowns = Unknowns::kBending;
  Method method = Method::kLevenbergMarquardt;
  OwnWeight own_weight = OwnWeight::kIncluded;
  /// kBending: GJ = (EI1 + EI2) / (2 (1 + nu)). Empty: GJ keeps its share of EI1 + EI2.
  std::optional<double> poisson_ratio = std::nullopt;
  bool free_shear = false;  ///< the shear stiffness is unknown too; otherwise shear and axial stiffness keep their
                            ///< share of EI1 + EI2. Only for a rod that shears.
};

/// One unknown stiffness: a factor on what the catheter file says.
struct StiffnessUnknown {
  std::string name;        ///< "EI1", "EI2", "GJ", "stiffness scale", "shear stiffness"
  double value = 0.0;      ///< N m^2, N, or a factor
  double log_sigma = 0.0;  ///< one standard deviation of its logarithm: relative
};

struct StiffnessFit {
  bool converged = false;
  Rod rod;  ///< as identified; precurvature and weight as described
  std::vector<StiffnessUnknown> unknowns;
  Eigen::MatrixXd log_covariance;  ///< of the logarithms of the unknowns, in their order
  Eigen::MatrixXd correlation;
  struct Case {
    std::string name;
    std::vector<Vector3d> residual_m;  ///< measured - fitted, base axes; NaN where not measured, or z that
                                       ///< told the place along the shaft
    std::vector<Pose> T_base_point;    ///< fitted, at the points
    double rms_m = 0.0;                ///< over the measured components
  };
  std::vector<Case> cases;
  double rms_m = 0.0;       ///< over all measured components
  double chi_square = 0.0;  ///< prior of the nuisances included; where it is beyond 99.9 % of chance, all sigmas are
                            ///< wider by the root of chi^2 / dof, and a warning says so
  int degrees_of_freedom = 0;
  double point_sigma_m = 0.0;  ///< stated, or told by the residuals
  int iterations = 0;
  int cost_evaluations = 0;           ///< of the whole cost, with or without sensitivities
  int rod_evaluations = 0;            ///< integrations of one rod
  std::vector<std::string> warnings;  ///< what a user must know, one line each
};

/// What the other cases say of one that was left out.
struct LeftOut {
  std::string name;
  std::vector<StiffnessUnknown> unknowns;  ///< identified without it
  double rms_m = 0.0;                      ///< of its points against the shape predicted for its load
  /// Its load as the shape tells it with that stiffness, along the stated force; for a case without force along the
  /// mean of the others' forces.
  double stated_N = 0.0, predicted_N = 0.0, sigma_N = 0.0;
};

/// Identifies the stiffness of the flexible sections, all by the same factors, starting from what `catheter` says.
/// Uses catheter.rod, the base's and the precurvature's sigmas. Offline: allocates.
/// Throws InputError, naming the cause, on fewer measured components than unknowns, no case with a load, and a shape
/// that no stiffness within a factor of 1e4 explains. What these loads do not tell (loads that bend one axis alone; GJ
/// without a twist) is a warning that names the unknown, which then keeps its start and an infinite sigma.
StiffnessFit identify_stiffness(const Catheter& catheter, std::span<const LoadCase> cases,
                                const StiffnessOptions& options = {});

/// Each case left out in turn; needs two or more. Costs as many fits as there are cases.
std::vector<LeftOut> leave_one_out(const Catheter& catheter, std::span<const LoadCase> cases,
                                   const StiffnessOptions& options = {});

}  // namespace palpate
