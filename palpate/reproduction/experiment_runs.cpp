// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <cmath>
#include <future>
#include <limits>
#include <mutex>
#include <palpate/observer/smoothing.hpp>
#include <palpate/reproduction/experiment_runs.hpp>
#include <palpate/reproduction/paper_filter.hpp>

namespace palpate::reproduction {
namespace {

void append(const Estimate& e, bool with_stiffness, EstimatedCourse& course) {
  course.force_tip_N.push_back(e.force_tip_N);
  course.sigma_N.emplace_back(e.covariance_tip_N2.diagonal().cwiseSqrt());
  if (!with_stiffness) return;
  course.stiffness_Nm2.push_back(e.shaft.stiffness_Nm2);
  course.stiffness_sigma_Nm2.push_back(e.shaft.stiffness_sigma_Nm2);
}

/// The product.
struct ProductCourses {
  EstimatedCourse online, smoothed;
};
ProductCourses run_product(const Catheter& catheter, const ObserverOptions& options,
                           const std::vector<TrackerFrame>& frames) {
  ForceObserver observer(catheter, options);
  SmoothingPass smoothing(observer);
  ProductCourses out;
  for (const TrackerFrame& frame : frames) {
    const Estimate e = observer.update(frame);
    append(e, options.estimate_stiffness, out.online);
    smoothing.add(observer, frame, e);
  }
  for (const Estimate& e : smoothing.finish(observer)) append(e, options.estimate_stiffness, out.smoothed);
  return out;
}

/// The paper's filter, from no force, with its l_i = 10, M = 15 and Q.
EstimatedCourse run_paper(ExperimentId id, const Catheter& catheter, PaperMethod method,
                          const std::vector<TrackerFrame>& frames) {
  const Experiment& e = experiment(id);
  PaperOptions options{.method = method, .stiffness = e.with_stiffness};
  options.R = experiment_noise(e.curvature_factor);
  options.accuracy = Accuracy::kRealtime;
  if (e.with_stiffness) options.Q_N2 = 9e-4, options.Q_stiffness_Nm2 = 1e-8;
  PaperFilter filter(catheter, options);
  filter.start(Vector3d::Zero());
  EstimatedCourse course;
  Measurement measurement;
  for (const TrackerFrame& frame : frames) {
    register_frame(catheter, frame, measurement);
    filter.update(measurement);
    course.force_tip_N.push_back(filter.force_tip_N());
    if (!e.with_stiffness) continue;
    const StateVector& x = filter.state().mean;
    course.stiffness_Nm2.emplace_back(x(3), x(4), 0.0);
  }
  return course;
}

void take_truth(const VirtualRun& played, ExperimentRun& run) {
  for (const Truth& truth : played.truth) {
    run.times_s.push_back(truth.time_s);
    run.truth_N.push_back(truth.force_tip_N);
    run.true_stiffness_Nm2.push_back(truth.stiffness_Nm2);
  }
  run.events = played.events;
}

void run_ours(const Catheter& believed, const std::vector<TrackerFrame>& frames, const ObserverOptions& options,
              Estimator online, Estimator smoothed, ExperimentRun& run) {
  ProductCourses product = run_product(believed, options, frames);
  run.courses[static_cast<std::size_t>(online)] = std::move(product.online);
  if (smoothed != online) run.courses[static_cast<std::size_t>(smoothed)] = std::move(product.smoothed);
}

void run_estimators(const ExperimentJob& job, const Catheter& believed, const std::vector<TrackerFrame>& frames,
                    ExperimentRun& run) {
  const auto ours = [&](const ObserverOptions& options, Estimator online, Estimator smoothed) {
    run_ours(believed, frames, options, online, smoothed, run);
  };
  run.courses.resize(kEstimators.size());
  ObserverOptions options = experiment_options(job.id, Method::kIekf);
  ours(options, Estimator::kIekf, Estimator::kSmoothed);
  options.force_acceleration_N_per_s_sqrt_s = stated_pace(experiment(job.id));
  ours(options, Estimator::kStated, Estimator::kStatedSmoothed);
  if (job.what == RunWhat::kOurIekf) return;
  ours(experiment_options(job.id, Method::kEkf), Estimator::kEkf, Estimator::kEkf);
  ours(experiment_options(job.id, Method::kIaekf), Estimator::kIaekf, Estimator::kIaekf);
  run.courses[0] = run_paper(job.id, believed, PaperMethod::kEkf, frames);
  run.courses[1] = run_paper(job.id, believed, PaperMethod::kIekf, frames);
  run.courses[2] = run_paper(job.id, believed, PaperMethod::kIaekf, frames);
}

ErrorStatistics statistics_of(const EstimatedCourse& course, const ExperimentRun& run) {
  const Vector3d unknown = Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  if (course.force_tip_N.empty()) return {unknown, unknown};
  return error_statistics(course.force_tip_N, run.truth_N, run.first);
}

/// A plate that holds the tip takes what the water pushes at it: its force trembles, the shape does not, and the
/// tremor is no course that a law of motion could follow.
ForceBounds bounds_in_still_water(Scenario scenario, const VirtualRun& played, std::size_t first) {
  const bool still = scenario.flow.rms_N == 0.0;
  scenario.flow = {};
  const VirtualRun calm = still ? played : run_scenario(scenario);
  std::vector<Vector3d> force_N;
  for (const Truth& truth : calm.truth) force_N.push_back(truth.force_tip_N);
  const std::vector<Matrix3d> information = force_information(scenario.catheter, calm.frames, force_N);
  return force_bounds(information, force_N, 1.0 / scenario.tracker.rate_hz, first);
}

}  // namespace

std::string_view describe(Estimator estimator) {
  switch (estimator) {
    case Estimator::kPaperEkf:
      return "paper's EKF";
    case Estimator::kPaperIekf:
      return "paper's IEKF";
    case Estimator::kPaperIaekf:
      return "paper's IAEKF";
    case Estimator::kEkf:
      return "our EKF";
    case Estimator::kIekf:
      return "our IEKF";
    case Estimator::kIaekf:
      return "our IAEKF";
    case Estimator::kSmoothed:
      return "our IEKF, smoothed";
    case Estimator::kStated:
      return "our IEKF, pace stated";
    case Estimator::kStatedSmoothed:
      break;
  }
  return "our IEKF, pace stated, smoothed";
}

ExperimentRun run_experiment(const ExperimentJob& job) {
  Scenario scenario = experiment_scenario(job.id, job.reading, job.repeat);
  const Catheter believed = scenario.catheter;
  for (Section& section : scenario.catheter.rod.sections) section.stiffness_Nm2 *= 1.0 + job.stiffness_error;
  const VirtualRun played = run_scenario(scenario);
  ExperimentRun run;
  take_truth(played, run);
  const double frame_s = 1.0 / scenario.tracker.rate_hz;
  run.first = static_cast<std::size_t>(std::ceil(1.0 / frame_s - 1e-9));
  if (job.what == RunWhat::kTruth) return run;
  run_estimators(job, believed, played.frames, run);
  for (const EstimatedCourse& course : run.courses) run.statistics.push_back(statistics_of(course, run));
  run.bounds = bounds_in_still_water(scenario, played, run.first);
  return run;
}

std::vector<ExperimentRun> run_experiments(std::span<const ExperimentJob> jobs, const Settings& settings) {
  std::vector<ExperimentRun> runs(jobs.size());
  std::atomic<std::size_t> next = 0;
  std::mutex telling;
  std::size_t done = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < jobs.size(); i = next++) {
      runs[i] = run_experiment(jobs[i]);
      const std::scoped_lock lock(telling);
      ++done;
      if (settings.progress) settings.progress(static_cast<double>(done) / static_cast<double>(jobs.size()));
    }
  };
  std::vector<std::future<void>> workers;
  for (int i = 1; i < settings.workers; ++i) workers.push_back(std::async(std::launch::async, work));
  work();
  for (std::future<void>& worker : workers) worker.get();
  return runs;
}

std::vector<ExperimentJob> repeats_of(ExperimentId id, AuroraReading reading, double stiffness_error, RunWhat what) {
  std::vector<ExperimentJob> jobs;
  jobs.reserve(static_cast<std::size_t>(experiment(id).repeats));
  for (int i = 0; i < experiment(id).repeats; ++i)
    jobs.push_back({.id = id, .reading = reading, .repeat = i, .stiffness_error = stiffness_error, .what = what});
  return jobs;
}

}  // namespace palpate::reproduction
