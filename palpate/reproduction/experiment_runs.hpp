// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/reproduction/experiment_bounds.hpp>
#include <palpate/reproduction/experiment_scenarios.hpp>
#include <palpate/reproduction/experiment_statistics.hpp>
#include <palpate/reproduction/part.hpp>
#include <palpate/simulation/virtual_run.hpp>
#include <vector>

/// The virtual twins played, and every estimator run over them.
namespace palpate::reproduction {

/// The paper's filters with its measurement vector and R, then the product with its defaults.
enum class Estimator : std::uint8_t {
  kPaperEkf,
  kPaperIekf,
  kPaperIaekf,
  kEkf,
  kIekf,
  kIaekf,
  kSmoothed,        ///< IEKF, then every frame in the light of the whole recording
  kStated,          ///< IEKF with stated_pace()
  kStatedSmoothed,  ///< likewise, smoothed
};
inline constexpr std::array kEstimators = {Estimator::kPaperEkf, Estimator::kPaperIekf, Estimator::kPaperIaekf,
                                           Estimator::kEkf,      Estimator::kIekf,      Estimator::kIaekf,
                                           Estimator::kSmoothed, Estimator::kStated,    Estimator::kStatedSmoothed};
std::string_view describe(Estimator estimator);

/// What an estimator says, a row a frame. Sigmas are empty for the paper's filters, whose covariance rests on an R that
/// is not that of the data; stiffness is empty where it is not estimated.
struct EstimatedCourse {
  std::vector<Vector3d> force_tip_N, sigma_N;
  std::vector<Vector3d> stiffness_Nm2, stiffness_sigma_Nm2;
};

/// One repeat.
struct ExperimentRun {
  std::vector<double> times_s;
  std::vector<Vector3d> truth_N;  ///< tip axes
  std::vector<Vector3d> true_stiffness_Nm2;
  std::vector<EstimatedCourse> courses;     ///< as kEstimators
  std::vector<ErrorStatistics> statistics;  ///< likewise; the first second is left out
  ForceBounds bounds;                       ///< of the white noise; the shaft known, the water still
  std::vector<ScenarioEvent> events;
  std::size_t first = 0;  ///< frame that is judged first

  const EstimatedCourse& course(Estimator e) const { return courses[static_cast<std::size_t>(e)]; }
};

/// Who runs over a repeat. Who does not has an empty course, and statistics of NaN.
enum class RunWhat : std::uint8_t {
  kAll,
  kOurIekf,  ///< its four: online and smoothed, pace found and stated
  kTruth,    ///< nobody; no bounds either
};

/// One repeat to be played.
struct ExperimentJob {
  ExperimentId id = ExperimentId::kIa;
  AuroraReading reading = AuroraReading::kWhite;
  int repeat = 0;
  double stiffness_error = 0.0;  ///< share by which the shaft is stiffer than believed, EI1, EI2 and GJ alike
  RunWhat what = RunWhat::kAll;
};

/// Throws what run_scenario() throws.
ExperimentRun run_experiment(const ExperimentJob& job);

/// All of them, in order, over Settings::workers threads; tells its progress.
std::vector<ExperimentRun> run_experiments(std::span<const ExperimentJob> jobs, const Settings& settings);

/// As many repeats as the paper made.
std::vector<ExperimentJob> repeats_of(ExperimentId id, AuroraReading reading, double stiffness_error = 0.0,
                                      RunWhat what = RunWhat::kAll);

}  // namespace palpate::reproduction
