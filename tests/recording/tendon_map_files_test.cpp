// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <palpate/math/errors.hpp>
#include <palpate/recording/catheter_file.hpp>
#include <palpate/recording/catheter_tendon_map.hpp>
#include <palpate/recording/handle_csv.hpp>
#include <palpate/recording/precurvature_csv.hpp>
#include <tests/recording/temporary_folder.hpp>

namespace palpate {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// [tendon_map] of a catheter file, and the tables around it.
class TendonMapFiles : public test::TemporaryFolder {
 protected:
  static constexpr const char* kCatheter =
      "[catheter]\nlength_mm = 70.0\nbending_stiffness_Nm2 = [0.2612e-3, 0.16664e-3]\npoisson_ratio = 0.3\n"
      "precurvature_per_m = [30.0, 1.5, 0.0]\n[base]\nquaternion_wxyz = [1.0, 0.0, 0.0, 0.0]\nposition_mm = [0.0, 0.0, "
      "0.0]\n[[sensor]]\nname = \"tip\"\nkind = \"pose\"\narc_length_mm = 70.0\n";
  static constexpr const char* kMap =
      "[tendon_map]  # by hand\ninput = \"displacement_mm\"\nposition = [0.0, 2.0, 4.0]\npull_k1_per_m = [0.0, 20.0, "
      "50.0]\nrelease_k1_per_m = [1.0, 24.0, 50.0]\nsigma_per_m = [0.4, 0.1]\n";
};

TEST_F(TendonMapFiles, MapIsReadInMetres) {
  const TendonMap map = read_catheter_file(write("c.toml", std::string(kCatheter) + kMap)).catheter.tendon_map;
  EXPECT_TRUE(map.present);
  EXPECT_EQ(map.input, TendonInput::kDisplacement);
  EXPECT_THAT(map.position, ElementsAre(0.0, 2e-3, 4e-3));
  EXPECT_EQ(map.pull_per_m[1], Eigen::Vector2d(20.0, 1.5));  // k2,0 of the file
  EXPECT_EQ(map.release_per_m[1], Eigen::Vector2d(24.0, 1.5));
  EXPECT_EQ(map.sigma_per_m, Eigen::Vector2d(0.4, 0.1));
  EXPECT_FALSE(read_catheter_file(write("c.toml", kCatheter)).catheter.tendon_map.present);
}

TEST_F(TendonMapFiles, WhatIsWrittenIsReadBack) {
  for (const std::string& text : {std::string(kCatheter), std::string(kCatheter) + kMap}) {
    const auto path = write("c.toml", text);
    TendonMap map = read_catheter_file(write("m.toml", std::string(kCatheter) + kMap)).catheter.tendon_map;
    map.input = TendonInput::kTension;
    map.position = {0.5, 1.0, 7.0};
    map.pull_per_m[2].y() = 1.75;
    TomlEdit edit(path);
    write_tendon_map(map, "identified", edit);
    write_catheter_file(edit, path);
    const TendonMap back = read_catheter_file(path).catheter.tendon_map;
    EXPECT_EQ(back.input, map.input);
    EXPECT_EQ(back.position, map.position);
    EXPECT_EQ(back.pull_per_m, map.pull_per_m);
    EXPECT_EQ(back.release_per_m, map.release_per_m);
    EXPECT_EQ(back.sigma_per_m, map.sigma_per_m);
  }
}

TEST_F(TendonMapFiles, BadMapsAreRefused) {
  const auto refusal_of = [&](const std::string& part, const std::string& replacement) {
    std::string text = std::string(kCatheter) + kMap;
    text.replace(text.find(part), part.size(), replacement);
    const auto path = write("c.toml", text);
    return error_of([&] { read_catheter_file(path); });
  };
  EXPECT_THAT(refusal_of("[1.0, 24.0, 50.0]", "[1.0, 24.0]"),
              HasSubstr("tendon_map.release_k1_per_m = [1, 24]: expected [3 to 3 numbers]"));
  EXPECT_THAT(refusal_of("position = [0.0", "positions = [0.0"), HasSubstr("did you mean position?"));
  EXPECT_THAT(refusal_of("position = [0.0, 2.0, 4.0]", "position = [0.0, 4.0, 2.0]"),
              HasSubstr("more than the one before"));
  EXPECT_THAT(refusal_of("[0.4, 0.1]", "[0.0, 0.1]"), HasSubstr("k1's above 0"));
  EXPECT_THAT(refusal_of("[0.0, 20.0, 50.0]", "[0.0, 30.0, 50.0]"), HasSubstr("are the branches exchanged?"));
}

TEST_F(TendonMapFiles, HandleIsFollowedThroughItsPast) {
  const TendonMap map = read_catheter_file(write("c.toml", std::string(kCatheter) + kMap)).catheter.tendon_map;
  const TendonPlay play(map, {30.0, 1.5});
  const auto path = write("h.csv", "time_s,displacement_mm\n0,0\n1,4\n2,2\n3,2\n4,4.5\n");
  const HandleTrace handle = read_handle_csv(path, TendonInput::kDisplacement);
  const BendTrace trace = bends_at(handle, play, {2.5, 0.5, std::nan(""), 4.0, 9.0});
  EXPECT_NEAR(trace.bends[0].change_per_m.x(), 24.0 - 30.0, 1e-9);  // released to 2 mm
  EXPECT_NEAR(trace.bends[1].change_per_m.x(), 20.0 - 30.0, 1e-9);  // pulled to 2 mm
  EXPECT_FALSE(trace.bends[2].present);
  EXPECT_FALSE(trace.bends[3].inside);
  EXPECT_EQ(trace.outside, 1u);
  EXPECT_EQ(trace.beyond_the_map, 2u);
  const auto back = write("h.csv", "time_s,displacement_mm\n0,0\n0,4\n");
  EXPECT_THAT(error_of([&] { read_handle_csv(back, TendonInput::kDisplacement); }), HasSubstr("h.csv:3: field time_s"));
}

TEST_F(TendonMapFiles, DirectionGoesByTheOrder) {
  EXPECT_THAT(releases_by_order({0.0, 1.0, 1.0, 2.0, 1.5, 1.5, 1.7}),
              ElementsAre(false, false, false, false, true, true, false));
  EXPECT_THAT(releases_by_order({2.0, 1.0}), ElementsAre(true, true));
  const auto path = write("t.csv", "tension_N,knob_rad,k1_per_m,direction\n1,0,5,\n2,1,6,release\n3,2,7,\n");
  EXPECT_THAT(error_of([&] { read_handle_table_csv(path, std::nullopt, 0.0); }), HasSubstr("--input to choose"));
  const HandleTable table = read_handle_table_csv(path, TendonInput::kTension, 0.25);
  EXPECT_EQ(table.rows[2].position, 3.0);
  EXPECT_EQ(table.rows[2].precurvature_per_m, Eigen::Vector2d(7.0, 0.25));
  EXPECT_TRUE(table.rows[1].release);
  EXPECT_FALSE(table.rows[2].release);
}

}  // namespace
}  // namespace palpate
