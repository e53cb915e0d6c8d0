// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <optional>
#include <palpate/estimation/global_update.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/recording/catheter_file.hpp>
#include <palpate/recording/toml_table.hpp>
#include <palpate/rod/statics.hpp>
#include <palpate/sensing/sensor_model.hpp>
#include <palpate/sensing/shape_model.hpp>
#include <palpate/study/run_model.hpp>
#include <palpate/study/settings.hpp>
#include <random>

/// One frame and one update: previous and true force drawn from a ball, the frame as the sensors of the catheter file
/// see it, the search from the previous force. No time, no adaptation, nothing considered.
namespace palpate::study {

namespace {

struct UpdateSettings {
  double ball_N = 0.1, prior_sigma_N = 0.3, stiffness_factor = 1.0;
};

UpdateSettings read_update(const Plan& plan, const toml::table& document) {
  const TomlTable table(document, "update", plan.source, {"ball_N", "prior_sigma_N", "stiffness_factor"});
  UpdateSettings s;
  s.ball_N = table.number("ball_N", {0.0, 100.0, "the radius of a ball of forces in N, 0..100"}, s.ball_N);
  s.prior_sigma_N =
      table.number("prior_sigma_N", {1e-12, 1000.0, "a force in N, more than 0, at most 1000"}, s.prior_sigma_N);
  s.stiffness_factor =
      table.number("stiffness_factor", {0.05, 20.0, "true over believed stiffness, 0.05..20"}, s.stiffness_factor);
  return s;
}

class Draws {
 public:
  explicit Draws(std::uint64_t seed) : engine_(seed) {}
  Vector3d normal3() {
    const double x = normal_(engine_), y = normal_(engine_), z = normal_(engine_);
    return {x, y, z};
  }
  Vector3d in_ball(double radius) {
    const Vector3d direction = normal3().normalized();
    return radius * std::cbrt(unit_(engine_)) * direction;
  }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> unit_;
};

std::vector<double> stations(const Catheter& catheter) {
  std::vector<double> arc_lengths_m;
  for (const Sensor& sensor : catheter.sensors) arc_lengths_m.push_back(sensor.arc_length_m);
  return arc_lengths_m;
}

/// All that the runs of one point share. The truth is solved by the reference setting: other steps than the update's.
struct Point {
  Point(const Plan& plan, const Documents& documents)
      : file(parse_catheter(toml_lines(documents.catheter, plan.catheter_source))),
        settings(read_update(plan, documents.update)),
        truth(file.catheter.rod, stations(file.catheter), Accuracy::kReference),
        solution(truth.make_solution<0>()),
        model(file.catheter, file.observer.measurement),
        search({.local = {.max_iterations = file.observer.max_iterations}}) {}

  CatheterFile file;
  UpdateSettings settings;
  RodSolver truth;
  RodSolution<0> solution;
  ShapeModel model;
  GlobalUpdate search;
  Measurement measurement;
  Update update;
};

void measure(Point& point, const Vector3d& force_N, Draws& draws) {
  TipLoad load{.force_tip_N = force_N};
  load.log_stiffness.setConstant(std::log(point.settings.stiffness_factor));
  point.truth.solve(load, point.solution);
  point.measurement.count = 0;
  const std::vector<Sensor>& sensors = point.file.catheter.sensors;
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    Pose T = point.solution.points[i].T_base_local * sensors[i].T_local_sensor;
    T.p += sensors[i].noise_m.cwiseProduct(draws.normal3());
    T.R *= exp_so3(sensors[i].noise_rad * draws.normal3());
    point.measurement.poses[static_cast<std::size_t>(point.measurement.count++)] = {static_cast<int>(i), T};
  }
}

Figures judge(const Update& update, const Vector3d& truth_N) {
  const Vector3d error = update.posterior.mean - truth_N;
  const Vector3d sigma = update.posterior.covariance.diagonal().cwiseSqrt();
  Figures figures{.rmse_N = error.cwiseAbs(), .bias_N = error};
  figures.inside_95 = (error.array().abs() <= 1.959964 * sigma.array()).cast<double>().matrix();
  figures.nees = normalised_error_squared(error, update.posterior.covariance);
  figures.nis_per_dof = update.chi_square / update.rows;
  figures.evaluations = update.evaluations;
  figures.updated = converged(update.status) ? 1.0 : 0.0;
  return figures;
}

class UpdateModel final : public RunModel {
 public:
  explicit UpdateModel(const Plan& plan) : plan_(&plan) {}

  Figures run(const RunKey& key) override {
    if (!point_ || key.point != number_) {
      point_.reset();
      point_.emplace(*plan_, documents_at(*plan_, point_values(*plan_, key.point)));
      number_ = key.point;
    }
    Point& p = *point_;
    Draws draws(key.seed);
    const Vector3d previous_N = draws.in_ball(p.settings.ball_N), truth_N = draws.in_ball(p.settings.ball_N);
    measure(p, truth_N, draws);
    p.model.select(p.measurement, (1U << p.file.catheter.sensors.size()) - 1U);
    const double variance = p.settings.prior_sigma_N * p.settings.prior_sigma_N;
    const Gaussian prior{previous_N, variance * StateMatrix::Identity(3, 3)};
    p.search.run(p.model, prior, &prior.mean, p.update);
    return judge(p.update, truth_N);
  }

 private:
  const Plan* plan_;
  std::uint64_t number_ = 0;
  std::optional<Point> point_;
};

}  // namespace

std::unique_ptr<RunModel> make_update_model(const Plan& plan) { return std::make_unique<UpdateModel>(plan); }

void check_update_documents(const Plan& plan, const Documents& documents) { Point(plan, documents); }

}  // namespace palpate::study
