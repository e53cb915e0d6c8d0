// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <ostream>
#include <palpate/evaluation/evaluation.hpp>
#include <palpate/simulation/virtual_run.hpp>
#include <tests/shared_recordings.hpp>

/// Our virtual twin of a recording that another program made: the same force, catheter and noise, another draw. The
/// estimator must be as wrong on one as on the other.
namespace palpate {
namespace {

Scenario twin_of(const test::SharedRecording& recording, std::uint64_t seed) {
  ForceLoad load;
  for (std::size_t i = 0; i < recording.truth.times_s.size(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      load.force_N[static_cast<std::size_t>(axis)].points.emplace_back(recording.truth.times_s[i],
                                                                       recording.truth.force_tip_N[i](axis));
  return {.name = "twin",
          .catheter = recording.catheter,
          .duration_s = static_cast<double>(recording.frames.size()) / 40.0,
          .seed = seed,
          .load = std::move(load),
          .tracker = {.rate_hz = 40.0}};
}

Vector3d rmse_of(const test::SharedRecording& recording) {
  return evaluate(test::run(recording, {}).online, recording.truth).rmse_N;
}

class Twin : public ::testing::TestWithParam<const char*> {};

/// One recording is one draw of the noise: by the seeds here an RMSE scatters by 2 % (printed), theirs no less. Of our
/// side eight seeds are averaged, which leaves 0.7 %; their side is the one draw there is. 10 % is thus more than four
/// sigma of honest chance, and as much as a noise of 0.31 instead of 0.28 mm makes.
TEST_P(Twin, IsEstimatedAsWellAsTheRecording) {
  PALPATE_NEEDS_SHARED(test::kRecordings);
  const test::SharedRecording theirs = test::shared_recording(GetParam());
  const Vector3d their_rmse_N = rmse_of(theirs);
  constexpr int kSeeds = 8;
  Vector3d mean_square = Vector3d::Zero(), sum = Vector3d::Zero(), sum_of_squares = Vector3d::Zero();
  for (int seed = 1; seed <= kSeeds; ++seed) {
    test::SharedRecording ours = theirs;
    ours.frames = run_scenario(twin_of(theirs, static_cast<std::uint64_t>(seed))).frames;
    ASSERT_EQ(ours.frames.size(), theirs.frames.size());
    const Vector3d rmse_N = rmse_of(ours);
    mean_square += rmse_N.cwiseAbs2() / kSeeds;
    sum += rmse_N / kSeeds;
    sum_of_squares += rmse_N.cwiseAbs2() / kSeeds;
  }
  const Vector3d ours_N = mean_square.cwiseSqrt(), ratio = ours_N.cwiseQuotient(their_rmse_N);
  const Vector3d scatter = (sum_of_squares - sum.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt().cwiseQuotient(sum);
  fmt::print(
      "{:<14} RMSE [mN] theirs {:.3f} {:.3f} {:.3f}, ours {:.3f} {:.3f} {:.3f}; ratio {:.3f} {:.3f} {:.3f}; "
      "one seed scatters by {:.1f} {:.1f} {:.1f} %\n",
      GetParam(), 1e3 * their_rmse_N.x(), 1e3 * their_rmse_N.y(), 1e3 * their_rmse_N.z(), 1e3 * ours_N.x(),
      1e3 * ours_N.y(), 1e3 * ours_N.z(), ratio.x(), ratio.y(), ratio.z(), 100.0 * scatter.x(), 100.0 * scatter.y(),
      100.0 * scatter.z());
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(ratio(axis), 1.0, 0.10) << "axis " << axis;
}

/// The noise-free pose is theirs, to their noise: over 1200 frames their mean departure is 0.28 mm / sqrt(1200).
TEST_P(Twin, PosesAreTheirsToTheNoise) {
  PALPATE_NEEDS_SHARED(test::kRecordings);
  const test::SharedRecording theirs = test::shared_recording(GetParam());
  Scenario scenario = twin_of(theirs, 1);
  for (Sensor& sensor : scenario.catheter.sensors) sensor.noise_m.setConstant(1e-12), sensor.noise_rad = 1e-12;
  const VirtualRun ours = run_scenario(scenario);
  for (std::size_t k = 0; k < 2; ++k) {
    Vector3d mean = Vector3d::Zero(), square = Vector3d::Zero();
    const auto count = static_cast<double>(theirs.frames.size());
    for (std::size_t i = 0; i < theirs.frames.size(); ++i) {
      const Vector3d d = theirs.frames[i].readings[k].position_m - ours.frames[i].readings[k].position_m;
      mean += d / count, square += d.cwiseAbs2() / count;
    }
    EXPECT_LT(mean.cwiseAbs().maxCoeff(), 4.0 * 0.28e-3 / std::sqrt(count));
    for (const double s : square) EXPECT_NEAR(std::sqrt(s), 0.28e-3, 0.08 * 0.28e-3);
  }
}

INSTANTIATE_TEST_SUITE_P(Recordings, Twin, ::testing::Values("weight_planar", "heartbeat"),
                         [](const auto& test_case) { return std::string(test_case.param); });

}  // namespace
}  // namespace palpate
