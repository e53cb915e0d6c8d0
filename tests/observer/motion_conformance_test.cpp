// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <tests/observer/allocation_counter.hpp>
#include <tests/observer/laws.hpp>

/// What the observer must do under every law of motion, with and without a declared disturbance.
namespace palpate {
namespace {

class EveryLaw : public ::testing::TestWithParam<test::Law> {
 protected:
  const Catheter catheter_ = test::two_sensors();
  const ObserverOptions options_ = test::options_of(GetParam());
};

void expect_definite(const Matrix3d& P, const char* what, const Estimate& e) {
  EXPECT_EQ(P, P.transpose()) << what << ", " << e.time_s << " s";
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix3d>(P).eigenvalues()(0), 0.0) << what << ", " << e.time_s << " s";
}

TEST_P(EveryLaw, NoLoadGivesNoForceWithinFourSigma) {
  for (const Catheter& catheter : {test::two_sensors(), test::mixed_sensors()}) {
    const auto recording = simulate_tracker(catheter, test::constant_force(Vector3d::Zero()), {.duration_s = 5.0});
    for (const Estimate& e : test::run(catheter, options_, recording.frames)) {
      EXPECT_EQ(e.status, EstimateStatus::kUpdated);
      EXPECT_TRUE((e.force_tip_N.array().abs() <= 4.0 * test::sigma_N(e.covariance_tip_N2)).all())
          << e.time_s << " s: " << e.force_tip_N.transpose();
    }
  }
}

TEST_P(EveryLaw, CovariancesAreSymmetricPositiveDefiniteAlways) {
  for (const Estimate& e : test::run(catheter_, options_, test::faulty_frames(catheter_))) {
    expect_definite(e.covariance_tip_N2, "estimate", e);
    expect_definite(e.forecast.covariance_N2, "forecast", e);
    if (e.lagged.age_frames >= 0) expect_definite(e.lagged.force.covariance_N2, "lagged", e);
  }
}

/// From frame to frame at first. Later a rhythm comes back to where it was seen, and an axis that has reached the limit
/// of belief takes a little of the variance of those that depend on it (0.1 %): never below what it was before.
TEST_P(EveryLaw, SigmaGrowsWhileFramesAreHeld) {
  const std::vector<Estimate> all = test::run(catheter_, options_, test::faulty_frames(catheter_));
  const Eigen::Array3d before = test::sigma_N(all[test::kBlindFrom - 1].covariance_tip_N2);
  for (std::size_t i = test::kBlindFrom; i < test::kBlindTo; ++i) {
    EXPECT_EQ(all[i].status, EstimateStatus::kHeld);
    const Eigen::Array3d last = test::sigma_N(all[i - 1].covariance_tip_N2),
                         now = test::sigma_N(all[i].covariance_tip_N2);
    const bool early = i < test::kBlindFrom + 4;
    EXPECT_TRUE((now >= (1.0 - 1e-3) * (early ? last : before)).all())
        << i << ": " << now.transpose() << " after " << last.transpose();
  }
  EXPECT_TRUE(
      (test::sigma_N(all[test::kBlindTo].covariance_tip_N2) < test::sigma_N(all[test::kBlindTo - 1].covariance_tip_N2))
          .all());
}

/// The frames so far, smoothed from the end; a frame whose time cannot be is none. Tolerances as for the smoothers
/// themselves: both subtract covariances, of sigmas that differ by a factor of a hundred from axis to axis.
TEST_P(EveryLaw, LaggedForceIsTheSmoothedOneOfTheFramesSoFar) {
  ForceObserver observer(catheter_, options_);
  RecordingSmoother smoother(observer.motion().model(), observer.motion().parameters().prior());
  std::vector<double> times_s;
  const std::vector<TrackerFrame> frames = test::faulty_frames(catheter_);
  for (const TrackerFrame& frame : frames) {
    const Estimate e = observer.update(frame);
    if (e.time <= FrameTime::kResynchronised) {
      smoother.push(observer.motion().step(), observer.motion().belief());
      times_s.push_back(frame.time_s);
    }
    const auto age = static_cast<std::size_t>(e.lagged.age_frames);
    ASSERT_EQ(age, std::min<std::size_t>(times_s.size() - 1, test::kLag));
    if (frame.number % 7 != 0) continue;
    const std::size_t frame_then = times_s.size() - 1 - age;
    const ForceGaussian expected = smoother.smooth()[frame_then].force;
    const Vector3d sigma = test::sigma_N(expected.covariance_N2);
    const Matrix3d scale = sigma.cwiseInverse().asDiagonal();
    EXPECT_EQ(e.lagged.time_s, times_s[frame_then]);
    EXPECT_LT((scale * (e.lagged.force.mean_N - expected.mean_N)).norm(), 1e-5) << frame.number;
    EXPECT_LT((scale * (e.lagged.force.covariance_N2 - expected.covariance_N2) * scale).norm(), 1e-5) << frame.number;
  }
}

/// Squared errors of the same instants, as they were estimated online and with test::kLag frames more.
TEST_P(EveryLaw, LaggedForceIsMoreAccurateThanTheOnlineOne) {
  const test::Moved moved = test::on_the_beating_wall(catheter_, options_, 800, 6);
  const std::vector<Estimate> all = test::run(catheter_, options_, moved.frames);
  Vector3d online = Vector3d::Zero(), lagged = Vector3d::Zero();
  for (std::size_t i = 40 + test::kLag; i < all.size(); ++i) {
    ASSERT_EQ(all[i].lagged.time_s, all[i - test::kLag].time_s);
    online += (all[i - test::kLag].force_tip_N - moved.tissue_N[i - test::kLag]).cwiseAbs2();
    lagged += (all[i].lagged.force.mean_N - moved.tissue_N[i - test::kLag]).cwiseAbs2();
  }
  const Vector3d ratio = lagged.cwiseQuotient(online).cwiseSqrt();
  fmt::print("{:<24} RMSE {} frames later / online: {:.3f} {:.3f} {:.3f}\n", GetParam().name(), test::kLag, ratio.x(),
             ratio.y(), ratio.z());
  EXPECT_LT(ratio.maxCoeff(), 1.0);
}

TEST_P(EveryLaw, TwoRunsAgreeBitForBit) {
  const std::vector<TrackerFrame> frames = test::faulty_frames(catheter_);
  const std::vector<Estimate> first = test::run(catheter_, options_, frames);
  const std::vector<Estimate> second = test::run(catheter_, options_, frames);
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_TRUE(test::same_state(first[i], second[i]));
    EXPECT_EQ(first[i].forecast.mean_N, second[i].forecast.mean_N);
    EXPECT_EQ(first[i].forecast.covariance_N2, second[i].forecast.covariance_N2);
    EXPECT_EQ(first[i].lagged.force.mean_N, second[i].lagged.force.mean_N);
    EXPECT_EQ(first[i].lagged.force.covariance_N2, second[i].lagged.force.covariance_N2);
  }
}

TEST_P(EveryLaw, NothingIsAllocated) {
  const std::vector<TrackerFrame> frames = test::faulty_frames(catheter_);
  ForceObserver observer(catheter_, options_);
  for (const TrackerFrame& frame : frames) {
    std::size_t allocations = 0;
    {
      const test::CountAllocations count;
      observer.update(frame);
      observer.forecast(0.5);
      allocations = count.so_far();
    }
    EXPECT_EQ(allocations, 0U) << "frame " << frame.number;
  }
}

INSTANTIATE_TEST_SUITE_P(Law, EveryLaw, ::testing::ValuesIn(test::every_law()),
                         [](const auto& test_case) { return test_case.param.name(); });

}  // namespace
}  // namespace palpate
