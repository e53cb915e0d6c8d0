// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/plot/plot.hpp>
#include <palpate/recording/scenario_file.hpp>
#include <palpate/simulation/virtual_run.hpp>
#include <string>
#include <vector>

namespace palpate::app {

/// What a virtual experiment left.
struct SimulateReport {
  const Scenario* scenario = nullptr;
  const VirtualRun* run = nullptr;
  std::vector<std::string> files;  ///< written, in this order
  std::string command;             ///< that estimates the force from them

  void print() const;
  void print_json() const;
};

/// The true force over time: its three tip components and its size.
plot::Figure true_force_figure(const Scenario& scenario, const VirtualRun& run);

}  // namespace palpate::app
