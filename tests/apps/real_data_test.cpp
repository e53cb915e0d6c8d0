// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <tests/apps/app_fixture.hpp>
#include <tests/shared_data.hpp>

namespace palpate {
namespace {

/// Files as devices write them, through the whole program. Their sensors sit on no catheter of ours: most frames fit no
/// shaft, and must be refused frame by frame, never the file.
class RealData : public test::App {
 protected:
  static std::string shaft(double length_mm, double stiffness_Nm2) {
    return "schema = 1\n[catheter]\nname = \"stand-in\"\npoisson_ratio = 0.4\nlength_mm = " +
           std::to_string(length_mm) + "\nbending_stiffness_Nm2 = [" + std::to_string(stiffness_Nm2) + ", " +
           std::to_string(stiffness_Nm2) + "]\n";
  }
  static std::string base(const char* position_mm) {
    return std::string("[base]\nquaternion_wxyz = [1, 0, 0, 0]\nposition_sigma_mm = 50\nposition_mm = ") + position_mm +
           "\n";
  }
  static std::string sensor(const char* name, const char* kind, double arc_length_mm) {
    return std::string("[[sensor]]\nname = \"") + name + "\"\nkind = \"" + kind +
           "\"\nnoise_mm = 2.0\nnoise_deg = 5.0\n" + "arc_length_mm = " + std::to_string(arc_length_mm) + "\n";
  }
  /// The summary of an estimate; also every frame is a row of finite numbers.
  nlohmann::json estimate_data(const std::string& catheter, const std::filesystem::path& recording) const {
    write("c.toml", catheter);
    const auto run = palpate({"estimate", "--catheter", "c.toml", recording.string(), "--out", "e.csv", "--json"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    auto said = nlohmann::json::parse(run.out, nullptr, false);
    const auto rows = table();
    EXPECT_EQ(rows.size(), said["frames"]);
    for (const auto& row : rows)
      for (const char* column : {"time_s", "fx_tip_N", "fy_tip_N", "fz_tip_N", "sigma_x_N", "sigma_z_N"})
        EXPECT_TRUE(std::isfinite(test::number(row, column)));
    EXPECT_EQ(said["rejected_rows"]["time_stands_still"], 0);
    EXPECT_EQ(said["rejected_rows"]["time_steps_back"], 0);
    return said;
  }
};

TEST_F(RealData, PlusSequence) {
  PALPATE_NEEDS_SHARED("data/plus_tracker");
  const auto said = estimate_data(
      shaft(200, 0.01) + base("[60.6, 137.9, -350]") + sensor("Reference", "pose", 50) + sensor("Stylus", "pose", 200),
      test::shared_data("data/plus_tracker/ReferenceToRASCalibration.igs.mha"));
  EXPECT_EQ(said["frames"], 93);
  EXPECT_EQ(said["readings_not_used"]["missing"], 0);
}

TEST_F(RealData, PlusSequenceWithATrackedBase) {
  PALPATE_NEEDS_SHARED("data/plus_tracker");
  const auto said =
      estimate_data(shaft(200, 0.01) + "[base]\nsensor = \"Reference\"\n" + sensor("Stylus", "pose", 200),
                    test::shared_data("data/plus_tracker/EightLandmarkPointsTrackedForPhantomRegistration.igs.mha"));
  EXPECT_EQ(said["frames"], 1000);
  EXPECT_EQ(said["readings_not_used"]["missing"], 0);
}

// One Probe transform is INVALID, one Reference transform exactly identity (by grep).
TEST_F(RealData, PlusSequenceWithInvalidTransforms) {
  PALPATE_NEEDS_SHARED("data/plus_tracker");
  const auto said = estimate_data(
      shaft(200, 0.01) + base("[-310, -85, -1560]") + sensor("Reference", "pose", 50) + sensor("Probe", "pose", 100),
      test::shared_data("data/plus_tracker/TransformInterpolationTest.igs.mha"));
  EXPECT_EQ(said["frames"], 500);
  EXPECT_EQ(said["readings_not_used"]["missing"], 1);
  EXPECT_EQ(said["readings_not_used"]["identity pose"], 1);
}

// Sensors not seen, by awk: a 3, b 5, c 10, d 2, the cut last row counted.
TEST_F(RealData, NdiCsv) {
  PALPATE_NEEDS_SHARED("data/ndi_aurora");
  const auto file = test::shared_data("data/ndi_aurora/NDIdata_snakeravenTest_2_2_21.csv");
  const std::string two =
      shaft(400, 0.01) + base("[100, 0, -300]") + sensor("a", "pose", 200) + sensor("b", "pose", 150);
  auto said = estimate_data(two + "[recording]\nignore_sensors = [\"c\", \"d\"]\n", file);
  EXPECT_EQ(said["frames"], 159);
  EXPECT_EQ(said["readings_not_used"]["missing"], 8);
  said = estimate_data(two + sensor("c", "position", 300) + sensor("d", "position", 400), file);
  EXPECT_EQ(said["readings_not_used"]["missing"], 20);
}

TEST_F(RealData, MrCoils) {
  PALPATE_NEEDS_SHARED("data/mr_catheter");
  const auto folder = test::shared_data("data/mr_catheter/SRI_April-2020-07-09T12_20_56.765");
  const auto said = estimate_data(shaft(80, 0.001) + base("[7, 0, -75]") + sensor("coil7", "position", 75) +
                                      sensor("coil6", "position", 67.33) +
                                      "[recording]\nignore_sensors = [\"coil0\", \"coil1\", \"coil2\", \"coil3\", "
                                      "\"coil4\", \"coil5\"]\n",
                                  folder / "cathcoords-coil7-0000.txt");
  EXPECT_EQ(said["frames"], 103);
  EXPECT_EQ(said["readings_not_used"]["missing"], 0);
  EXPECT_EQ(said["frames_by_status"]["UPDATED"], 103);  // this one is a catheter
}

TEST_F(RealData, MarkersOfASoftBeam) {
  PALPATE_NEEDS_SHARED("data/soft_beam");
  const std::string beam = shaft(100, 0.0172) + "weight_N_per_m = 9.44\n[gravity]\ndirection_in_base = [-1, 0, 0]\n" +
                           base("[53.6, 33, -28.5]") + sensor("tip", "position", 100);
  const auto load = test::shared_data("data/soft_beam/beam_load52_V2_a.csv");
  auto said = estimate_data(beam + "markers = [\"tip2\", \"tip3\"]\n", load);
  EXPECT_EQ(said["frames"], 600);
  EXPECT_EQ(said["readings_not_used"]["missing"], 0);

  std::string triad = beam + "markers = [\"tip1\", \"tip2\", \"tip3\"]\n";
  triad.replace(triad.find("\"position\""), 10, "\"pose\"");
  said = estimate_data(triad + "[reference]\nfrom_s = 0\nto_s = 0.19\nshape = \"straight\"\n", load);
  EXPECT_EQ(said["frames"], 600);
  EXPECT_EQ(said["tare"]["frames"], 20);
}

TEST_F(RealData, AMisfitIsSaid) {
  PALPATE_NEEDS_SHARED("data/plus_tracker");
  write("c.toml", shaft(200, 0.01) + base("[60.6, 137.9, -350]") + sensor("Reference", "pose", 50) +
                      sensor("Stylus", "pose", 200));
  std::filesystem::copy_file(test::shared_data("data/plus_tracker/ReferenceToRASCalibration.igs.mha"),
                             path("r.igs.mha"));
  const auto run = palpate({"estimate", "--catheter", "c.toml", "r.igs.mha", "--out", "e.csv"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_EQ(
      run.err,
      "palpate: warning: r.igs.mha: only 0 of 93 frames could be used: is it of this catheter, base and sensors?\n");
}

}  // namespace
}  // namespace palpate
