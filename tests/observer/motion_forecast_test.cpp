// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <tests/estimation/motions.hpp>
#include <tests/observer/laws.hpp>

/// What the observer says of the frames to come, under every law of motion.
namespace palpate {
namespace {

/// Contact that is made or lost between two frames nobody foresees: the force leaps by 30 mN or more, where the wall
/// alone moves it by 10 mN a frame at most.
constexpr double kLeap_N = 0.03;
constexpr double kGrowing = 1.0 - 1e-3;

/// Of forecasts, against what came.
struct Honesty {
  int frames = 0;
  double mean_nees = 0.0;
  Eigen::Array3d inside_3_sigma = Eigen::Array3d::Zero();

  void add(const ForceGaussian& ahead, const Vector3d& truth_N) {
    const Vector3d error_N = ahead.mean_N - truth_N;
    ++frames;
    mean_nees += normalised_error_squared(error_N, ahead.covariance_N2);
    inside_3_sigma += (error_N.array().abs() <= 3.0 * test::sigma_N(ahead.covariance_N2)).cast<double>();
  }
  void print(const std::string& law) const {
    fmt::print("{:<24} forecast NEES {:.3f}, in 3 sigma {:.2f} {:.2f} {:.2f} %\n", law, mean_nees,
               100.0 * inside_3_sigma.x(), 100.0 * inside_3_sigma.y(), 100.0 * inside_3_sigma.z());
  }
};

class EveryForecast : public ::testing::TestWithParam<test::Law> {
 protected:
  /// The law's own motion, from rest; its disturbance is added like any other.
  test::Moved drawn_from_the_law(const ObserverOptions& options, int frames, unsigned seed) const {
    MotionOptions law = options.motion();
    law.disturbance_rms_N.setZero();
    const MotionModel model(law);
    test::Draws draws(seed);
    test::DrawnMotion motion(model, draws);
    MotionStep step;
    step.dt_s = test::kStep_s;
    step.drive.setConstant(options.stated_drive());
    std::vector<Vector3d> tissue_N;
    for (int k = 0; k < frames; ++k) {
      motion.advance(step);
      tissue_N.push_back(motion.reported_N());
    }
    return test::with_disturbance(catheter_, options, std::move(tissue_N), seed + 1000U);
  }

  /// Each frame's force as it was foreseen in the frame before; the first second is for finding in. Steps of the truth
  /// that are larger than `leap_N` are left out.
  Honesty forecast(const ObserverOptions& options, const test::Moved& moved, double leap_N) const {
    ForceObserver observer(catheter_, options);
    Honesty out;
    for (std::size_t i = 0; i < moved.frames.size(); ++i) {
      const bool judged = i >= 40 && (moved.tissue_N[i] - moved.tissue_N[i - 1]).norm() <= leap_N;
      if (judged) out.add(observer.forecast(test::kStep_s), moved.tissue_N[i]);
      observer.update(moved.frames[i]);
    }
    out.mean_nees /= out.frames;
    out.inside_3_sigma /= out.frames;
    return out;
  }

