// SPDX-License-Identifier: Apache-2.0
#include <tests/apps/app_fixture.hpp>

namespace palpate {
namespace {

/// What a user reads when the catheter file is wrong. Lines are those of recording_text.cpp's catheter.
class BadCatheter : public test::App {
 protected:
  std::string refusal_with(const std::string& part, const std::string& replacement) const {
    write_catheter(part, replacement);
    return estimate_refusal();
  }
};

TEST_F(BadCatheter, IsNoFile) {
  write("c.toml", "");
  EXPECT_EQ(estimate_refusal(), "c.toml: is empty: expected lines of text");
  std::filesystem::remove(path("c.toml"));
  EXPECT_EQ(estimate_refusal(), "c.toml: cannot be opened: No such file or directory: expected a readable text file");
  std::filesystem::create_directory(path("c.toml"));
  EXPECT_EQ(estimate_refusal(), "c.toml: is a directory: expected a text file");
}

TEST_F(BadCatheter, IsNoToml) {
  EXPECT_EQ(
      refusal_with("length_mm = 70.0", "length_mm 70.0"),
      "c.toml:4: line 'length_mm 70.0': expected TOML: Error while parsing key-value pair: expected '=', saw '7'");
  EXPECT_EQ(refusal_with("[catheter]", "[catheter"),
            "c.toml:2: line '[catheter': expected TOML: Error while parsing table header: expected ']', saw '\\n'");
  std::filesystem::copy_file(path("r.csv"), path("c.toml"), std::filesystem::copy_options::overwrite_existing);
  EXPECT_TRUE(estimate_refusal().starts_with("c.toml:1: line 'time_s,frame,")) << estimate_refusal();
}

TEST_F(BadCatheter, HasUnknownKeys) {
  EXPECT_EQ(refusal_with("length_mm = 70.0", "lenght_mm = 70.0"),
            "c.toml:4: catheter.lenght_mm = 70: expected a known key; did you mean length_mm?");
  EXPECT_EQ(refusal_with("noise_deg = 0.17", "noise_rad = 0.003"),
            "c.toml:17: sensor.noise_rad = 0.003: expected a known key; did you mean noise_mm?");
  EXPECT_EQ(refusal_with("[base]", "[basis]"), "c.toml:8: basis = {...}: expected a known key; did you mean base?");
}

TEST_F(BadCatheter, HasMistypedValues) {
  EXPECT_EQ(refusal_with("length_mm = 70.0", "length_mm = \"70\""),
            "c.toml:4: catheter.length_mm = \"70\": expected a length in mm, 1..5000 (is it in metres?), as a number "
            "without quotes");
  EXPECT_EQ(
      refusal_with("[24.57, 0.0, 0.0]", "24.57"),
      "c.toml:7: catheter.precurvature_per_m = 24.57: expected [3 numbers], each a curvature in 1/m, at most 1000");
  EXPECT_EQ(refusal_with("kind = \"pose\"", "kind = \"6dof\""),
            "c.toml:14: sensor.kind = \"6dof\": expected one of 'pose', 'pose5', 'position'");
  EXPECT_EQ(refusal_with("noise_deg = 0.17", "noise_deg = nan"),
            "c.toml:17: sensor.noise_deg = nan: expected a standard deviation in degrees, more than 0, at most 90");
}

TEST_F(BadCatheter, HasWrongUnits) {
  EXPECT_EQ(refusal_with("length_mm = 70.0", "length_mm = 0.07"),
            "c.toml:4: catheter.length_mm = 0.07: expected a length in mm, 1..5000 (is it in metres?)");
  EXPECT_EQ(
      refusal_with("[0.2612e-3, 0.16664e-3]", "[261.2, 166.64]"),
      "c.toml:5: catheter.bending_stiffness_Nm2 = [261.2, 166.64]: expected a stiffness in N m^2 with stiffness / "
      "length^2 in 1e-5..1e4 N, here 5.33e+04 N (is it in N mm^2?)");
  EXPECT_EQ(refusal_with("arc_length_mm = 70.0", "arc_length_mm = 0.07"),
            "c.toml:15: sensor.arc_length_mm = 0.07: expected millimetres along a shaft of 70 mm (is it in metres?)");
}

TEST_F(BadCatheter, CannotBe) {
  EXPECT_EQ(refusal_with("0.2612e-3", "-0.2612e-3"),
            "c.toml:5: catheter.bending_stiffness_Nm2 = [-0.0002612, 0.00016664]: expected [2 numbers], each a number "
            "more than 0");
  EXPECT_EQ(refusal_with("arc_length_mm = 65.3", "arc_length_mm = 75"),
            "c.toml:21: sensor.arc_length_mm = 75: expected 0..70 mm, the shaft with its rigid tip");
  EXPECT_EQ(refusal_with("name = \"shaft\"", "name = \"tip\""),
            "c.toml:19: sensor.name = \"tip\": expected each name once");
  EXPECT_EQ(
      refusal_with("[0.7071067811865476, 0.0, 0.7071067811865476, 0.0]", "[1, 1, 0, 0]"),
      "c.toml:9: base.quaternion_wxyz = [1, 1, 0, 0]: expected a unit quaternion [w, x, y, z], here of norm 1.41421");
}

TEST_F(BadCatheter, LacksSomething) {
  EXPECT_EQ(refusal_with("[base]\nquaternion_wxyz = [0.7071067811865476, 0.0, 0.7071067811865476, 0.0]\n"
                         "position_mm = [20.0, -40.0, -180.0]\n",
                         ""),
            "c.toml:1: base = (absent): expected a table [base] with quaternion_wxyz and position_mm, or with sensor");
  EXPECT_EQ(refusal_with("length_mm = 70.0\n", ""),
            "c.toml:2: catheter.length_mm = (absent): expected a length in mm, 1..5000 (is it in metres?)");
  EXPECT_EQ(refusal_with("name = \"tip\"\n", ""),
            "c.toml:12: sensor.name = (absent): expected a text in quotes, not empty");
}

// A warning is said on stderr, and not in the way of a program that reads the summary.
TEST_F(BadCatheter, WarnsOfAStateWithoutASigma) {
  const auto run = estimate({"--state", "force,stiffness,precurvature", "--json"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_EQ(
      run.err,
      "palpate: warning: state stiffness: the catheter file states no stiffness_sigma_percent, so a default is "
      "taken for it\n"
      "palpate: warning: state precurvature: the catheter file states no precurvature_sigma_per_m, so a default is "
      "taken for it\n");
  EXPECT_TRUE(nlohmann::json::accept(run.out)) << run.out;
  write("r.csv", "");
  EXPECT_EQ(estimate_refusal({"--state", "force,stiffness"}),
            "r.csv: is empty: expected lines of text");  // one line: no warning before the error
}

TEST_F(BadCatheter, HasAKnownLoadOfAnotherTime) {
  const auto load = [](const std::string& times) {
    return "[[known_load]]\n" + times + "\nforce_tip_N = [0, 0, 0]\nsigma_N = 0.01\n[base]";
  };
  EXPECT_EQ(refusal_with("[base]", load("from_s = 50\nto_s = 60")),
            "r.csv: known_load 50:60 s: expected an interval with frames; the recording goes from 0 s to 3.975 s");
  write_catheter("[base]", load("from_s = 0\nto_s = 0.5"));
  EXPECT_EQ(estimate().exit_code, 0);
}

}  // namespace
}  // namespace palpate
