// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/recording/toml_edit.hpp>
#include <palpate/recording/toml_table.hpp>
#include <palpate/simulation/scenario.hpp>

namespace palpate {

/// [tracker] of a scenario file.
struct ScenarioTracker {
  TrackerErrors errors;
  bool bias_given = false;
  bool noise_free = false;
  std::optional<double> noise_mm, noise_deg;  ///< of all sensors, instead of the catheter file's
  std::optional<int> dof;                     ///< of all sensors on the shaft that tell an orientation
};
ScenarioTracker read_tracker(const TomlTable& root);

/// Noise and kind of all sensors, as the scenario states them, in the text of the catheter file.
void put_sensors(const ScenarioTracker& tracker, const Catheter& catheter, TomlEdit& edit);

/// A tracker that makes no error; its rate stays.
void silence(Scenario& scenario);

}  // namespace palpate
