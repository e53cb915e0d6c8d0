// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <palpate/evaluation/evaluation.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/observer/force_observer.hpp>
#include <palpate/recording/scenario_file.hpp>
#include <palpate/simulation/virtual_run.hpp>

namespace {

/// A virtual experiment from its file: the tip meets a beating heart; the observer sees the tracker's poses alone.
void play(const char* path) {
  using namespace palpate;
  const ScenarioFile file = read_scenario_file(path, {.duration_s = 10.0});
  const VirtualRun run = run_scenario(file.scenario);
  for (const ScenarioEvent& event : run.events) {
    if (event.time_s < 4.0) std::printf("%6.2f s  %s\n", event.time_s, event.what.c_str());
  }

  ForceObserver observer(file.believed.catheter, file.believed.observer);
  std::vector<EstimateRow> rows;
  for (const TrackerFrame& frame : run.frames) rows.push_back(row_of(observer.update(frame)));

  ForceTrace truth;
  for (const Truth& moment : run.truth) {
    truth.times_s.push_back(moment.time_s);
    truth.force_tip_N.push_back(moment.force_tip_N);
  }
  const Evaluation judged = evaluate(rows, truth);
  std::printf("%zu frames, error %.2f, %.2f, %.2f mN rms, mean NEES %.2f (3 where the covariance is true)\n",
              judged.frames, 1e3 * judged.rmse_N.x(), 1e3 * judged.rmse_N.y(), 1e3 * judged.rmse_N.z(),
              judged.mean_nees);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: 07_simulate SCENARIO.toml\n");
    return 2;
  }
  try {
    play(argv[1]);
  } catch (const palpate::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
