// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <apps/palpate/estimate_input.hpp>
#include <apps/palpate/reference_tare.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/observer/smoothing.hpp>
#include <string_view>

/// Estimates as the library makes them, every digit of every number: what Python must give.
///   palpate_python_dump CATHETER RECORDING [--smooth] [--stiffness] [--tendon CSV]
namespace palpate {
namespace {

template <class Matrix>
std::string digits(const Matrix& matrix) {
  std::string text;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i)
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) text += fmt::format(",{:.17g}", matrix(i, j));
  return text;
}

void print(const Estimate& e) {
  std::string sources;
  for (const Vector3d& sigma_N : e.sigma_by_source_N) sources += digits(sigma_N);
  fmt::print("{:.17g},{},{},{},{},{:.17g}{}{}{}{}{}{}{}{}{}\n", e.time_s, static_cast<int>(e.status), e.sensors_used,
             e.dof, e.evaluations, e.nis, digits(e.force_tip_N), digits(e.covariance_tip_N2), digits(e.force_base_N),
             digits(e.R_base_tip), digits(e.shaft.stiffness_Nm2), digits(e.shaft.stiffness_sigma_Nm2),
             digits(e.shaft.precurvature_per_m), digits(e.shaft.precurvature_sigma_per_m), sources);
}

void run(const app::EstimateOptions& options, bool stiffness) {
  CatheterFile file = read_catheter_file(options.catheter);
  file.observer.estimate_stiffness = stiffness;
  if (!options.tendon.empty()) file.catheter = driven_by_map(file.catheter);
  const TrackerRecording recording = app::load_recording(options, file, file.warnings);
  ForceObserver observer(app::correct_by_reference(file, recording, file.warnings).catheter, file.observer);
  SmoothingPass smoothing(observer);
  for (const TrackerFrame& frame : recording.frames) {
    const Estimate estimate = observer.update(frame);
    options.smooth ? smoothing.add(observer, frame, estimate) : print(estimate);
  }
  for (const Estimate& estimate : smoothing.finish(observer)) print(estimate);
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  palpate::app::EstimateOptions options;
  bool stiffness = false;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--smooth")
      options.smooth = true;
    else if (word == "--stiffness")
      stiffness = true;
    else if (word == "--tendon" && i + 1 < argc)
      options.tendon = argv[++i];
    else if (options.catheter.empty())
      options.catheter = word;
    else
      options.recordings.emplace_back(word);
  }
  try {
    palpate::run(options, stiffness);
  } catch (const palpate::InputError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
