// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <palpate/observer/options.hpp>
#include <palpate/simulation/scenario.hpp>
#include <string_view>

/// Section 5 of the paper as virtual twins: Experiment I (a weight over a pulley, a: in plane, b: in space) and
/// Experiment II (a force sensor on the wall of a bucket of circulating water; a: moved by hand, b: by motors at
/// 0.21 Hz, with the stiffness estimated as well).
namespace palpate::reproduction {

enum class ExperimentId : std::uint8_t { kIa, kIb, kIIa, kIIb };
inline constexpr std::array kExperiments = {ExperimentId::kIa, ExperimentId::kIb, ExperimentId::kIIa,
                                            ExperimentId::kIIb};

/// What "an Aurora, accuracy 0.48 mm and 0.3 deg" may mean for its errors.
enum class AuroraReading : std::uint8_t {
  kWhite,   ///< the stated accuracy taken as white noise, 0.48 / sqrt(3) = 0.28 mm and 0.17 deg an axis
  kAtRest,  ///< the scatter of a real one at rest: 0.03 mm and 0.06 deg an axis
  kBiased,  ///< that scatter, and the accuracy as an error over space, shared by neighbouring sensors
};
inline constexpr std::array kAuroraReadings = {AuroraReading::kWhite, AuroraReading::kAtRest, AuroraReading::kBiased};

/// A column of Table 7: MEAN and STD of the force's error, tip axes.
struct PaperError {
  Vector3d mean_N, sigma_N;
};

/// What the paper says of an experiment, and what it leaves open.
struct Experiment {
  std::string_view name;            ///< "I (a)"
  std::string_view set_up;          ///< what is assumed here, one sentence
  double precurvature_per_m = 0.0;  ///< k1,0
  int repeats = 3;                  ///< as theirs
  double duration_s = 30.0, rate_hz = 40.0;
  double curvature_factor = 1.0;         ///< of the last three entries of R, which is 1000 times that of section 4.1
  bool water = false;                    ///< it flows
  bool with_stiffness = false;           ///< CFSE
  double swing_N = 0.0;                  ///< about how far a part of the force swings to either side ...
  double swing_rad_per_s = 1.0;          ///< ... and how fast: what who sets it up knows
  std::array<PaperError, 3> paper = {};  ///< EKF, IEKF, IAEKF; II (b): what its text gives, as the axial force's
};
const Experiment& experiment(ExperimentId id);

std::string_view describe(AuroraReading reading);

/// paper_catheter() with the noise of its sensors, as truth and estimator both know it. Biased: the sensors state their
/// bias too. II (b): EI is known to 5 %.
Catheter experiment_catheter(ExperimentId id, AuroraReading reading);

/// The n-th repeat; what differs is the tracker's noise and the water's pushes.
Scenario experiment_scenario(ExperimentId id, AuroraReading reading, int repeat);

/// The product as it comes: raw poses, the sensors' own noise, process noise found from the data.
ObserverOptions experiment_options(ExperimentId id, Method method);

/// White acceleration [N/s per sqrt(s)] that is to be expected of a force that swings by A at w,
///   q = (A w^2 / sqrt(2)) sqrt(1 / w),
/// the root mean square of its acceleration, alike for 1 / w: what a user may state instead of having it found.
double stated_pace(const Experiment& experiment);

}  // namespace palpate::reproduction
