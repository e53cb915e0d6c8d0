// SPDX-License-Identifier: Apache-2.0
#include "simulate_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <palpate/math/units.hpp>
#include <palpate/recording/text_table.hpp>

namespace palpate::app {

namespace {

struct Figures {
  std::size_t contacts = 0, frames_in_contact = 0;
  double largest_force_N = 0.0, at_s = 0.0;
};

Figures figures_of(const VirtualRun& run) {
  Figures figures;
  bool before = false;
  for (const Truth& truth : run.truth) {
    figures.contacts += truth.in_contact && !before ? 1 : 0;
    figures.frames_in_contact += truth.in_contact ? 1 : 0;
    before = truth.in_contact;
    const double force_N = truth.force_tip_N.norm();
    if (!(force_N > figures.largest_force_N)) continue;
    figures.largest_force_N = force_N;
    figures.at_s = truth.time_s;
  }
  return figures;
}

void print_events(const std::vector<ScenarioEvent>& events) {
  constexpr std::size_t kMost = 5;  // the file has them all; what is not stable is always said
  std::size_t said = 0;
  for (const ScenarioEvent& event : events) {
    if (!event.instability && said >= kMost) continue;
    if (!event.instability) ++said;
    event.instability ? fmt::print("  {}\n", event.what) : fmt::print("  {:.3f} s: {}\n", event.time_s, event.what);
  }
}

std::size_t instabilities(const std::vector<ScenarioEvent>& events) {
  return static_cast<std::size_t>(
      std::count_if(events.begin(), events.end(), [](const auto& e) { return e.instability; }));
}

}  // namespace

void SimulateReport::print() const {
  const Figures figures = figures_of(*run);
  fmt::print("{}: {} frames, {:g} s at {:g} Hz, seed {}\n", printable(scenario->name, 200), run->frames.size(),
             scenario->duration_s, scenario->tracker.rate_hz, scenario->seed);
  fmt::print("largest force {:.4f} N ({:.1f} g) at {:.3f} s\n", figures.largest_force_N,
             figures.largest_force_N * kGramsForcePerNewton, figures.at_s);
  fmt::print("contacts {}, in contact in {:.1f} % of the frames\n", figures.contacts,
             100.0 * static_cast<double>(figures.frames_in_contact) / static_cast<double>(run->truth.size()));
  fmt::print("events {}, instabilities {}\n", run->events.size(), instabilities(run->events));
  print_events(run->events);
  fmt::print("written: {}\n", fmt::join(files, " "));
  fmt::print("next: {}\n", command);
}

void SimulateReport::print_json() const {
  const Figures figures = figures_of(*run);
  nlohmann::json events = nlohmann::json::array();
  for (const ScenarioEvent& event : run->events)
    events.push_back({{"time_s", event.time_s}, {"what", event.what}, {"instability", event.instability}});
  const nlohmann::json json{{"scenario", scenario->name},
                            {"frames", run->frames.size()},
                            {"duration_s", scenario->duration_s},
                            {"rate_hz", scenario->tracker.rate_hz},
                            {"seed", scenario->seed},
                            {"contacts", figures.contacts},
                            {"frames_in_contact", figures.frames_in_contact},
                            {"largest_force_N", figures.largest_force_N},
                            {"largest_force_at_s", figures.at_s},
                            {"events", events},
                            {"instabilities", instabilities(run->events)},
                            {"files", files},
                            {"estimate_command", command}};
  fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

plot::Figure true_force_figure(const Scenario& scenario, const VirtualRun& run) {
  plot::Figure figure{.title = scenario.name};
  const char* labels[] = {"Fx along d1 [N]", "Fy along d2 [N]", "Fz along d3 [N]", "|F| [N]"};
  for (int axis = 0; axis < 4; ++axis) {
    plot::Series force{.label = axis == 0 ? "true force of the tissue on the tip" : ""};
    for (const Truth& truth : run.truth) {
      force.x.push_back(truth.time_s);
      force.y.push_back(axis < 3 ? truth.force_tip_N(axis) : truth.force_tip_N.norm());
    }
    figure.panels.push_back({.x_label = "time [s]", .y_label = labels[axis], .series = {std::move(force)}});
  }
  return figure;
}

}  // namespace palpate::app
