// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/rod/statics.hpp>
#include <palpate/sensing/catheter.hpp>
#include <palpate/sensing/measurement.hpp>

/// The catheter of the paper, Table 2: the one source of its numbers in code. examples/paper_catheter.toml says the
/// same.
namespace palpate::reproduction {

inline constexpr double kLength_m = 70e-3;
inline constexpr double kDiameter_m = 2.33e-3;  ///< 7 F
inline constexpr double kEI1_Nm2 = 0.2612e-3, kEI2_Nm2 = 0.16664e-3, kGJ_Nm2 = 0.1645e-3;
inline constexpr double kPoissonRatio = 0.3;           ///< section 5: GJ = 0.3846 E (I1 + I2)
inline constexpr double kSensorDistance_m = 4.7e-3;    ///< section 5.1: between the two end segments
inline constexpr double kPrecurvature1_per_m = 24.57;  ///< of Experiment I (b); the simulations state none: our choice
inline constexpr double kSamplesPerSecond = 15.0;      ///< section 4.3

/// Two 6-DOF sensors, "tip" at the flexible end and "shaft" 4.7 mm behind it, without mounting offsets; base and
/// tracker frames coincide. The sensors' noise is left at the defaults: the paper's filter brings its own R.
Catheter paper_catheter(double k1_per_m = kPrecurvature1_per_m);

/// What the two sensors see under this tip force, exactly (Accuracy::kReference), and without noise.
class ExactShape {
 public:
  explicit ExactShape(const Catheter& catheter);
  Measurement measure(const Vector3d& force_tip_N, const Vector3d& log_stiffness = Vector3d::Zero());

 private:
  RodSolver rod_;
  RodSolution<0> shape_;
};

}  // namespace palpate::reproduction
