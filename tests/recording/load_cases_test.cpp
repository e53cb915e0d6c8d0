// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <palpate/recording/load_cases.hpp>
#include <tests/recording/temporary_folder.hpp>

namespace palpate {
namespace {

constexpr const char* kCases = R"(schema = 1
own_weight = "subtracted"
[[case]]
name = "up"
force_base_N = [0.0, 0.128, 0.0]
points = "points/up.csv"
)";

/// The oracle is what was written into the files; numbers are exact in binary or compared to 1e-15.
class LoadCases : public test::TemporaryFolder {
 protected:
  LoadCases() {
    catheter_.rod = uniform_rod(0.07, Stiffness(2.6e-4, 1.7e-4, 1.6e-4), Vector3d::Zero());
    catheter_.base.T_tracker_base = {Eigen::AngleAxisd(0.5 * std::numbers::pi, Vector3d::UnitX()).toRotationMatrix(),
                                     Vector3d(0.1, 0.0, 0.0)};
  }

  LoadCaseFile read(const std::string& cases, const std::string& points) const {
    std::filesystem::create_directories(path("points"));
    write("points/up.csv", points);
    return read_load_cases(write("cases.toml", cases), catheter_);
  }
  std::vector<LoadPoint> points(const std::string& text) const { return read(kCases, text).cases.at(0).points; }
  std::string refusal(const std::string& text) const {
    return error_of([&] { points(text); });
  }
  std::string refusal_of_cases(const std::string& from, const std::string& to) const {
    std::string cases = kCases;
    cases.replace(cases.find(from), from.size(), to);
    return error_of([&] { read(cases, "z_mm,x_mm\n70,1\n"); });
  }

  Catheter catheter_;
};

TEST_F(LoadCases, HoldWhatTheFileSays) {
  const LoadCaseFile file = read(kCases, "arc_length_mm,x_mm,z_mm\n10,0.5,9.75\n,1.5,60\n");
  EXPECT_TRUE(file.own_weight_subtracted);
  ASSERT_EQ(file.cases.size(), 1u);
  const LoadCaseEntry& up = file.cases[0];
  EXPECT_EQ(up.name, "up");
  EXPECT_EQ(up.force_base_N, Vector3d(0.0, 0.128, 0.0));
  EXPECT_FALSE(up.recorded());
  ASSERT_EQ(up.points.size(), 2u);
  EXPECT_NEAR(up.points[0].arc_length_m, 0.01, 1e-15);
  EXPECT_NEAR(up.points[0].position_base_m.x(), 0.5e-3, 1e-15);
  EXPECT_TRUE(std::isnan(up.points[0].position_base_m.y()));
  EXPECT_NEAR(up.points[0].position_base_m.z(), 9.75e-3, 1e-15);
  EXPECT_FALSE(up.points[0].R_base_local);
  EXPECT_EQ(up.points[0].sigma_m, 0.0);
  EXPECT_TRUE(std::isnan(up.points[1].arc_length_m));
  EXPECT_EQ(up.points[1].line, 3u);
}

TEST_F(LoadCases, OneFileOfPointsServesSeveralCases) {
  const std::vector<LoadPoint> found = points("case,z_mm,x_mm\nup,60,1\ndown,60,-1\nup,30,0.5\n");
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found[1].position_base_m.x(), 0.5e-3, 1e-15);
  EXPECT_EQ(refusal("case,z_mm,x_mm\ndown,60,1\n"),
            "points/up.csv:2: field case: value 'up': expected a row of this case");
}

TEST_F(LoadCases, OrientationsCarryTheirSigmas) {
  const std::string header = "arc_length_mm,x_mm,y_mm,z_mm,q0,qx,qy,qz,sigma_mm,sigma_deg\n";
  const LoadPoint point = points(header + "70,1,2,65,0.7071,0,0.7071,0,0.3,0.2\n").at(0);
  ASSERT_TRUE(point.R_base_local);
  EXPECT_LT((*point.R_base_local * Vector3d::UnitZ() - Vector3d::UnitX()).norm(), 1e-12);  // 90 deg about y
  EXPECT_NEAR(point.sigma_m, 0.3e-3, 1e-15);
  EXPECT_NEAR(point.sigma_rad, 0.2 * std::numbers::pi / 180.0, 1e-15);
  EXPECT_EQ(refusal(header + "70,1,2,65,0.7071,0,0.7071,0,0.3,\n"),
            "points/up.csv:2: field sigma_deg: value '': expected a standard deviation in degrees, for there is a "
            "quaternion");
  EXPECT_EQ(refusal(header + "70,1,2,65,0.7071,,0.7071,0,0.3,0.2\n"),
            "points/up.csv:2: field qx: value '': expected a number, for the quaternion's others are given");
  EXPECT_EQ(refusal(header + "70,1,2,65,1,0,1,0,0.3,0.2\n"),
            "points/up.csv:2: field q0: value '1': expected a unit quaternion, here of norm 1.41421");
}

/// The base stands at (100, 0, 0) mm in the tracker, turned by 90 deg about x: its z axis is the tracker's -y.
TEST_F(LoadCases, PointsInTheTrackersFrameAreTurned) {
  const std::string cases = std::string(kCases) + "frame = \"tracker\"\n";
  const LoadPoint point = read(cases, "x_mm,y_mm,z_mm\n105,-60,2\n").cases.at(0).points.at(0);
  EXPECT_LT((point.position_base_m - Vector3d(5e-3, 2e-3, 60e-3)).norm(), 1e-15);
  EXPECT_EQ(error_of([&] { read(cases, "x_mm,y_mm,z_mm\n105,-60,\n"); }),
            "points/up.csv:2: field z_mm: value '': expected a number in mm, for frame = \"tracker\" needs all three");
}

