// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <palpate/recording/catheter_file.hpp>
#include <tests/apps/app_fixture.hpp>
#include <tests/random_draws.hpp>
#include <tests/shared_data.hpp>

namespace palpate {
namespace {

using ::testing::HasSubstr;

/// `palpate identify noise`: r.csv is the beating recording (sensors tip and shaft), rest.csv one made here.
class IdentifyNoise : public test::App {
 protected:
  void SetUp() override {
    test::App::SetUp();
    write("rest.csv", rest_text(400, {"tip", "shaft", "stranger"}));
  }

  /// 20 um along x and y, 60 um along z; 0.05 deg; a sweep of `swing_mm` at half a hertz.
  static std::string rest_text(int frames, const std::vector<std::string>& sensors, double swing_mm = 0.0) {
    test::Draws draws(11);
    std::string text = "time_s,frame,sensor,status,q0,qx,qy,qz,tx_mm,ty_mm,tz_mm,error_mm\n";
    const Matrix3d R = draws.rotation();
    char row[256];
    for (int i = 0; i < frames; ++i) {
      const double swing = swing_mm * std::sin(std::numbers::pi * 0.025 * i);
      for (const std::string& sensor : sensors) {
        const Eigen::Quaterniond q(R * draws.small_turn(0.05 * kRadiansPerDegree));
        std::snprintf(row, sizeof row, "%.3f,%d,%s,OK,%.6f,%.6f,%.6f,%.6f,%.4f,%.4f,%.4f,\n", 0.025 * i, i,
                      sensor.c_str(), q.w(), q.x(), q.y(), q.z(), 100 + swing + 0.02 * draws.normal(),
                      20 + swing + 0.02 * draws.normal(), 0.06 * draws.normal() - 30);
        text += row;
      }
    }
    return text;
  }
  nlohmann::json found(const Arguments& more, int exit_code = 0) const {
    Arguments arguments{"identify", "noise", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto run = palpate(arguments);
    EXPECT_EQ(run.exit_code, exit_code) << run.err;
    return nlohmann::json::parse(run.out, nullptr, false);
  }
};

TEST_F(IdentifyNoise, GoesIntoTheCatheterFileAlongItsAxes) {
  write_catheter("position_mm = [", "position_sigma_mm = 0.1\nposition_mm = [");
  const auto said = found({"rest.csv", "--catheter", "c.toml", "--out", "new.toml"});
  ASSERT_EQ(said["sensors"].size(), 3u);
  EXPECT_EQ(said["sensors"][0]["rest"], "still");
  EXPECT_EQ(said["sensors"][2]["on_catheter"], false);
  const Catheter before = read_catheter_file(path("c.toml")).catheter,
                 after = read_catheter_file(path("new.toml")).catheter;
  const Matrix3d R = before.base.T_tracker_base.R;
  const Vector3d variance_mm2(4e-4, 4e-4, 36e-4);
  const Vector3d expected_mm = (R.transpose() * variance_mm2.asDiagonal() * R).diagonal().cwiseSqrt();
  for (const Sensor& sensor : after.sensors) {
    EXPECT_LT((1e3 * sensor.noise_m - expected_mm).cwiseAbs().maxCoeff(), 0.1 * expected_mm.maxCoeff());
    // The worst axis: a little above the truth.
    EXPECT_NEAR(sensor.noise_rad / kRadiansPerDegree, 0.052, 0.004);
    EXPECT_EQ(sensor.bias_m, before.sensors[0].bias_m);
  }
  // The result is a catheter to estimate with, and all else in it is as it was.
  EXPECT_EQ(palpate({"estimate", "--catheter", "new.toml", "r.csv", "--out", "e.csv"}).exit_code, 0);
  EXPECT_EQ(after.rod.length_m(), before.rod.length_m());
  EXPECT_THAT(contents(path("new.toml")), HasSubstr("# identified at rest: +- "));
  EXPECT_EQ(contents(path("new.toml")).find("noise_mm ="), std::string::npos);
}

TEST_F(IdentifyNoise, SaysThatPrecisionIsNotAccuracy) {
  const auto run = palpate({"identify", "noise", "rest.csv", "--catheter", "c.toml"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.out, HasSubstr("This is precision"));
  EXPECT_THAT(run.err, HasSubstr("palpate: warning: sensor \"tip\": the catheter file states no accuracy error"));
  write("b.toml", [&] {
    std::string text = contents(path("c.toml"));
    for (std::size_t at = text.find("arc_length_mm"); at != std::string::npos; at = text.find("arc_length_mm", at + 40))
      text.insert(at, "bias_mm = 0.48\nbias_deg = 0.3\n");
    return text;
  }());
  EXPECT_EQ(palpate({"identify", "noise", "rest.csv", "--catheter", "b.toml"}).err, "");
}

TEST_F(IdentifyNoise, AMovingRecordingIsNoRest) {
  write("sweep.csv", rest_text(1200, {"tip", "shaft"}, 8.0));
  // Nothing rests: the answer is no.
  const auto said = found({"sweep.csv"}, 1);
  EXPECT_EQ(said["sensors"][0]["rest"], "moves");
  EXPECT_THAT(palpate({"identify", "noise", "sweep.csv"}).err, HasSubstr("or use --moving"));
  EXPECT_EQ(refusal({"identify", "noise", "sweep.csv", "--catheter", "c.toml", "--out", "new.toml", "--plot", "p.svg"}),
            "sweep.csv: sensor \"tip\" does not rest: expected a recording at rest (choose a part with --interval), or "
            "--moving; no catheter file is written");
  const auto moving = found({"sweep.csv", "--moving", "--catheter", "c.toml", "--out", "new.toml", "--plot", "p.svg"});
  EXPECT_NEAR(moving["sensors"][0]["position_sigma_mm"][0].get<double>(), 0.02, 0.002);
  EXPECT_NEAR(moving["sensors"][0]["position_sigma_mm"][2].get<double>(), 0.06, 0.006);
  EXPECT_TRUE(moving["sensors"][0]["holds"]);
  EXPECT_THAT(contents(path("new.toml")), HasSubstr("# identified moving: +- "));
  EXPECT_THAT(contents(path("p.svg")), HasSubstr("sensor shaft"));
}

TEST_F(IdentifyNoise, ATrackedBaseGetsItsNoiseToo) {
  std::string text = contents(path("c.toml"));
  const std::size_t base = text.find("[base]"), next = text.find("\n[", base + 1);
  write("t.toml", text.replace(base, next - base, "[base]\nsensor = \"clamp\"\nnoise_mm = 0.5  # guessed"));
  write("rest.csv", rest_text(400, {"tip", "shaft", "clamp"}));
  found({"rest.csv", "--catheter", "t.toml", "--out", "new.toml"});
  const Catheter after = read_catheter_file(path("new.toml")).catheter;
  EXPECT_NEAR(1e3 * after.base.sensor.noise_m.x(), 0.06, 0.006);
  EXPECT_NEAR(1e3 * after.sensors[1].noise_m.x(), 0.06, 0.006);
  EXPECT_THAT(contents(path("new.toml")), HasSubstr("[base]\nnoise_deg = "));
}

TEST_F(IdentifyNoise, RefusesBadInput) {
  const auto refused = [&](const Arguments& more) {
    Arguments arguments{"identify", "noise"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return refusal(arguments);
  };
  EXPECT_EQ(
      refused({"rest.csv", "--interval", "20:30"}),
      "rest.csv: no frame between 20 s and 30 s: expected an interval with frames; the recording goes from 0 s to "
      "9.975 s");
  EXPECT_EQ(refused({"rest.csv", "--interval", "3:2"}), "--interval 3:2: expected an end after the beginning");
  EXPECT_THAT(refused({"rest.csv", "--interval", "0:0.01"}),
              HasSubstr("rest.csv: no sensor tells its noise: sensor \"tip\": 1 usable readings, 1 of them distinct"));
  write("one.csv", rest_text(1, {"tip"}));
  EXPECT_THAT(refused({"one.csv"}), HasSubstr("expected at least 10 distinct ones"));
  std::string missing = "time_s,frame,sensor,status,q0,qx,qy,qz,tx_mm,ty_mm,tz_mm,error_mm\n", nans = missing;
  for (int i = 0; i < 50; ++i) {
    missing += std::to_string(i) + "," + std::to_string(i) + ",tip,MISSING,,,,,,,,\n";
    nans += std::to_string(i) + "," + std::to_string(i) + ",tip,OK,1,0,0,0,nan,0,0,\n";
  }
  write("missing.csv", missing);
  write("nan.csv", nans);
  for (const char* name : {"missing.csv", "nan.csv"}) {
    EXPECT_THAT(refused({name}), HasSubstr("0 usable readings")) << name;
    EXPECT_THAT(refused({name, "--moving"}), HasSubstr("0 usable readings")) << name;
  }
  EXPECT_THAT(refused({"no.csv"}), HasSubstr("no.csv: cannot be opened"));
  EXPECT_THAT(refused({"rest.csv", "--catheter", "c.toml", "--out", "rest.csv"}),
              HasSubstr("another file than the recording"));
  EXPECT_THAT(refused({"rest.csv", "--plot", "p.jpg"}), HasSubstr("ends in .svg or .png"));
  EXPECT_THAT(refused({"rest.csv", "--catheter", "c.toml", "--out", "no/new.toml"}),
              HasSubstr("the folder no to exist"));
  write("strange.csv", rest_text(50, {"stranger"}));
  EXPECT_THAT(refused({"strange.csv", "--catheter", "c.toml", "--out", "new.toml"}),
              HasSubstr("tells the noise of no sensor of the catheter c.toml"));
}

/// README of the data: 0.01-0.04 mm and 0.04-0.10 deg on the worst axis.
TEST_F(IdentifyNoise, Aurora) {
  PALPATE_NEEDS_SHARED("data/ndi_aurora/NDIdata_snakeravenTest_2_2_21.csv");
  const auto said = found({test::shared_data("data/ndi_aurora/NDIdata_snakeravenTest_2_2_21.csv").string()});
  ASSERT_EQ(said["sensors"].size(), 4u);
  for (const auto& sensor : said["sensors"]) {
    EXPECT_GT(sensor["worst_position_sigma_mm"], 0.01);
    EXPECT_LT(sensor["worst_position_sigma_mm"], 0.045);
    EXPECT_GT(sensor["worst_orientation_sigma_deg"], 0.03);
    EXPECT_LT(sensor["worst_orientation_sigma_deg"], 0.11);
  }
}

TEST_F(IdentifyNoise, PlusReferenceRestsWhileStylusMoves) {
  PALPATE_NEEDS_SHARED("data/plus_tracker/ReferenceToRASCalibration.igs.mha");
  const auto said = found({test::shared_data("data/plus_tracker/ReferenceToRASCalibration.igs.mha").string()});
  for (const auto& sensor : said["sensors"])
    EXPECT_EQ(sensor["rest"] == "moves", sensor["sensor"] == "Stylus") << sensor["sensor"];
}

}  // namespace
}  // namespace palpate
