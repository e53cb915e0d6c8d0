// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <palpate/reproduction/experiment_bounds.hpp>
#include <tests/shared_recordings.hpp>

namespace palpate::reproduction {
namespace {

/// bounds.json was computed by another program, with a rod solver of its own.
TEST(ExperimentBounds, OfOneFrameAgreeWithAnotherProgram) {
  PALPATE_NEEDS_SHARED(test::kRecordings);
  for (const char* name : {"weight_planar", "heartbeat"}) {
    const test::SharedRecording recording = test::shared_recording(name);
    const std::vector<Vector3d>& force = recording.truth.force_tip_N;
    const ForceBounds bounds =
        force_bounds(force_information(recording.catheter, recording.frames, force), force, 1.0 / 40.0, 0);
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(bounds.frame_N(axis) / recording.rms_bound_N(axis), 1.0, 0.01) << name << " axis " << axis;
  }
}

/// A force that swings as A sin(w t), seen with white noise.
struct Swing {
  static constexpr double kFrame_s = 0.025, kAmplitude_N = 0.1, kOmega = 2.0, kNoise_N = 5e-3;
  static constexpr int kFrames = 400;
  std::vector<Vector3d> force_N;
  std::vector<Matrix3d> information;

  Swing() : information(kFrames, Matrix3d::Identity() / (kNoise_N * kNoise_N)) {
    for (int i = 0; i < kFrames; ++i)
      force_N.emplace_back(Vector3d::Constant(kAmplitude_N * std::sin(kOmega * i * kFrame_s)));
  }
};

/// The same posterior in one go, without filter or smoother: covariance of the integrated Wiener process,
///   K(s, t) = s0^2 + v0^2 s t + q^2 m^2 (3 M - m) / 6,   m, M = min, max of s, t,
/// with q^2 = A^2 w^4 dt / 2 for a sine; P = K - K (K + N)^-1 K. Prior as MotionOptions: 0.3 N, 1 N/s.
Eigen::VectorXd posterior_variances() {
  constexpr int n = Swing::kFrames;
  const double q2 = std::pow(Swing::kAmplitude_N, 2) * std::pow(Swing::kOmega, 4) * Swing::kFrame_s / 2.0;
  Eigen::MatrixXd K(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double m = std::min(i, j) * Swing::kFrame_s, M = std::max(i, j) * Swing::kFrame_s;
      K(i, j) = 0.09 + m * M + q2 * m * m * (3.0 * M - m) / 6.0;
    }
  const Eigen::MatrixXd S = K + std::pow(Swing::kNoise_N, 2) * Eigen::MatrixXd::Identity(n, n);
  return (K - K * S.llt().solve(K)).diagonal();
}

TEST(ExperimentBounds, WithALawOfMotionAreThoseOfTheWholePosterior) {
  const Swing swing;
  const ForceBounds bounds = force_bounds(swing.information, swing.force_N, Swing::kFrame_s, 0);
  const double expected = std::sqrt(posterior_variances().mean());
  EXPECT_NEAR(bounds.smoothed_N.x() / expected, 1.0, 0.02);
  EXPECT_NEAR(bounds.frame_N.z(), Swing::kNoise_N, 1e-12);
  EXPECT_NEAR(bounds.mean_N.z(), Swing::kNoise_N / std::sqrt(Swing::kFrames), 1e-12);
  EXPECT_LT(bounds.smoothed_N.y(), bounds.online_N.y());
  EXPECT_LT(bounds.online_N.y(), bounds.frame_N.y());
}

}  // namespace
}  // namespace palpate::reproduction
