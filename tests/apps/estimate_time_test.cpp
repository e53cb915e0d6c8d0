// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <tests/apps/app_fixture.hpp>

/// `palpate estimate` through time: smoothed, ahead, and by another law of motion. On 4 s against the beating wall.
namespace palpate {
namespace {

class EstimateThroughTime : public test::App {
 protected:
  /// Root mean square error of a column against the true force `frames_ahead` later, all axes, from 1 s on.
  double rms_error_N(const std::string& prefix, std::size_t frames_ahead = 0) const {
    const auto rows = table();
    const auto& truth = test::beating_recording().force_tip_N;
    double sum = 0.0;
    int count = 0;
    for (std::size_t i = 40; i + frames_ahead < rows.size(); ++i)
      for (int axis = 0; axis < 3; ++axis, ++count) {
        const std::string column = prefix + "f" + std::string(1, "xyz"[axis]) + "_tip_N";
        const double error = test::number(rows[i], column) - truth[i + frames_ahead](axis);
        sum += error * error;
      }
    return std::sqrt(sum / count);
  }
};

TEST_F(EstimateThroughTime, SmoothedIsNearerToTheTruthAndSaysSo) {
  EXPECT_EQ(summary()["smoothed"], false);
  const double online_N = rms_error_N("");
  const auto online = table();
  const auto said = summary({"--smooth"});
  EXPECT_EQ(said["smoothed"], true);
  EXPECT_LT(rms_error_N(""), 0.85 * online_N);
  const auto smoothed = table();
  ASSERT_EQ(smoothed.size(), online.size());
  for (std::size_t i = 0; i < online.size(); ++i) {
    for (const char* column : {"time_s", "status", "sensors_used", "nis", "dof", "evaluations"})
      EXPECT_EQ(smoothed[i].at(column), online[i].at(column)) << i << column;
    for (const char* column : {"sigma_x_N", "sigma_y_N", "sigma_z_N"})
      EXPECT_LE(test::number(smoothed[i], column), 1.0001 * test::number(online[i], column)) << i << column;
    const auto norm = [&](const char* x, const char* y, const char* z) {
      return std::hypot(test::number(smoothed[i], x), test::number(smoothed[i], y), test::number(smoothed[i], z));
    };
    EXPECT_NEAR(norm("fx_tip_N", "fy_tip_N", "fz_tip_N"), norm("fx_base_N", "fy_base_N", "fz_base_N"), 1e-8);
  }
  // Nothing comes after the last frame.
  for (const char* column : {"fx_tip_N", "fy_tip_N", "fz_tip_N", "sigma_z_N"})
    EXPECT_EQ(smoothed.back().at(column), online.back().at(column));
}

/// Two frames ahead: nearer to what comes than the present force is, with a larger sigma than that.
TEST_F(EstimateThroughTime, ForecastComesInColumnsOfItsOwn) {
  summary({"--forecast", "0.05"});
  const auto rows = table();
  ASSERT_TRUE(rows[0].contains("forecast_fz_tip_N"));
  EXPECT_LT(rms_error_N("forecast_", 2), rms_error_N("", 2));
  for (std::size_t i = 1; i < rows.size(); ++i)
    EXPECT_GT(test::number(rows[i], "forecast_sigma_z_N"), test::number(rows[i], "sigma_z_N")) << i;
  const auto judged = palpate({"evaluate", "--estimate", "e.csv", "--truth", "e.csv", "--json"});
  EXPECT_EQ(judged.exit_code, 0) << "further columns do not disturb a reader: " << judged.err;
  summary();
  EXPECT_FALSE(table()[0].contains("forecast_fz_tip_N"));
}

TEST_F(EstimateThroughTime, EveryForceModelFollowsTheWall) {
  for (const char* model : {"random_walk", "constant_velocity", "gauss_markov", "rhythm"}) {
    const auto said = summary({"--force-model", model});
    EXPECT_EQ(said["force_model"], model);
    EXPECT_EQ(said["frames_by_status"]["UPDATED"], 160) << model;
    EXPECT_LT(rms_error_N(""), 8e-3) << model << ": the bound of one frame is 6 mN over the axes";
  }
}

TEST_F(EstimateThroughTime, AStatedProcessNoiseNeedsItsLawOfMotion) {
  write_catheter("[base]", "[estimator]\nforce_rate_N_per_sqrt_s = 0.2\n[base]");
  EXPECT_NE(estimate_refusal().find("force_rate_N_per_sqrt_s = 0.2: expected force_model = \"random_walk\" beside it"),
            std::string::npos);
  write_catheter("[base]", "[estimator]\nforce_model = \"random_walk\"\nforce_rate_N_per_sqrt_s = 0.2\n[base]");
  EXPECT_EQ(summary()["force_model"], "random_walk");
}

}  // namespace
}  // namespace palpate
