// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <tests/apps/app_fixture.hpp>

namespace palpate {
namespace {

constexpr const char* kHeader =
    "time_s,fx_tip_N,fy_tip_N,fz_tip_N,sigma_x_N,sigma_y_N,sigma_z_N,cov_xy_N2,cov_xz_N2,cov_yz_N2,"
    "fx_base_N,fy_base_N,fz_base_N,status,sensors_used,nis,dof,evaluations";

/// The main job, on what the demo program writes: 30 s at 40 Hz, 2 % missing, 0.5 % outliers.
class Estimate : public test::App {
 protected:
  void SetUp() override {
    test::App::SetUp();
    const test::ProgramRun made = test::run_program(PALPATE_DEMO, {"."}, path(""));
    ASSERT_EQ(made.exit_code, 0) << made.err;
  }
  test::ProgramRun estimate_demo(const Arguments& more = {}) const {
    Arguments arguments{"estimate", "--catheter", "demo.catheter.toml", "demo.tracker.csv", "--out", "e.csv"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return palpate(arguments);
  }
  nlohmann::json evaluate_demo() const {
    const auto run = palpate({"evaluate", "--estimate", "e.csv", "--truth", "demo.force.csv", "--json"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(run.err, "");
    return nlohmann::json::parse(run.out, nullptr, false);
  }
};

std::size_t total(const nlohmann::json& counts) {
  std::size_t sum = 0;
  for (const auto& count : counts) sum += count.get<std::size_t>();
  return sum;
}

TEST_F(Estimate, EveryFrameIsARowWithAConsistentSigma) {
  const auto run = estimate_demo();
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_EQ(run.err, "");
  EXPECT_TRUE(run.out.starts_with("1200 frames, 0.000 s to 29.975 s, iekf on poses, force model constant_velocity\n"))
      << run.out;
  EXPECT_TRUE(run.out.ends_with("written: e.csv\n")) << run.out;
  EXPECT_EQ(run.out.find_first_of("\r\x1b"), std::string::npos);  // a pipe gets no progress and no colours
  const std::string text = contents(path("e.csv"));
  EXPECT_EQ(text.substr(0, text.find('\n')), kHeader);
  const auto rows = table();
  ASSERT_EQ(rows.size(), 1200u);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& row = rows[i];
    const auto value = [&](const char* column) { return test::number(row, column); };
    EXPECT_NEAR(value("time_s"), 0.025 * static_cast<double>(i), 1e-9);
    Matrix3d P;
    const double xx = std::pow(value("sigma_x_N"), 2), yy = std::pow(value("sigma_y_N"), 2),
                 zz = std::pow(value("sigma_z_N"), 2);
    P << xx, value("cov_xy_N2"), value("cov_xz_N2"), value("cov_xy_N2"), yy, value("cov_yz_N2"), value("cov_xz_N2"),
        value("cov_yz_N2"), zz;
    EXPECT_GT(P.determinant(), 0.0) << "row " << i;
    const Vector3d tip(value("fx_tip_N"), value("fy_tip_N"), value("fz_tip_N"));
    const Vector3d base(value("fx_base_N"), value("fy_base_N"), value("fz_base_N"));
    EXPECT_NEAR(tip.norm(), base.norm(), 1e-8) << "row " << i;
  }
}

TEST_F(Estimate, SummaryAddsUp) {
  const auto run = estimate_demo({"--json"});
  const auto summary = nlohmann::json::parse(run.out, nullptr, false);
  ASSERT_TRUE(summary.is_object()) << run.out;
  EXPECT_EQ(summary["frames"], 1200);
  EXPECT_EQ(total(summary["frames_by_status"]), 1200u);
  const std::string tracker = contents(path("demo.tracker.csv"));
  std::size_t missing = 0;
  for (auto at = tracker.find("MISSING"); at != std::string::npos; at = tracker.find("MISSING", at + 1)) ++missing;
  EXPECT_EQ(summary["readings_not_used"]["missing"], missing);
  EXPECT_EQ(total(summary["rejected_rows"]), 0u);
  std::size_t used = 0;
  for (const auto& row : table()) used += static_cast<std::size_t>(test::number(row, "sensors_used"));
  EXPECT_EQ(used + total(summary["readings_not_used"]), 2400u);
  EXPECT_GT(summary["convergence_index"]["rho_normalised"], 0.0);
  EXPECT_GT(summary["convergence_index"]["rho_paper"], 0.0);
}

TEST_F(Estimate, IsAsGoodAsItSays) {
  estimate_demo();
  const auto judged = evaluate_demo();
  ASSERT_TRUE(judged.is_object());
  EXPECT_EQ(judged["frames"], 1160);  // the first second is skipped
  for (const char* axis : {"x", "y", "z"}) {
    EXPECT_GT(judged["share_inside_95_percent_interval"][axis], 0.90) << axis;
    EXPECT_GT(judged["share_inside_3_sigma"][axis], 0.99) << axis;
  }
  // Bounds for one frame, README of the recordings: 0.6, 4 and 9 mN.
  EXPECT_LT(judged["rmse_N"]["x"], 0.6e-3);
  EXPECT_LT(judged["rmse_N"]["y"], 5e-3);
  EXPECT_LT(judged["rmse_N"]["z"], 9e-3);
  EXPECT_NEAR(judged["mean_nees"].get<double>(), 3.0, 1.0);
}

TEST_F(Estimate, EveryMethodAndMeasurementWorks) {
  for (const char* method : {"ekf", "iekf", "iaekf", "ukf"}) {
    const auto run = estimate_demo({"--method", method, "--json"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(nlohmann::json::parse(run.out)["method"], method);
    EXPECT_LT(evaluate_demo()["rmse_N"]["z"], 12e-3) << method;
  }
  const auto run = estimate_demo({"--measurement", "tip_and_curvature", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(nlohmann::json::parse(run.out)["measurement"], "tip_and_curvature");
  EXPECT_LT(evaluate_demo()["rmse_N"]["z"], 30e-3);
}

TEST_F(Estimate, TwoRunsGiveTheSameBytes) {
  const auto first = estimate_demo();
  const std::string first_csv = contents(path("e.csv"));
  const auto second = estimate_demo();
  EXPECT_EQ(first.out, second.out);
  EXPECT_TRUE(first_csv == contents(path("e.csv")));
}

TEST_F(Estimate, PicturesAreMade) {
  const auto svg = estimate_demo({"--plot", "p.svg"});
  ASSERT_EQ(svg.exit_code, 0) << svg.err;
  const std::string drawn = contents(path("p.svg"));
  for (const char* words : {"<svg", "Fx along d1 [N]", "time [s]", "95 % interval", "virtual ablation catheter"})
    EXPECT_NE(drawn.find(words), std::string::npos) << words;
  EXPECT_GT(drawn.size(), 20000u);
  ASSERT_EQ(estimate_demo({"--plot", "p.png"}).exit_code, 0);
  const std::string picture = contents(path("p.png"));
  EXPECT_TRUE(picture.starts_with("\x89PNG"));
  EXPECT_GT(picture.size(), 20000u);
}

TEST_F(Estimate, EvaluatePrintsATable) {
  estimate_demo();
  const auto run = palpate({"evaluate", "--estimate", "e.csv", "--truth", "demo.force.csv"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_TRUE(run.out.starts_with("1160 frames judged (1160 updated, 0 held); error = estimate - truth")) << run.out;
  EXPECT_NE(run.out.find("RMSE"), std::string::npos);
}

TEST_F(Estimate, ReferenceIntervalCorrectsTheBase) {
  write("c.toml", test::shifted_recording().catheter);
  write("r.csv", test::shifted_recording().tracker.text());
  const auto worst = [&] {
    double largest_N = 0.0;
    const auto rows = table();
    for (std::size_t i = 90; i < rows.size(); ++i)  // loaded since frame 80
      largest_N = std::max(largest_N,
                           std::abs(test::number(rows[i], "fx_tip_N") - test::shifted_recording().force_tip_N[i].x()));
    return largest_N;
  };
  summary();
  const double without = worst();
  const auto told = summary({"--reference", "0:2"});
  EXPECT_NEAR(told["tare"]["frames"].get<double>(), 80.0, 1.0);
  EXPECT_LT(told["tare"]["residual_after_mm"], 0.1);
  EXPECT_GT(told["tare"]["residual_before_mm"], 1.0);
  EXPECT_LT(worst(), 0.5 * without);
}

// A long recording must not cost memory by the gigabyte: 10 minutes at 40 Hz.
TEST_F(Estimate, TenMinutesFitInto100Megabytes) {
  const auto made = test::make_recording(600.0);
  write("r.csv", made.tracker.text());
  const auto run = estimate();
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(table().size(), 24000u);
  std::printf("peak memory of palpate estimate on 24000 frames: %.1f MB\n", run.peak_memory_MB);
  RecordProperty("peak_memory_MB", std::to_string(run.peak_memory_MB));
  EXPECT_LT(run.peak_memory_MB, 100.0);
}

}  // namespace
}  // namespace palpate
