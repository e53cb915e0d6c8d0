// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <palpate/evaluation/evaluation.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/observer/force_observer.hpp>
#include <palpate/recording/catheter_file.hpp>
#include <palpate/recording/tracker_recording.hpp>

namespace {

/// What `palpate estimate` and `palpate evaluate` do, without their summaries.
void estimate_recording(const char* catheter_path, const char* recording_path, const char* truth_path) {
  using namespace palpate;
  const CatheterFile file = read_catheter_file(catheter_path);
  TrackerRecording recording = read_tracker_recording(recording_path);
  bind_to_catheter(recording, file.catheter, file.ignore_sensors);

  ForceObserver observer(file.catheter, file.observer);
  std::vector<EstimateRow> rows;
  for (const TrackerFrame& frame : recording.frames) {
    const Estimate estimate = observer.update(frame);
    rows.push_back(row_of(estimate));
    if (frame.number % 200 != 0) continue;
    std::printf("%6.2f s  %+7.1f %+7.1f %+7.1f mN  %s\n", estimate.time_s, 1e3 * estimate.force_tip_N.x(),
                1e3 * estimate.force_tip_N.y(), 1e3 * estimate.force_tip_N.z(), describe(estimate.status).data());
  }

  const Evaluation judged = evaluate(rows, read_force_csv(truth_path));
  std::printf("%zu frames, error %.2f, %.2f, %.2f mN rms; %.0f %% within the stated 95 %%\n", judged.frames,
              1e3 * judged.rmse_N.x(), 1e3 * judged.rmse_N.y(), 1e3 * judged.rmse_N.z(),
              100.0 * judged.inside_95.mean());
}

}  // namespace

/// A recording read, its force estimated frame by frame and held against a force sensor.
int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: 03_recording CATHETER.toml RUN.tracker.csv RUN.force.csv\n");
    return 2;
  }
  try {
    estimate_recording(argv[1], argv[2], argv[3]);
  } catch (const palpate::InputError& error) {  // bad input: one line that names file, line, field and value
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
