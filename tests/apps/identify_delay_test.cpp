// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <palpate/recording/catheter_file.hpp>
#include <tests/apps/app_fixture.hpp>

namespace palpate {
namespace {

using ::testing::HasSubstr;

/// `palpate identify delay` of the beating recording r.csv against its true force f.csv, frame i at 0.025 i.
class IdentifyDelay : public test::App {
 protected:
  void SetUp() override {
    test::App::SetUp();
    write_truth(0.0);
  }
  /// The force sensor's clock: the tracker's stamps are later than its by `delay_s`.
  void write_truth(double delay_s, double scale = 1.0) const {
    std::string text = "time_s,fx_tip_N,fy_tip_N,fz_tip_N\n";
    char row[128];
    const auto& force_N = test::beating_recording().force_tip_N;
    for (std::size_t i = 0; i < force_N.size(); ++i) {
      std::snprintf(row, sizeof row, "%.6f,%.6f,%.6f,%.6f\n", 0.025 * static_cast<double>(i) - delay_s,
                    scale * force_N[i].x(), scale * force_N[i].y(), scale * force_N[i].z());
      text += row;
    }
    write("f.csv", text);
  }
  static Arguments with(const Arguments& more) {
    Arguments arguments{"identify", "delay"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  nlohmann::json found(const Arguments& more) const {
    Arguments arguments = with(more);
    arguments.push_back("--json");
    const auto run = palpate(arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return nlohmann::json::parse(run.out, nullptr, false);
  }
};

TEST_F(IdentifyDelay, KnownShiftsComeBackAndGoIntoTheCatheterFile) {
  for (const double delay_s : {0.0, 0.037, -0.12}) {
    write_truth(delay_s);
    const auto said =
        found({"--catheter", "c.toml", "r.csv", "--truth", "f.csv", "--out", "new.toml", "--plot", "p.svg"});
    const double sigma_s = said["sigma_s"];
    EXPECT_NEAR(said["delay_s"], delay_s, std::max(2e-3, 3.0 * sigma_s));
    EXPECT_LT(sigma_s, 5e-3);
    for (const Sensor& sensor : read_catheter_file(path("new.toml")).catheter.sensors)
      EXPECT_NEAR(sensor.delay_s, said["delay_s"], 1e-8);
    EXPECT_THAT(contents(path("p.svg")), HasSubstr("share of the force that is explained"));
    // With it the clocks agree: what is left is nothing, and the file holds the sum.
    const auto again = found({"--catheter", "new.toml", "r.csv", "--truth", "f.csv", "--out", "newer.toml"});
    EXPECT_NEAR(again["delay_s"], 0.0, 1e-4);
    EXPECT_NEAR(read_catheter_file(path("newer.toml")).catheter.sensors[0].delay_s, said["delay_s"], 1e-4);
  }
}

TEST_F(IdentifyDelay, AnEstimateHoldsTheLagOfItsFilter) {
  write_truth(0.037);
  ASSERT_EQ(estimate({"--smooth"}).exit_code, 0);
  const Arguments arguments{"--estimate", "e.csv", "--truth", "f.csv"};
  const double smoothed_s = found(arguments)["delay_s"];
  EXPECT_NEAR(smoothed_s, 0.037, 2e-3);
  ASSERT_EQ(estimate().exit_code, 0);
  EXPECT_GT(found(arguments)["delay_s"], smoothed_s);
  EXPECT_THAT(palpate(with(arguments)).err, HasSubstr("holds the lag of its filter"));
}

TEST_F(IdentifyDelay, AWrongScaleIsTold) {
  write_truth(0.0, 0.5);
  const auto run = palpate(with({"--catheter", "c.toml", "r.csv", "--truth", "f.csv"}));
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.err, HasSubstr("is the catheter's stiffness right?"));
}

TEST_F(IdentifyDelay, RefusesBadInput) {
  const auto refused = [&](const Arguments& more) {
    Arguments arguments{"--catheter", "c.toml", "r.csv", "--out", "new.toml", "--truth"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return refusal(with(arguments));
  };
  write_truth(100.0);
  EXPECT_THAT(refused({"f.csv"}), HasSubstr("f.csv: the forces are to be compared within +-0.5 s: only 0 samples"));
  write_truth(0.037);
  EXPECT_THAT(refused({"f.csv", "--max-delay", "0.02"}), HasSubstr("lies at the edge of the range"));
  EXPECT_THAT(refused({"f.csv", "--max-delay", "0"}), HasSubstr("--max-delay 0: expected seconds"));
  EXPECT_THAT(refused({"no.csv"}), HasSubstr("no.csv: cannot be opened"));
  const std::string header = "time_s,fx_tip_N,fy_tip_N,fz_tip_N\n";
  write("flat.csv", header + "-9,0.1,0,0\n0,0.1,0,0\n1,0.1,0,0\n2,0.1,0,0\n9,0.1,0,0\n");
  EXPECT_THAT(refused({"flat.csv"}), HasSubstr("flat.csv: the force does not change: a delay cannot be told"));
  write("nan.csv", header + "0,0,nan,0\n9,0,0,0\n");
  EXPECT_EQ(refused({"nan.csv"}), "nan.csv:2: field fy_tip_N: value 'nan': expected a finite number");
  write("single.csv", header + "0,0,0,0\n");
  EXPECT_THAT(refused({"single.csv"}), HasSubstr("single.csv: the force sensor has one sample"));
  test::RecordingText text = test::beating_recording().tracker;
  for (auto& row : text.rows) test::RecordingText::set_missing(row);
  write("r.csv", text.text());
  EXPECT_THAT(refused({"f.csv"}), HasSubstr("r.csv: no frame of 160 tells a force"));
  EXPECT_THAT(refusal(with({"--truth", "f.csv"})), HasSubstr("expected either a recording"));
  EXPECT_THAT(refusal(with({"r.csv", "--truth", "f.csv"})), HasSubstr("--catheter: expected the catheter file"));
}

}  // namespace
}  // namespace palpate
