// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <tests/force_motions.hpp>
#include <tests/observer/runs.hpp>
#include <tests/shared_recordings.hpp>

/// A force that jumps by up to 0.6 N every half second, seen through a tracker whose rows are sometimes off by tens of
/// millimetres: a jump must be followed, an outlier must not.
namespace palpate {
namespace {

/// What the truth says of one frame.
struct Judged {
  int since_jump = 0;  ///< frames; 0: the first frame of a new force, of the first one, too
  bool outlier = false;
  Vector3d bound_N;  ///< Cramer-Rao bound of this frame, both sensors good: sqrt(diag (J^T R^-1 J)^-1) at the truth
};

/// An honest row is off by 0.28 mm an axis; 3 mm is ten of these, and the least outlier is farther out.
constexpr double kFarOut_m = 3e-3;

class Jumps : public ::testing::TestWithParam<ForceMotion> {
 protected:
  void SetUp() override {
    PALPATE_NEEDS_SHARED(test::kRecordings);
    recording_ = test::shared_recording("jumps");
    silenced_ = recording_;
    ShapeModel shape(recording_.catheter, MeasurementKind::kPoses);
    for (std::size_t i = 0; i < recording_.frames.size(); ++i) judge(i, shape);
    run_ = test::run(recording_, options_);
  }

  void judge(std::size_t i, ShapeModel& shape) {
    const Vector3d& force_N = recording_.truth.force_tip_N[i];
    const TrackerFrame exact = test::exact_frame(recording_.catheter, force_N);
    Judged& judged = judged_.emplace_back();
    const bool same = i > 0 && force_N == recording_.truth.force_tip_N[i - 1];
    judged.since_jump = same ? judged_[i - 1].since_jump + 1 : 0;
    for (std::size_t k = 0; k < exact.readings.size(); ++k) {
      const Vector3d off_m = recording_.frames[i].readings[k].position_m - exact.readings[k].position_m;
      if (off_m.norm() < kFarOut_m) continue;
      judged.outlier = true;
      silenced_.frames[i].readings[k] = SensorReading{};
    }
    Measurement measurement;
    register_frame(recording_.catheter, exact, measurement);
    shape.select(measurement, 0b11U);
    Linearization at;
    ResidualMatrix R;
    ASSERT_TRUE(shape.linearize(force_N, at));
    shape.noise(R);
    const Matrix3d information = at.jacobian.transpose() * R.ldlt().solve(at.jacobian);
    judged.bound_N = information.inverse().diagonal().cwiseSqrt();
  }

  Eigen::Array3d error_N(std::size_t i) const {
    return (run_.estimates[i].force_tip_N - recording_.truth.force_tip_N[i]).array().abs();
  }
  static Eigen::Array3d sigma_N(const Estimate& e) { return e.covariance_tip_N2.diagonal().array().sqrt(); }
  bool inside_4_sigma(std::size_t i) const { return (error_N(i) <= 4.0 * sigma_N(run_.estimates[i])).all(); }

  ObserverOptions options_{.force_model = GetParam()};
  test::SharedRecording recording_, silenced_;  ///< as recorded; with the outliers MISSING
  std::vector<Judged> judged_;
  test::SharedRun run_;
};

/// The bound that the frames are judged by is the one that came with the recording.
TEST_P(Jumps, BoundIsTheOneMadeElsewhere) {
  Vector3d square = Vector3d::Zero();
  for (const Judged& judged : judged_) square += judged.bound_N.cwiseAbs2() / static_cast<double>(judged_.size());
  const Vector3d rms_N = square.cwiseSqrt();
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(rms_N(axis) / recording_.rms_bound_N(axis), 1.0, 1e-3);
}

/// Every frame but the first of a new force, unless a row of it is an outlier; whether the observer used it or not.
TEST_P(Jumps, ForceIsRightFromTheSecondFrameOn) {
  int good = 0, honest = 0, close = 0, right = 0;
  for (std::size_t i = 0; i < judged_.size(); ++i) {
    if (judged_[i].since_jump == 0 || judged_[i].outlier) continue;
    const bool inside = inside_4_sigma(i), near = (error_N(i) <= 5.0 * judged_[i].bound_N.array()).all();
    ++good;
    honest += inside ? 1 : 0;
    close += near ? 1 : 0;
    right += inside && near ? 1 : 0;
  }
  fmt::print("{} good frames: {} inside 4 sigma, {} closer than 5 bounds, {} both ({:.2f} %)\n", good, honest, close,
             right, 100.0 * right / good);
  EXPECT_GT(good, 1100);
  EXPECT_GE(right, 0.995 * good);
}

/// A frame explained from anywhere carries the covariance of one frame alone, whatever was believed before.
TEST_P(Jumps, CovarianceIsHonestAtTheJump) {
  int jumps = 0, honest = 0, noticed = 0;
  for (std::size_t i = 1; i < judged_.size(); ++i) {
    if (judged_[i].since_jump != 0) continue;
    const bool used = run_.estimates[i].used != 0;
    ++jumps;
    honest += !used || inside_4_sigma(i) ? 1 : 0;
    noticed += run_.estimates[i].jumped ? 1 : 0;
  }
  fmt::print("{} jumps: {} honest in their first frame, {} noticed in it\n", jumps, honest, noticed);
  EXPECT_EQ(jumps, 59);
  EXPECT_GE(honest, 0.99 * jumps);
  EXPECT_GE(noticed, 0.99 * jumps);
}

/// Against the run in which the outlying rows are MISSING; at the outlier itself and in every frame after it.
TEST_P(Jumps, OutliersDoNotMoveTheForce) {
  const test::SharedRun without = test::run(silenced_, options_);
  int outliers = 0;
  double farthest = 0.0;
  for (std::size_t i = 0; i < judged_.size(); ++i) {
    outliers += judged_[i].outlier ? 1 : 0;
    const Estimate &found = run_.estimates[i], &expected = without.estimates[i];
    const Eigen::Array3d moved = (found.force_tip_N - expected.force_tip_N).array().abs() / sigma_N(expected);
    farthest = std::max(farthest, moved.maxCoeff());
  }
  fmt::print("{} frames with outliers; they move the force by {:.2g} sigma at most\n", outliers, farthest);
  EXPECT_GE(outliers, 20);
  EXPECT_LT(farthest, 3.0);
}

/// No good row is blamed for a jump.
TEST_P(Jumps, NoGoodRowIsRefused) {
  for (std::size_t i = 0; i < judged_.size(); ++i) {
    if (judged_[i].outlier) continue;
    EXPECT_EQ(run_.estimates[i].used, 0b11U) << "frame " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Law, Jumps,
                         ::testing::Values(ForceMotion::kConstantVelocity, ForceMotion::kRandomWalk,
                                           ForceMotion::kRhythm),
                         [](const auto& test_case) { return std::string(test::name_of(test_case.param)); });

}  // namespace
}  // namespace palpate
