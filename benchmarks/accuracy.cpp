// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <benchmarks/textbook_setup.hpp>
#include <nlohmann/json.hpp>
#include <palpate/estimation/kalman.hpp>
#include <tests/shared_recordings.hpp>

/// RMSE of the yardstick, of the iterated update with the same R and Q, and of the observer on the same recordings, all
/// frames after one second: a ratio of times says little where the quicker one is the worse one.
namespace palpate {
namespace {

struct Row {
  std::string recording, filter;
  Vector3d rmse_N = Vector3d::Zero();
  double total_N() const { return rmse_N.norm(); }
};

/// Root mean square an axis of the frames that start one second after the first.
class Error {
 public:
  void add(double time_s, const Vector3d& force_N, const Vector3d& truth_N) {
    if (time_s < 1.0) return;
    sum_ += (force_N - truth_N).cwiseAbs2();
    ++count_;
  }
  Vector3d rmse_N() const { return (sum_ / count_).cwiseSqrt(); }

 private:
  Vector3d sum_ = Vector3d::Zero();
  int count_ = 0;
};

/// A random walk of so much a frame under `update(measurement, mean, covariance)`, from no force with the covariance of
/// one step.
template <class UpdateStep>
Vector3d rmse_of_walk(const test::SharedRecording& recording, double walk_N, const UpdateStep& update) {
  const Matrix3d Q = walk_N * walk_N * Matrix3d::Identity();
  textbook::Belief belief{Vector3d::Zero(), Q};
  Measurement measurement;
  Error error;
  for (std::size_t i = 0; i < recording.frames.size(); ++i) {
    register_frame(recording.catheter, recording.frames[i], measurement);
    belief.covariance_N2 += Q;
    if (measurement.count == 2) belief = update(measurement, belief);
    error.add(recording.frames[i].time_s, belief.force_tip_N, recording.truth.force_tip_N[i]);
  }
  return error.rmse_N();
}

template <int Rows>
Vector3d textbook_rmse(const test::SharedRecording& recording, const Eigen::Matrix<double, Rows, Rows>& information,
                       double walk_N) {
  const textbook::Shaft shaft = textbook::shaft_of(recording.catheter);
  return rmse_of_walk(recording, walk_N, [&](const Measurement& measurement, const textbook::Belief& prior) {
    return textbook::iekf_update<Rows>(shaft, prior, textbook::poses_of(measurement), information);
  });
}

Vector3d bare_rmse(const test::SharedRecording& recording, MeasurementKind kind, double walk_N) {
  ShapeModel model(recording.catheter, kind);
  Update out;
  return rmse_of_walk(recording, walk_N, [&](const Measurement& measurement, const textbook::Belief& prior) {
    model.select(measurement, ~0U);
    iterated_update(model, {prior.force_tip_N, prior.covariance_N2}, prior.force_tip_N, {}, out);
    return textbook::Belief{out.posterior.mean, out.posterior.covariance};
  });
}

/// The textbook with R as the sensors are and, of a range of walks, the one that the truth likes best: better than
/// anybody could tune it. Then the iterated update with that R and Q.
template <int Rows>
void add_best_walk(const std::string& name, const test::SharedRecording& recording, MeasurementKind kind,
                   std::vector<Row>& rows) {
  ShapeModel model(recording.catheter, kind);
  Measurement measurement;
  register_frame(recording.catheter, recording.frames.front(), measurement);
  model.select(measurement, ~0U);
  const auto information = textbook::noise_information<Rows>(model);
  const std::string layout = Rows == textbook::kPaperRows ? "Eq. (11)" : "poses";
  Row best;
  double best_walk_mN = 0.0;
  for (const double walk_mN : {0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 300.0}) {
    const Vector3d rmse_N = textbook_rmse<Rows>(recording, information, 1e-3 * walk_mN);
    if (!best.filter.empty() && best.total_N() <= rmse_N.norm()) continue;
    best_walk_mN = walk_mN;
    best = {name, fmt::format("textbook, {}, exact R, best Q of 9 ({:g} mN a frame)", layout, walk_mN), rmse_N};
  }
  rows.push_back(best);
  rows.push_back({name, fmt::format("iterated update, {}, the same R and Q", layout),
                  bare_rmse(recording, kind, 1e-3 * best_walk_mN)});
}

/// Section 4.1: R and Q as printed.
Row paper_row(const std::string& name, const test::SharedRecording& recording) {
  Eigen::Matrix<double, 9, 1> R;
  R << Vector3d::Constant(1e-6), Vector3d::Constant(0.0012), Vector3d::Constant(1e6);
  const Eigen::Matrix<double, 9, 9> information = R.cwiseInverse().asDiagonal();
  return {name, "textbook, Eq. (11), the paper's R and Q", textbook_rmse<9>(recording, information, 0.3)};
}

Row observer_row(const std::string& name, const test::SharedRecording& recording, const char* filter,
                 const ObserverOptions& options) {
  ForceObserver observer(recording.catheter, options);
  Error error;
  for (std::size_t i = 0; i < recording.frames.size(); ++i)
    error.add(recording.frames[i].time_s, observer.update(recording.frames[i]).force_tip_N,
              recording.truth.force_tip_N[i]);
  return {name, filter, error.rmse_N()};
}

std::vector<Row> rows() {
  std::vector<Row> all;
  for (const std::string name : {"heartbeat", "weight_planar"}) {
    const test::SharedRecording recording = test::shared_recording(name);
    all.push_back(paper_row(name, recording));
    add_best_walk<textbook::kPaperRows>(name, recording, MeasurementKind::kTipAndCurvature, all);
    add_best_walk<textbook::kPoseRows>(name, recording, MeasurementKind::kPoses, all);
    all.push_back(
        observer_row(name, recording, "ForceObserver, random walk", {.force_model = ForceMotion::kRandomWalk}));
    all.push_back(observer_row(name, recording, "ForceObserver, default", {}));
  }
  return all;
}

void print(const std::vector<Row>& all, bool json) {
  if (!json) fmt::print("{:16}{:56}{:>8}{:>8}{:>8}{:>8}\n", "recording", "filter", "Fx mN", "Fy mN", "Fz mN", "all");
  nlohmann::json list = nlohmann::json::array();
  for (const Row& r : all) {
    const Vector3d mN = 1e3 * r.rmse_N;
    list.push_back({{"recording", r.recording}, {"filter", r.filter}, {"rmse_mN", {mN.x(), mN.y(), mN.z()}}});
    if (!json)
      fmt::print("{:16}{:56}{:8.2f}{:8.2f}{:8.2f}{:8.2f}\n", r.recording, r.filter, mN.x(), mN.y(), mN.z(), mN.norm());
  }
  if (json) fmt::print("{}\n", list.dump(1));
}

int main_of(int argc, char** argv) {
  bool json = false;
  CLI::App app{"RMSE of the textbook filter and of the observer on the same recordings."};
  app.footer("Example: benchmark_accuracy --json");
  app.add_flag("--json", json, "machine-readable");
  CLI11_PARSE(app, argc, argv);
  if (!std::filesystem::exists(test::shared_data(test::kRecordings))) {
    fmt::print(stderr, "recordings absent: expected them in {}\n", test::shared_data(test::kRecordings).string());
    return 2;
  }
  print(rows(), json);
  return 0;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    return palpate::main_of(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
