// SPDX-License-Identifier: Apache-2.0
#include <Eigen/LU>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <palpate/reproduction/virtual_paper.hpp>

namespace palpate::reproduction {

namespace {

constexpr int kFigure3Sines = 100, kFigure3Steps = 150;

Course measured(const Catheter& catheter, std::vector<Vector3d> force_tip_N) {
  Course course{.force_tip_N = std::move(force_tip_N), .data = {}};
  ExactShape shape(catheter);
  for (const Vector3d& F : course.force_tip_N) course.data.push_back(shape.measure(F));
  return course;
}

double phase(int step) { return 2.0 * std::numbers::pi * step / kSamplesPerSecond; }

void begin(PaperFilter& filter, const PaperOptions& options, const Catheter& catheter, const Course& course,
           const Start& start) {
  StateVector x0 = filter.initial(start.force_tip_N).mean;
  if (options.stiffness) x0.tail<2>() *= start.stiffness_factor;
  StateMatrix P0 = filter.initial(start.force_tip_N).covariance;
  if (options.stiffness && start.stiffness_sigma > 0.0)
    P0.diagonal().tail<2>() = (start.stiffness_sigma * x0.tail<2>()).cwiseAbs2();
  filter.start(filter.initial(course.force_tip_N.front()));
  const Measurement rest = ExactShape(catheter).measure(course.force_tip_N.front());
  for (int i = 0; i < start.tuning_samples; ++i) filter.update(rest);
  const Gaussian first{x0, P0};
  start.tuning_samples > 0 ? filter.set_state(first) : filter.start(first);
}

}  // namespace

Course figure3_course(const Catheter& catheter) {
  std::vector<Vector3d> force_tip_N;
  for (int k = 0; k < kFigure3Steps; ++k) {
    const Vector3d sines(0.05 * std::sin(phase(k)), 0.05 * std::cos(phase(k)), -0.1 * std::sin(phase(k)));
    force_tip_N.push_back(k < kFigure3Sines ? sines : Vector3d(0.05, -0.05, -0.1));
  }
  return measured(catheter, std::move(force_tip_N));
}

Course sine_course(const Catheter& catheter, int steps) {
  std::vector<Vector3d> force_tip_N;
  for (int k = 0; k < steps; ++k) force_tip_N.emplace_back(0.1 * std::sin(phase(k)), 0.0, 0.0);
  return measured(catheter, std::move(force_tip_N));
}

Run run_filter(const Catheter& catheter, const PaperOptions& options, const Course& course, const Start& start) {
  using Clock = std::chrono::steady_clock;
  PaperFilter filter(catheter, options);
  begin(filter, options, catheter, course, start);
  Run run;
  for (std::size_t k = 0; k < course.size(); ++k) {
    const Clock::time_point before = Clock::now();
    const PaperStep& step = filter.update(course.data[k]);
    run.seconds.push_back(std::chrono::duration<double>(Clock::now() - before).count());
    run.error_N.emplace_back(filter.force_tip_N() - course.force_tip_N[k]);
    if (options.stiffness) run.stiffness_Nm2.emplace_back(filter.state().mean.tail<2>());
    run.rho.push_back(step.rho.paper);
    run.rho_normalised.push_back(step.rho.normalised);
    run.R.push_back(step.R);
    run.unconverged += converged(step.update.status) ? 0 : 1;
    run.evaluations += step.update.evaluations / static_cast<double>(course.size());
  }
  return run;
}

Statistics statistics(const std::vector<Vector3d>& errors_N, std::size_t first) {
  Statistics s{Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
  const auto n = static_cast<double>(errors_N.size() - first);
  for (std::size_t k = first; k < errors_N.size(); ++k) {
    s.max_abs = s.max_abs.cwiseMax(errors_N[k].cwiseAbs());
    s.mean += errors_N[k] / n;
  }
  for (std::size_t k = first; k < errors_N.size(); ++k) {
    s.std += (errors_N[k] - s.mean).cwiseAbs2() / n;
    s.rmse += errors_N[k].cwiseAbs2() / n;
  }
  s.std = s.std.cwiseSqrt();
  s.rmse = s.rmse.cwiseSqrt();
  return s;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<Vector3d> forced_lag(const Catheter& catheter, const Course& course, double Q_N2,
                                 const std::vector<PaperNoise>& R, const Vector3d& start_N) {
  PaperModel model(catheter, false, R.front());
  Matrix3d P = Q_N2 * Matrix3d::Identity();
  Vector3d before_N = start_N, error_N = Vector3d::Zero();
  std::vector<Vector3d> lag_N;
  Linearization at;
  for (std::size_t k = 0; k < course.size(); ++k) {
    const PaperNoise& noise = R[std::min(k, R.size() - 1)];
    model.select(course.data[k]);
    model.linearize(course.force_tip_N[k], at);
    const Matrix3d information =
        at.jacobian.transpose() * noise.cwiseInverse().asDiagonal() * at.jacobian;  // J^T R^-1 J
    const Matrix3d prior = P + Q_N2 * Matrix3d::Identity();
    const Matrix3d weight = Matrix3d::Identity() + prior * information;  // (I - K J)^-1
    P = weight.lu().solve(prior);
    error_N = weight.lu().solve(error_N - (course.force_tip_N[k] - before_N));
    before_N = course.force_tip_N[k];
    lag_N.push_back(error_N);
  }
  return lag_N;
}

}  // namespace palpate::reproduction
