// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <palpate/recording/catheter_file.hpp>
#include <palpate/recording/csv_writers.hpp>
#include <tests/apps/app_fixture.hpp>
#include <tests/identification/unloaded_arcs.hpp>

namespace palpate {
namespace {

using test::Draws;
using ::testing::HasSubstr;

constexpr const char* kUnregistered = R"(# of the clamp nothing is known
schema = 1
[catheter]
name = "virtual ablation catheter"
length_mm = 70.0
bending_stiffness_Nm2 = [0.2612e-3, 0.16664e-3]
torsional_stiffness_Nm2 = 0.1645e-3
precurvature_per_m = [40.0, 0.0, 0.0]   # the last knob position
precurvature_sigma_per_m = [0.5, 0.5, 0.2]
[base]
quaternion_wxyz = [1.0, 0.0, 0.0, 0.0]  # anything
position_mm = [30.0, -20.0, 10.0]
[[sensor]]
name = "tip"
kind = "pose"
arc_length_mm = 70.0
noise_mm = 0.28
noise_deg = 0.17
[[sensor]]
name = "shaft"
kind = "pose"
arc_length_mm = 65.3
noise_mm = 0.28
noise_deg = 0.17
)";

/// `c.toml` knows nothing of the base; knob1.csv ... knob5.csv are 200 frames each, at rest at one knob position;
/// run.csv holds all five, one after the other, 10 s from beginning to beginning.
class IdentifyRegistration : public test::App {
 protected:
  static constexpr int kPositions = 5, kFrames = 200;

  void SetUp() override {
    TemporaryFolder::SetUp();
    write("c.toml", kUnregistered);
    Draws draws(21);
    setup_ = test::arc_setup(read_catheter_file(path("c.toml")).catheter, kPositions, draws);
    for (Vector3d& bend : setup_.bends_per_m) bend.z() = 0.0;
    setup_.bends_per_m.back().head<2>() = Eigen::Vector2d(40.0, 0.0);
    std::vector<TrackerFrame> run;
    for (std::size_t j = 0; j < kPositions; ++j) {
      const std::vector<TrackerFrame> frames = frames_of(j, 10.0 * static_cast<double>(j), draws);
      write_tracker_csv(path(knob(j)), setup_.catheter, frames);
      run.insert(run.end(), frames.begin(), frames.end());
    }
    write_tracker_csv(path("run.csv"), setup_.catheter, run);
  }

  std::vector<TrackerFrame> frames_of(std::size_t position, double from_s, Draws& draws) {
    std::vector<TrackerFrame> frames;
    for (int k = 0; k < kFrames; ++k) {
      TrackerFrame frame{.time_s = from_s + 0.025 * k, .number = next_frame_++};
      for (std::size_t i = 0; i < 2; ++i) frame.readings.push_back(test::reading_of(setup_.pose(position, i)));
      frames.push_back(test::with_noise(setup_.catheter, frame, draws));
    }
    return frames;
  }

