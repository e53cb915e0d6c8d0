// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <palpate/reproduction/experiment_summary.hpp>
#include <palpate/reproduction/parts.hpp>

namespace palpate::reproduction {
namespace {

ExperimentSummary played(ExperimentId id, AuroraReading reading, double stiffness_error = 0.0) {
  return summarise(run_experiments(repeats_of(id, reading, stiffness_error, RunWhat::kOurIekf), {}));
}

/// Read off the printed page, apart from the source.
TEST(Experiments, ThePapersFiguresAreThosePrinted) {
  const auto& a = experiment(ExperimentId::kIa);
  EXPECT_EQ(a.precurvature_per_m, 39.99);
  EXPECT_EQ(experiment(ExperimentId::kIb).precurvature_per_m, 24.57);
  EXPECT_EQ(experiment(ExperimentId::kIIa).precurvature_per_m, 19.41);
  EXPECT_EQ(a.paper[2].mean_N, Vector3d(6.01e-6, 5.03e-5, 1.7e-3));
  EXPECT_EQ(a.paper[0].sigma_N, Vector3d(0.002, 5.8e-3, 0.0202));
  EXPECT_EQ(experiment(ExperimentId::kIb).paper[2].sigma_N, Vector3d(1.06e-5, 1.65e-4, 0.003));
  EXPECT_EQ(experiment(ExperimentId::kIb).paper[1].mean_N, Vector3d(4.86e-4, 2.82e-4, 7.65e-4));
  EXPECT_EQ(experiment(ExperimentId::kIIa).paper[0].mean_N, Vector3d(9.4e-3, 0.0181, 0.0375));
  EXPECT_EQ(experiment(ExperimentId::kIIa).paper[2].sigma_N, Vector3d(5.55e-5, 2.70e-4, 0.0019));
  EXPECT_EQ(experiment(ExperimentId::kIIb).paper[2].mean_N.z(), 0.0035);
  EXPECT_EQ(experiment(ExperimentId::kIIb).paper[1].sigma_N.z(), 0.0050);
}

/// A weight pulls with m g, whichever way: 13.03 g are 127.8 mN. In plane nothing goes along d1.
TEST(Experiments, TheWeightPullsWithItsWeight) {
  for (const ExperimentId id : {ExperimentId::kIa, ExperimentId::kIb}) {
    const ExperimentRun run = run_experiment({.id = id, .what = RunWhat::kTruth});
    ASSERT_EQ(run.truth_N.size(), 1200U);
    for (const Vector3d& force : run.truth_N) EXPECT_NEAR(force.norm(), 0.01303 * 9.80665, 1e-9);
    for (const ScenarioEvent& event : run.events) EXPECT_FALSE(event.instability) << event.what;
    if (id != ExperimentId::kIa) continue;
    for (const Vector3d& force : run.truth_N) EXPECT_NEAR(force.x(), 0.0, 1e-9);
  }
}

/// The plate presses against the tip with some tens of mN, once it is there, and the shaft does not buckle.
TEST(Experiments, ThePlateKeepsPressing) {
  for (const ExperimentId id : {ExperimentId::kIIa, ExperimentId::kIIb}) {
    const ExperimentRun run = run_experiment({.id = id, .what = RunWhat::kTruth});
    for (std::size_t i = run.first; i < run.truth_N.size(); ++i) {
      EXPECT_LT(run.truth_N[i].z(), -5e-3) << run.times_s[i];
      EXPECT_LT(run.truth_N[i].norm(), 0.2) << run.times_s[i];
    }
    for (const ScenarioEvent& event : run.events) EXPECT_FALSE(event.instability) << event.what;
  }
}

/// Online, with the defaults, the stated accuracy being white noise.
TEST(Experiments, WeightsAreFeltAsThePaperSaysOrBetter) {
  for (const ExperimentId id : {ExperimentId::kIa, ExperimentId::kIb}) {
    const AxialVerdict verdict = axial_verdict(id, played(id, AuroraReading::kWhite), Estimator::kIekf);
    EXPECT_LE(verdict.mean_N, verdict.paper_mean_N);
    EXPECT_LE(verdict.sigma_N, verdict.paper_sigma_N);
  }
}

/// Likewise, smoothed, with the pace of the pushes told; the mean online as well.
TEST(Experiments, PushesAreFeltAsThePaperSaysOrBetter) {
  const ExperimentSummary summary = played(ExperimentId::kIIa, AuroraReading::kWhite);
  const AxialVerdict verdict = axial_verdict(ExperimentId::kIIa, summary, Estimator::kStatedSmoothed);
  EXPECT_TRUE(verdict.mean_met() && verdict.sigma_met()) << verdict.mean_N << " " << verdict.sigma_N;
  EXPECT_TRUE(axial_verdict(ExperimentId::kIIa, summary, Estimator::kIekf).mean_met());
}

/// CFSE: at an Aurora's scatter at rest both figures are met; read as white noise, the stated accuracy forbids the
/// paper's sigma, and ours is near the bound.
TEST(Experiments, ForceBesideStiffnessIsFeltAsWellAsCanBe) {
  const ExperimentSummary at_rest = played(ExperimentId::kIIb, AuroraReading::kAtRest);
  const AxialVerdict smoothed = axial_verdict(ExperimentId::kIIb, at_rest, Estimator::kSmoothed);
  EXPECT_TRUE(smoothed.mean_met() && smoothed.sigma_met()) << smoothed.mean_N << " " << smoothed.sigma_N;
  const ExperimentSummary white = played(ExperimentId::kIIb, AuroraReading::kWhite);
  const AxialVerdict bounded = axial_verdict(ExperimentId::kIIb, white, Estimator::kStatedSmoothed);
  EXPECT_TRUE(bounded.mean_met());
  EXPECT_FALSE(bounded.sigma_in_reach());
  EXPECT_LE(bounded.sigma_N, 1.15 * bounded.bound_N);
}

/// A stiffer shaft is not seen, but the interval carries it.
TEST(Experiments, AWrongStiffnessStaysInsideTheInterval) {
  const ExperimentSummary wrong = played(ExperimentId::kIIb, AuroraReading::kAtRest, 0.05);
  EXPECT_GT(wrong.error(Estimator::kIekf).mean_N.z(), 2e-3);
  EXPECT_GE(wrong.inside_95_online.z(), 0.9);
}

TEST(Experiments, ThePicturesHaveTheirCurves) {
  for (const auto make : {make_figure9, make_figure10, make_figure12, make_figure14}) {
    const Part part = make({});
    EXPECT_FALSE(part.figures.empty()) << part.title;
    for (const NamedFigure& figure : part.figures) {
      EXPECT_NE(part.markdown.find(figure.name + ".svg"), std::string::npos) << figure.name;
      for (const plot::Panel& panel : figure.figure.panels)
        for (const plot::Series& series : panel.series) {
          EXPECT_GE(series.y.size(), 200U);
          EXPECT_EQ(series.y.size(), series.x.size());
        }
    }
  }
}

}  // namespace
}  // namespace palpate::reproduction
