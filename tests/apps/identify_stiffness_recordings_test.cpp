// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <palpate/recording/catheter_file.hpp>
#include <palpate/recording/csv_writers.hpp>
#include <palpate/simulation/virtual_tracker.hpp>
#include <tests/apps/app_fixture.hpp>

namespace palpate {
namespace {

constexpr double kTrueScale = 1.15;

/// Recordings of a virtual shaft: 1 s free, then 3 s under a dead weight, the clamp elsewhere in each.
class IdentifyFromRecordings : public test::App {
 protected:
  void SetUp() override {
    App::SetUp();
    write_catheter("#SIGMAS", "position_sigma_mm = 5.0\nrotation_sigma_deg = 10.0");
    record("a.csv", {0.0, 0.02, 0.0}, {exp_so3({0.14, 0.0, 0.0}), {2e-3, 0.0, 0.0}}, 1);
    record("b.csv", {0.02, 0.0, 0.0}, {exp_so3({0.0, -0.1, 0.0}), {0.0, -3e-3, 1e-3}}, 2);
    write_cases(true);
  }

  void record(const char* name, const Vector3d& force_base_N, const Pose& shift, std::uint64_t seed) const {
    Catheter catheter = read_catheter_file(path("c.toml")).catheter;
    catheter.base.T_tracker_base = catheter.base.T_tracker_base * shift;
    for (Section& section : catheter.rod.sections) section.stiffness_Nm2 *= kTrueScale;
    const RodSolver solver(catheter.rod, {});
    const Vector3d force_N =
        follow_from_rest(solver, {.force_base_N = shift.R.transpose() * force_base_N, .tip = {}}).load.force_tip_N;
    const auto force = [&](double time_s) -> Vector3d { return time_s < 1.0 ? Vector3d(Vector3d::Zero()) : force_N; };
    write_tracker_csv(path(name), catheter,
                      simulate_tracker(catheter, force, {.duration_s = 4.0, .seed = seed}).frames);
  }

  void write_cases(bool with_reference, const std::string& interval_s = "[1.5, 4.0]") const {
    std::string text;
    for (const auto& [name, force] : {std::pair{"a", "[0.0, 0.02, 0.0]"}, {"b", "[0.02, 0.0, 0.0]"}})
      text +=
          fmt::format("[[case]]\nname = \"{0}\"\nforce_base_N = {1}\nrecording = \"{0}.csv\"\ninterval_s = {2}\n{3}",
                      name, force, interval_s, with_reference ? "reference_s = [0.0, 0.95]\n" : "");
    write("cases.toml", text);
  }

  const Arguments identify_ = {"identify", "stiffness", "--catheter", "c.toml", "--cases", "cases.toml",
                               "--out",    "new.toml",  "--unknowns", "scale",  "--json"};
};

TEST_F(IdentifyFromRecordings, EachWithItsOwnClamp) {
  const test::ProgramRun run = palpate(identify_);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  const nlohmann::json json = nlohmann::json::parse(run.out);
  const double scale = json["unknowns"][0]["value"], sigma = 0.01 * json["unknowns"][0]["sigma_percent"].get<double>();
  EXPECT_NEAR(scale / kTrueScale, 1.0, 0.02);
  EXPECT_NEAR(scale / kTrueScale, 1.0, 3.0 * sigma);
  EXPECT_LT(sigma, 0.02);
}

TEST_F(IdentifyFromRecordings, WithoutAReferenceTheClampIsThatOfTheFile) {
  write_cases(false);
  const test::ProgramRun run = palpate(identify_);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json json = nlohmann::json::parse(run.out);
  EXPECT_GT(json["rms_mm"].get<double>(), 1.0);  // two clamps are not one, and that shows
  EXPECT_NE(run.err.find("times what the points' sigmas allow"), std::string::npos) << run.err;
}

TEST_F(IdentifyFromRecordings, AReferenceIsForAllOrNone) {
  write("cases.toml",
        "[[case]]\nname = \"c\"\nforce_base_N = [0, 0.02, 0]\nrecording = \"a.csv\"\n"
        "interval_s = [1.5, 4.0]\n" +
            contents(path("cases.toml")));
  EXPECT_EQ(refusal(identify_),
            "cases.toml: case \"c\": expected a recording with reference_s, for other cases have one and [base] of the "
            "catheter file is unsure");
}

TEST_F(IdentifyFromRecordings, IntervalsMustHoldARestingShaft) {
  write_cases(true, "[14.0, 15.0]");
  EXPECT_TRUE(refusal(identify_).starts_with(
      "cases.toml: case \"a\": interval_s 14:15 s of a.csv: expected usable frames; the recording goes from 0 s to "))
      << refusal(identify_);
  write_cases(true, "[0.5, 2.0]");
  EXPECT_NE(palpate(identify_).err.find("is the shaft at rest?"), std::string::npos);
}

}  // namespace
}  // namespace palpate