  const Catheter catheter_ = test::two_sensors();
  const ObserverOptions options_ = test::options_of(GetParam());
};

/// To a rounding of the sums over the components.
TEST_P(EveryForecast, ForecastOfNowIsTheEstimate) {
  ForceObserver observer(catheter_, options_);
  for (const TrackerFrame& frame : test::faulty_frames(catheter_)) {
    const Estimate e = observer.update(frame);
    const ForceGaussian now = observer.forecast(0.0);
    EXPECT_LT((now.mean_N - e.force_tip_N).norm(), 1e-14) << e.time_s << " s";
    EXPECT_LT((now.covariance_N2 - e.covariance_tip_N2).norm(), 1e-14) << e.time_s << " s";
    EXPECT_EQ(observer.forecast(options_.forecast_s).mean_N, e.forecast.mean_N);
  }
}

/// No horizon is better known than now, and up to a few frames ahead each is less known than the one before. Farther
/// ahead that ends: a rhythm comes back to where it was seen. An axis that has reached the limit of belief takes a
/// little of the variance of those that depend on it: a tenth of a percent.
TEST_P(EveryForecast, ForecastSigmaGrowsWithTheHorizon) {
  ForceObserver observer(catheter_, options_);
  for (const TrackerFrame& frame : test::faulty_frames(catheter_)) {
    const Estimate e = observer.update(frame);
    const Eigen::Array3d now = test::sigma_N(e.covariance_tip_N2);
    Eigen::Array3d last = now;
    for (const double ahead_s : {0.025, 0.05, 0.1, 0.3, 1.0, 3.0, 60.0}) {
      const Eigen::Array3d sigma = test::sigma_N(observer.forecast(ahead_s).covariance_N2);
      const Eigen::Array3d& least = ahead_s <= 0.1 ? last : now;
      EXPECT_TRUE((sigma >= kGrowing * least).all()) << e.time_s << " s, " << ahead_s << " s ahead\n"
                                                     << sigma.transpose() << "\n"
                                                     << least.transpose();
      last = sigma;
    }
  }
}

/// The wall's law is none of these, so asked is what a user relies on: of all frames, leaps included, 99 % within 3
/// sigma on every axis; without the leaps the mean squared normalised error at most the 3 + 20 % of the estimates
/// themselves, and not so small that sigma would be 2.5 times too wide. It is somewhat too wide: the process noise
/// expects the next contact while the force rests. A Gauss-Markov force is not adapted, its stated spread is wide.
TEST_P(EveryForecast, OneStepForecastsAreHonestOnTheBeatingWall) {
  const test::Moved moved = test::on_the_beating_wall(catheter_, options_, 2000, 7);
  const Honesty all = forecast(options_, moved, 1e3), calm = forecast(options_, moved, kLeap_N);
  all.print(GetParam().name());
  calm.print(GetParam().name() + ", calm");
  EXPECT_GE(all.frames - calm.frames, 8) << "contact is lost and made five times in 50 s";
  EXPECT_GE(all.inside_3_sigma.minCoeff(), 0.99);
  EXPECT_LE(calm.mean_nees, 3.6);
  EXPECT_GE(calm.mean_nees, GetParam().motion == ForceMotion::kGaussMarkov ? 0.0 : 3.0 / (2.5 * 2.5));
}

class EveryStatedLaw : public EveryForecast {};

/// Mean of 20 runs; a run's average is a draw of its own, so the scatter of the runs says how well the mean is known:
/// within 2.6 standard errors (99 %) of 3. A rhythm is found from the data, and no law of given numbers: see above.
TEST_P(EveryStatedLaw, OneStepForecastsAreHonestOnForcesDrawnFromIt) {
  constexpr int kRuns = 20;
  ObserverOptions options = options_;
  if (GetParam().motion == ForceMotion::kRandomWalk) options.force_rate_N_per_sqrt_s = 0.03;
  if (GetParam().motion == ForceMotion::kConstantVelocity) options.force_acceleration_N_per_s_sqrt_s = 0.1;
  if (GetParam().motion == ForceMotion::kGaussMarkov) options.initial_force_sigma_N = 0.05;
  Eigen::ArrayXd nees(kRuns);
  for (int run = 0; run < kRuns; ++run)
    nees(run) = forecast(options, drawn_from_the_law(options, 160, 100U + static_cast<unsigned>(run)), 1e3).mean_nees;
  const double error = std::sqrt((nees - nees.mean()).square().sum() / (kRuns - 1) / kRuns);
  fmt::print("{:<24} forecast NEES {:.3f} +- {:.3f}\n", GetParam().name(), nees.mean(), error);
  EXPECT_NEAR(nees.mean(), 3.0, 2.6 * error);
  EXPECT_LT(error, 0.2) << "else the band says nothing";
}

std::vector<test::Law> every_stated_law() {
  std::vector<test::Law> laws = test::every_law();
  std::erase_if(laws, [](const test::Law& law) { return law.motion == ForceMotion::kRhythm; });
  return laws;
}

INSTANTIATE_TEST_SUITE_P(Law, EveryStatedLaw, ::testing::ValuesIn(every_stated_law()),
                         [](const auto& test_case) { return test_case.param.name(); });
INSTANTIATE_TEST_SUITE_P(Law, EveryForecast, ::testing::ValuesIn(test::every_law()),
                         [](const auto& test_case) { return test_case.param.name(); });

}  // namespace
}  // namespace palpate