  static std::string knob(std::size_t position) { return "knob" + std::to_string(position + 1) + ".csv"; }
  static Arguments command(const Arguments& more) {
    Arguments arguments{"identify", "registration", "--catheter", "c.toml", "--out", "new.toml"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  static Arguments all_knobs(const Arguments& more = {}) {
    Arguments arguments{"knob1.csv", "knob2.csv", "knob3.csv", "knob4.csv", "knob5.csv"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return command(arguments);
  }

  void expect_true_base(const std::string& file) const {
    const BaseRegistration base = read_catheter_file(path(file)).catheter.base;
    EXPECT_LT((base.T_tracker_base.p - setup_.T_reference_base.p).norm(), 0.1e-3);
    EXPECT_LT(log_so3(base.T_tracker_base.R.transpose() * setup_.T_reference_base.R).norm(), 0.1 * kRadiansPerDegree);
    EXPECT_GT(base.position_sigma_m, 1e-6);
    EXPECT_LT(base.position_sigma_m, 0.05e-3);
    EXPECT_GT(base.rotation_sigma_rad, 1e-5);
    EXPECT_LT(base.rotation_sigma_rad, 0.05 * kRadiansPerDegree);
  }

  test::ArcSetup setup_;
  std::int64_t next_frame_ = 0;
};

TEST_F(IdentifyRegistration, OneRecordingAKnobPosition) {
  const test::ProgramRun run = palpate(all_knobs({"--plot", "new.svg"}));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  EXPECT_THAT(run.out, HasSubstr("5 knob positions, 2 sensors, 1000 frames -> new.toml"));
  expect_true_base("new.toml");
  const std::string text = contents(path("new.toml"));
  EXPECT_THAT(text, HasSubstr("# of the clamp nothing is known"));
  EXPECT_THAT(text, HasSubstr("precurvature_per_m = [40.0, 0.0, 0.0]   # the last knob position"));
  EXPECT_THAT(text, HasSubstr("# identified: 5 knob positions, 1000 frames"));
  EXPECT_THAT(contents(path("new.svg")), HasSubstr("along e3 of the clamp [mm]"));
}

TEST_F(IdentifyRegistration, IntervalsOfOneRecording) {
  Arguments arguments{"run.csv", "--json"};
  for (int j = 0; j < kPositions; ++j) {
    arguments.emplace_back("--interval");
    arguments.push_back(std::to_string(10 * j) + ":" + std::to_string(10 * j + 6));
  }
  const test::ProgramRun run = palpate(command(arguments));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  expect_true_base("new.toml");
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_EQ(json["frames"], 1000);
  EXPECT_EQ(json["positions"].size(), 5u);
  EXPECT_EQ(json["positions"][1]["name"], "run.csv 10:16 s");
  EXPECT_NEAR(json["positions"][4]["k1_per_m"].get<double>(), 40.0, 0.2);
  EXPECT_EQ(json["degrees_of_freedom"], 44);
  EXPECT_TRUE(json["warnings"].empty());
}

/// The catheter file that comes out is one that `estimate` takes, and with which the unloaded shaft feels no force.
TEST_F(IdentifyRegistration, EstimateTakesTheResult) {
  ASSERT_EQ(palpate(all_knobs()).exit_code, 0);
  const test::ProgramRun run =
      palpate({"estimate", "--catheter", "new.toml", "knob5.csv", "--out", "e.csv", "--json", "--average", "40:46"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  for (const auto& component : json["average"]["force_base_N"]) EXPECT_NEAR(component.get<double>(), 0.0, 0.01);
  EXPECT_LT(json["nis_per_dof"].get<double>(), 1.2);
}

TEST_F(IdentifyRegistration, MountingsGoIntoTheSensors) {
  setup_.T_local_sensor[1] = {Draws::turn({0.05, -0.03, 0.04}), {0.5e-3, -0.3e-3, 0.2e-3}};
  Draws draws(22);
  for (std::size_t j = 0; j < kPositions; ++j) {
    if (j % 2 == 1) setup_.bends_per_m[j] = {0.0, 30.0, 0.0};
    write_tracker_csv(path(knob(j)), setup_.catheter, frames_of(j, 0.0, draws));
  }
  const test::ProgramRun run = palpate(all_knobs({"--mounting"}));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("palpate: warning: mounting: a common roll of base and sensors is not told"));
  EXPECT_THAT(run.out, HasSubstr("mounting of \"shaft\""));
  const Catheter found = read_catheter_file(path("new.toml")).catheter;
  const Sensor& shaft = found.sensors[1];
  EXPECT_GT(shaft.mount_sigma_m, 0.0);
  EXPECT_LT((shaft.T_local_sensor.p - setup_.T_local_sensor[1].p).norm(), 5.0 * shaft.mount_sigma_m);
  EXPECT_LT((shaft.T_local_sensor.p - setup_.T_local_sensor[1].p).norm(), 0.3e-3);
  EXPECT_LT(log_so3(shaft.T_local_sensor.R * setup_.T_local_sensor[1].R.transpose()).norm(), 0.01);
}

TEST_F(IdentifyRegistration, ABaseSensorGetsItsMounting) {
  std::string text = kUnregistered;
  text.replace(text.find("quaternion_wxyz"), text.find("[[sensor]]") - text.find("quaternion_wxyz"),
               "sensor = \"clamp\"\n[[sensor]]\nname = \"clamp\"\n");
  write("c.toml", text);
  setup_.catheter = read_catheter_file(path("c.toml")).catheter;
  Draws draws(23);
  for (std::size_t j = 0; j < kPositions; ++j) {
    std::vector<TrackerFrame> frames = frames_of(j, 0.0, draws);
    const Pose T_tracker_base_sensor = draws.pose(0.3);
    for (TrackerFrame& frame : frames) {
      frame.readings.push_back(test::reading_of(Pose{}));
      frame = test::moved(T_tracker_base_sensor, frame);
    }
    write_tracker_csv(path(knob(j)), setup_.catheter, frames);
  }
  const test::ProgramRun run = palpate(all_knobs({"--mounting"}));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Catheter found = read_catheter_file(path("new.toml")).catheter;
  EXPECT_TRUE(found.base.tracked);
  EXPECT_LT((found.base.sensor.T_local_sensor.inverse().p - setup_.T_reference_base.p).norm(), 3e-3);
  EXPECT_GT(found.base.position_sigma_m, 1e-6);
  EXPECT_GT(found.sensors[0].mount_sigma_m, 0.0);
  EXPECT_EQ(found.base.sensor.mount_sigma_m, 0.0) << "its own key is base.position_sigma_mm";
}

TEST_F(IdentifyRegistration, BadInput) {
  EXPECT_EQ(refusal(command({"knob1.csv", "--mounting"})),
            "1 knob position gives 12 numbers for 19 unknowns (6 of the base, 2 of bends, 11 of mountings): expected "
            "more knob positions");
  EXPECT_EQ(refusal(command({"run.csv", "--interval", "0:5", "--interval", "90:95"})),
            "run.csv: --interval 90:95: expected an interval with frames; the recording goes from 0 s to 44.975 s");
  EXPECT_EQ(refusal(command({"run.csv", "--interval", "5:0"})), "--interval 5:0: expected an end after the beginning");
  EXPECT_EQ(refusal(command({"run.csv", "--interval", "soon"})),
            "--interval soon: expected FROM:TO in seconds, as 0:2");
  EXPECT_EQ(refusal(command({"knob1.csv", "knob2.csv", "knob3.csv", "--interval", "0:5", "--interval", "10:15"})),
            "--interval: 2 of them for 3 recordings: expected none, one a recording in their order, or a single "
            "recording");
  EXPECT_EQ(refusal(all_knobs({"--mounting", "--mount-sigma-mm", "0"})),
            "registration: mount_sigma_m = 0: expected more than 0, at most 0.1");
  EXPECT_EQ(refusal(all_knobs({"--plot", "new.pdf"})),
            "--plot new.pdf: expected a file name that ends in .svg or .png");
  EXPECT_EQ(refusal(all_knobs({"--plot", "c.toml"})), "--plot c.toml: expected another file than the catheter file");
  EXPECT_EQ(refusal(command({"run.csv", "--interval", "0:5", "--interval", "4:9"})),
            "run.csv 4:9 s: overlaps run.csv 0:5 s: expected every frame once");
  EXPECT_EQ(refusal(command({"knob1.csv", "knob1.csv"})), "knob1.csv: overlaps knob1.csv: expected every frame once");
  EXPECT_THAT(refusal(command({"no.csv"})), HasSubstr("no.csv"));
}

TEST_F(IdentifyRegistration, NoSensorInView) {
  auto recording = test::RecordingText::parse(contents(path("knob3.csv")));
  for (auto& row : recording.rows) test::RecordingText::set_missing(row);
  write("knob3.csv", recording.text());
  EXPECT_EQ(
      refusal(all_knobs()),
      "knob3.csv: no usable reading of any sensor: expected the unloaded shaft in view, on sensors without a base "
      "of their own");
}

/// A recording in metres, read as millimetres: all sensors in one place.
TEST_F(IdentifyRegistration, UnitsThatMakeNoSense) {
  Draws draws(24);
  for (std::size_t j = 0; j < kPositions; ++j) {
    std::vector<TrackerFrame> frames = frames_of(j, 0.0, draws);
    for (TrackerFrame& frame : frames)
      for (SensorReading& reading : frame.readings) reading.position_m *= 1e-3;
    write_tracker_csv(path(knob(j)), setup_.catheter, frames);
  }
  EXPECT_THAT(refusal(all_knobs()), HasSubstr("expected poses of this catheter in millimetres"));
}

TEST_F(IdentifyRegistration, KnobTurnedMeanwhile) {
  const test::ProgramRun run = palpate(command({"run.csv", "knob1.csv", "knob2.csv"}));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("palpate: warning: run.csv: sensor \"tip\" moved by "));
  EXPECT_THAT(run.err, HasSubstr("expected a shaft at rest; --interval chooses a part of a recording"));
}

TEST_F(IdentifyRegistration, Help) {
  const test::ProgramRun run = palpate({"identify", "registration", "--help"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.out, HasSubstr("Example: palpate identify registration"));
}

}  // namespace
}  // namespace palpate
