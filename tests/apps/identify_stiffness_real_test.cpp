// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <palpate/recording/catheter_file.hpp>
#include <palpate/recording/text_table.hpp>
#include <sstream>
#include <tests/apps/app_fixture.hpp>
#include <tests/shared_data.hpp>

namespace palpate {
namespace {

/// Measurements made by others, read where they are and turned into what the program reads.
class IdentifyRealStiffness : public test::App {
 protected:
  nlohmann::json identified(const std::string& catheter, const Arguments& more) const {
    Arguments arguments{"identify",   "stiffness", "--catheter", catheter, "--cases",
                        "cases.toml", "--out",     "new.toml",   "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const test::ProgramRun run = palpate(arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return nlohmann::json::parse(run.out, nullptr, false);
  }
};

constexpr const char* kCopperRod = R"([catheter]
length_mm = 510.0
youngs_modulus_Pa = 1.0e11
diameter_mm = 10.0
poisson_ratio = 0.34
weight_N_per_m = 6.9
[gravity]
direction_in_base = [1.0, 0.0, 0.0]
[base]
quaternion_wxyz = [1.0, 0.0, 0.0, 0.0]
position_mm = [0.0, 0.0, 0.0]
[[sensor]]
name = "end"
kind = "position"
arc_length_mm = 510.0
)";

/// xe [cm] from the clamp, ye [mm] of deflection under 0.5 kg at 0.51 m, own weight taken off.
TEST_F(IdentifyRealStiffness, CopperRod) {
  PALPATE_NEEDS_SHARED("data/copper_rods/rund_einseitig.csv");
  const TextFile file = read_text_file(test::shared_data("data/copper_rods/rund_einseitig.csv"));
  std::string points = "z_mm,x_mm\n";
  CsvReader csv(file, ';');
  while (csv.next()) points += fmt::format("{:.1f},{}\n", 10.0 * csv.number(0), csv.number(1));
  write("points.csv", points);
  write("rod.toml", kCopperRod);
  write("cases.toml",
        "own_weight = \"subtracted\"\n[[case]]\nname = \"500 g\"\nforce_base_N = [4.9033, 0.0, 0.0]\n"
        "points = \"points.csv\"\n");
  for (const char* method : {"lm", "nelder-mead"}) {
    const nlohmann::json json = identified("rod.toml", {"--unknowns", "scale", "--method", method});
    EXPECT_NEAR(json["bending_stiffness_Nm2"][1].get<double>(), 58.9, 0.02 * 58.9);
    EXPECT_LE(json["rms_mm"].get<double>(), 0.05);
    EXPECT_GT(json["stiffness_sigma_percent"].get<double>(), 0.1);
    EXPECT_LT(json["stiffness_sigma_percent"].get<double>(), 2.0);
  }
}

/// Each run's load, told by its shape and the stiffness of the other two (docs/howto/identify_stiffness.md).
TEST_F(IdentifyRealStiffness, SoftBeamPredictsTheLoadLeftOut) {
  PALPATE_NEEDS_SHARED("data/soft_beam");
  for (const char* run : {"beam_gravity_V2_a.csv", "beam_load52_V2_a.csv", "beam_load101_V2_a.csv"})
    std::filesystem::create_symlink(test::shared_data("data/soft_beam") / run, path(run));
  std::filesystem::copy_file(PALPATE_SOURCE_DIR "/examples/soft_beam/load_cases.toml", path("cases.toml"));
  std::filesystem::copy_file(PALPATE_SOURCE_DIR "/examples/soft_beam/soft_beam.toml", path("beam.toml"));
  const nlohmann::json json = identified("beam.toml", {"--unknowns", "scale"});
  const nlohmann::json& left_out = json["left_out"];
  ASSERT_EQ(left_out.size(), 3u);
  EXPECT_LE(std::abs(left_out[0]["difference_N"].get<double>()), 0.05);
  EXPECT_LE(std::abs(left_out[1]["difference_percent"].get<double>()), 5.0);
  EXPECT_LE(std::abs(left_out[2]["difference_percent"].get<double>()), 5.0);
  for (const auto& one : left_out)
    EXPECT_LT(std::abs(one["difference_N"].get<double>()), 2.0 * one["sigma_N"].get<double>()) << one;
  EXPECT_NEAR(json["bending_stiffness_Nm2"][0].get<double>(), 0.0178, 0.05 * 0.0178);  // upstream's modulus
  const test::ProgramRun run =
      palpate({"estimate", "--catheter", "new.toml", "beam_load52_V2_a.csv", "--out", "e.csv", "--average", "5:6"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
}

}  // namespace
}  // namespace palpate