TEST_F(LoadCases, RecordingsAreNamedWithTheirIntervals) {
  const std::string cases =
      "clamp = \"fixed\"\n[[case]]\nname = \"a\"\nforce_base_N = [0, 0, 0]\nrecording = \"run.csv\"\n"
      "interval_s = [4.0, 5.0]\nreference_s = [0.0, 0.195]\nreference_shape = \"straight\"\nreference_sigma_mm = 1.1\n";
  const LoadCaseFile file = read_load_cases(write("cases.toml", cases), catheter_);
  EXPECT_FALSE(file.own_weight_subtracted);
  const LoadCaseEntry& a = file.cases.at(0);
  EXPECT_TRUE(a.recorded());
  EXPECT_EQ(a.recording, path("run.csv"));
  EXPECT_EQ(a.from_s, 4.0);
  EXPECT_EQ(a.to_s, 5.0);
  EXPECT_TRUE(a.reference.given && a.reference.straight);
  EXPECT_EQ(a.reference.to_s, 0.195);
  EXPECT_NEAR(a.reference_sigma_m, 1.1e-3, 1e-15);
  EXPECT_TRUE(file.clamp_fixed);
  const auto refusal_with = [&](const std::string& from, const std::string& to) {
    std::string other = cases;
    other.replace(other.find(from), from.size(), to);
    return error_of([&] { read_load_cases(write("cases.toml", other), catheter_); });
  };
  EXPECT_EQ(refusal_with("[4.0, 5.0]", "[5.0, 4.0]"),
            "cases.toml:6: case.interval_s = [5, 4]: expected [from, to] in s, from before to");
  EXPECT_EQ(refusal_with("reference_s = [0.0, 0.195]\n", ""),
            "cases.toml:7: case.reference_shape = \"straight\": expected it beside reference_s only");
  EXPECT_EQ(refusal_with("recording", "points = \"p.csv\"\nrecording"),
            "cases.toml:6: case.recording = \"run.csv\": expected either points or a recording");
}

TEST_F(LoadCases, BadCasesAreRefused) {
  EXPECT_EQ(refusal_of_cases("own_weight", "own_wieght"),
            "cases.toml:2: own_wieght = \"subtracted\": expected a known key; did you mean own_weight?");
  EXPECT_EQ(refusal_of_cases("\"subtracted\"", "\"gone\""),
            "cases.toml:2: own_weight = \"gone\": expected one of 'included', 'subtracted'");
  EXPECT_EQ(refusal_of_cases("points/up.csv", "points/away.csv"),
            "points/away.csv: cannot be opened: No such file or directory: expected a readable text file");
  EXPECT_EQ(refusal_of_cases("[0.0, 0.128, 0.0]", "[0.0, 13051.0, 0.0]"),
            "cases.toml:5: case.force_base_N = [0, 13051, 0]: expected [3 numbers], each a force in N, at most "
            "1000 (is it in mN or in grams?)");
  EXPECT_EQ(error_of([&] { read_load_cases(write("cases.toml", "schema = 1\n"), catheter_); }),
            "cases.toml:1: case = (absent): expected at least one [[case]]");
}

TEST_F(LoadCases, BadPointsAreRefused) {
  EXPECT_EQ(refusal("z_mm,x_mm\n70,one\n"), "points/up.csv:2: field x_mm: value 'one': expected a number");
  EXPECT_EQ(refusal("z_mm,x_mm\n70,1\n60\n"), "points/up.csv:3: field row: value '60': expected 2 fields, found 1");
  EXPECT_EQ(refusal("z_mm,x_cm\n70,1\n"),
            "points/up.csv:1: field header: value 'x_cm': expected a known column; did you mean x_mm?");
  EXPECT_EQ(refusal("arc_length_mm,sigma_mm\n70,1\n"),
            "points/up.csv:1: field header: value 'arc_length_mm,sigma_mm': expected at least one of x_mm, y_mm, z_mm");
  EXPECT_EQ(refusal("arc_length_mm,x_mm\n,1\n"),
            "points/up.csv:2: field arc_length_mm: value '': expected the arc length in mm, for there is no z_mm");
  EXPECT_EQ(refusal("z_mm,x_mm\n"),
            "points/up.csv:1: field row: value '': expected at least one point after the header");
  EXPECT_EQ(refusal("z_mm,x_mm,sigma_mm\n60,1,0.3\n70,1,\n"),
            "points/up.csv:3: field sigma_mm: value '': expected a standard deviation in every row, or in none");
}

TEST_F(LoadCases, LengthsThatMakeNoSenseAreRefused) {
  EXPECT_EQ(refusal("arc_length_mm,x_mm\n35,1\n71,2\n"),
            "points/up.csv:3: field arc_length_mm: value '71': expected 0..70 mm, the shaft with its rigid tip");
  EXPECT_EQ(
      refusal("z_mm,x_mm\n35,1\n70000,2\n"),
      "points/up.csv:3: field z_mm: value '70000': expected millimetres, a point at most 125 mm from the clamp of "
      "a shaft of 70 mm");
  EXPECT_EQ(refusal("z_mm,x_mm\n0.035,0.001\n0.07,0.002\n"),
            "points/up.csv:3: field z_mm: value '0.07': expected millimetres: no point is farther than 0.07 mm along a "
            "shaft of 70 mm; are they in metres?");
}

}  // namespace
}  // namespace palpate
