// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <palpate/reproduction/experiment_curves.hpp>
#include <palpate/reproduction/markdown.hpp>
#include <palpate/reproduction/parts.hpp>

namespace palpate::reproduction {
namespace {

constexpr AuroraReading kShown = AuroraReading::kWhite;
constexpr double kShownUntil_s = 11.0;  // of Figure 10: a swing; more is a smear
constexpr const char* kTracker = "Aurora with 0.28 mm, 0.17 deg of white noise an axis; first of the repeats. ";

std::vector<ExperimentRun> first_repeats(std::initializer_list<ExperimentId> ids, const Settings& settings) {
  std::vector<ExperimentJob> jobs;
  jobs.reserve(ids.size());
  for (const ExperimentId id : ids) jobs.push_back({.id = id, .reading = kShown});
  return run_experiments(jobs, settings);
}

constexpr std::array kAxes = {"Fx", "Fy", "Fz"};

std::string title_of(ExperimentId id) {
  return fmt::format("Experiment {}, k1,0 = {} 1/m", experiment(id).name, experiment(id).precurvature_per_m);
}

plot::Panel force_panel(const std::string& title, const std::string& y) {
  plot::Panel panel;
  panel.title = title;
  panel.x_label = "time [s]";
  panel.y_label = y;
  return panel;
}

plot::Figure error_figure(ExperimentId id, const ExperimentRun& run) {
  plot::Figure figure;
  figure.title = title_of(id) + ": errors";
  for (int axis = 0; axis < 3; ++axis) {
    plot::Panel panel = force_panel("", fmt::format("e({}) [mN]", kAxes[static_cast<std::size_t>(axis)]));
    for (const Estimator e :
         {Estimator::kPaperIaekf, Estimator::kPaperEkf, Estimator::kPaperIekf, Estimator::kIekf, Estimator::kSmoothed})
      panel.series.push_back(error_series(run, e, axis, kShownUntil_s));
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

/// Truth, the paper's IAEKF and ours, axis by axis.
void add_force_panels(const ExperimentRun& run, plot::Figure& figure) {
  for (int axis = 0; axis < 3; ++axis) {
    plot::Panel panel = force_panel("", fmt::format("{} [mN]", kAxes[static_cast<std::size_t>(axis)]));
    panel.series = {true_series(run, axis, "applied"), force_series(run, Estimator::kPaperIaekf, axis),
                    force_series(run, Estimator::kIekf, axis), force_series(run, Estimator::kSmoothed, axis)};
    figure.panels.push_back(std::move(panel));
  }
}

}  // namespace

Part make_figure9(const Settings& settings) {
  constexpr std::array kIds = {ExperimentId::kIa, ExperimentId::kIb};
  std::vector<ExperimentJob> jobs;
  jobs.reserve(kIds.size());
  for (const ExperimentId id : kIds) jobs.push_back({.id = id, .what = RunWhat::kTruth});
  const std::vector<ExperimentRun> runs = run_experiments(jobs, settings);
  plot::Figure figure;
  figure.title = "Applied forces, tip axes";
  for (std::size_t i = 0; i < runs.size(); ++i) {
    plot::Panel panel = force_panel(title_of(kIds[i]), "force [mN]");
    for (int axis = 0; axis < 3; ++axis)
      panel.series.push_back(true_series(runs[i], axis, kAxes[static_cast<std::size_t>(axis)]));
    figure.panels.push_back(std::move(panel));
  }
  return {
      .title = "Figure 9: applied forces of Experiment I",
      .markdown = fmt::format("The weight pulls with 127.8 mN throughout; its parts along the tip's axes change as "
                              "pulley and tip turn. (a): {}. (b): {}. The paper's course in time is not stated.\n\n{}",
                              experiment(kIds[0]).set_up, experiment(kIds[1]).set_up,
                              picture("figure9", "applied forces of Experiment I")),
      .figures = {{"figure9", figure}}};
}

Part make_figure10(const Settings& settings) {
  const std::vector<ExperimentRun> runs = first_repeats({ExperimentId::kIa, ExperimentId::kIb}, settings);
  return {.title = "Figure 10: errors in Experiment I",
          .markdown =
              std::string(kTracker) +
              "Ten of its thirty seconds. The paper's filters with its R beside ours. EKF and IEKF are one curve: a "
              "weight swung slowly at 40 Hz leaves nothing to iterate. IAEKF comes to believe in the frames, "
              "and follows their noise.\n\n" +
              picture("figure10a", "errors in Experiment I (a)") + "\n" +
              picture("figure10b", "errors in Experiment I (b)"),
          .figures = {{"figure10a", error_figure(ExperimentId::kIa, runs[0])},
                      {"figure10b", error_figure(ExperimentId::kIb, runs[1])}}};
}

Part make_figure12(const Settings& settings) {
  const std::vector<ExperimentRun> runs = first_repeats({ExperimentId::kIIa}, settings);
  plot::Figure figure;
  figure.title = title_of(ExperimentId::kIIa) + ": applied and estimated forces";
  add_force_panels(runs[0], figure);
  return {.title = "Figure 12: applied and estimated forces in Experiment II (a)",
          .markdown = std::string(kTracker) + "Band: 95 % of the smoothed estimate. Assumed: " +
                      std::string(experiment(ExperimentId::kIIa).set_up) +
                      ". The plate holds the tip, so most of what the water pushes goes into the plate and leaves the "
                      "shape as it is: no estimator sees that part, and along d1 there is little else.\n\n" +
                      picture("figure12", "applied and estimated forces in Experiment II (a)"),
          .figures = {{"figure12", figure}}};
}

Part make_figure14(const Settings& settings) {
  const std::vector<ExperimentRun> runs = first_repeats({ExperimentId::kIIb}, settings);
  plot::Figure force, stiffness;
  force.title = title_of(ExperimentId::kIIb) + ": force, stiffness estimated beside it";
  add_force_panels(runs[0], force);
  stiffness.title = title_of(ExperimentId::kIIb) + ": stiffness";
  for (int i = 0; i < 2; ++i) {
    plot::Panel panel = force_panel("", fmt::format("EI{} [mN m^2]", i + 1));
    panel.series = stiffness_series(runs[0], i);
    stiffness.panels.push_back(std::move(panel));
  }
  return {
      .title = "Figure 14: force and stiffness in Experiment II (b)",
      .markdown = std::string(kTracker) +
                  "No measurement here carries newtons, so force and stiffness are known up to a common factor. "
                  "The catheter file says 5 % for it, and 5 % it stays: that is the band of (b). The paper's Q lets "
                  "EI walk by 0.1 mN m^2 a step, 40 to 60 % of itself, with nothing to hold it: it drifts, in IAEKF "
                  "to nothing, and takes the force along. Assumed: " +
                  std::string(experiment(ExperimentId::kIIb).set_up) + ".\n\n" +
                  picture("figure14a", "force in Experiment II (b)") + "\n" +
                  picture("figure14b", "stiffness in Experiment II (b)"),
      .figures = {{"figure14a", force}, {"figure14b", stiffness}}};
}

}  // namespace palpate::reproduction
