// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <palpate/recording/catheter_file.hpp>
#include <tests/recording/temporary_folder.hpp>

namespace palpate {
namespace {

/// Ten lines: what is added starts at line 11.
constexpr const char* kPlain = R"([catheter]
length_mm = 70.0
bending_stiffness_Nm2 = [0.2612e-3, 0.16664e-3]
poisson_ratio = 0.3
[base]
quaternion_wxyz = [1.0, 0.0, 0.0, 0.0]
position_mm = [0.0, 0.0, 0.0]
[[sensor]]
name = "tip"
arc_length_mm = 70.0
)";

class KnownLoads : public test::TemporaryFolder {
 protected:
  std::vector<KnownLoadInterval> read(const std::string& loads) const {
    return read_catheter_file(write("c.toml", kPlain + loads)).known_loads;
  }
  std::string error(const std::string& loads) const {
    return error_of([&] { read(loads); });
  }
};

TEST_F(KnownLoads, AreReadInEitherFrame) {
  EXPECT_TRUE(read("").empty());
  const auto loads = read(R"([[known_load]]
from_s = 5
to_s = 7.5
force_base_N = [0, 0, -0.1]
sigma_N = 0.002
[[known_load]]
from_s = 0.0
to_s = 5.0
force_tip_N = [0.0, 0.0, 0.0]
sigma_N = 1e-3
)");
  ASSERT_EQ(loads.size(), 2u);
  EXPECT_EQ(loads[0].from_s, 5.0);
  EXPECT_EQ(loads[0].to_s, 7.5);
  EXPECT_TRUE(loads[0].load.present && loads[0].load.in_base);
  EXPECT_EQ(loads[0].load.force_N, Eigen::Vector3d(0, 0, -0.1));
  EXPECT_EQ(loads[0].load.sigma_N, 0.002);
  EXPECT_TRUE(loads[1].load.present);
  EXPECT_FALSE(loads[1].load.in_base);
}

TEST_F(KnownLoads, FaultsNameLineFieldAndValue) {
  const std::string times = "[[known_load]]\nfrom_s = 1\nto_s = 2\n", force = "force_tip_N = [0, 0, 0]\n";
  EXPECT_EQ(error("[[known_load]]\nfrom_s = 1\nto_s = 1\nforce_tip_N = [0, 0, 0]\nsigma_N = 1\n"),
            "c.toml:13: known_load.to_s = 1: expected a time later than from_s");
  EXPECT_EQ(
      error(times + "sigma_N = 1\n"),
      "c.toml:11: known_load.force_tip_N = (absent): expected [x, y, z] in N, in the tip's axes, or force_base_N, "
      "in the base's");
  EXPECT_EQ(error(times + force + "force_base_N = [0, 0, 0]\nsigma_N = 1\n"),
            "c.toml:15: known_load.force_base_N = [0, 0, 0]: expected either force_tip_N or force_base_N");
  EXPECT_EQ(error(times + force),
            "c.toml:11: known_load.sigma_N = (absent): expected a standard deviation in N, more "
            "than 0, at most 1000");
  EXPECT_EQ(error(times + force + "sigma_N = 0\n"),
            "c.toml:15: known_load.sigma_N = 0: expected a standard deviation in N, more than 0, at most 1000");
  EXPECT_EQ(error(times + "force_tip_N = [0, 0, nan]\nsigma_N = 1\n"),
            "c.toml:14: known_load.force_tip_N = [0, 0, nan]: expected [3 numbers], each a force in N, at most 1000");
  EXPECT_EQ(error("[[known_load]]\nfrom_ms = 1\n"),
            "c.toml:12: known_load.from_ms = 1: expected a known key; did you mean from_s?");
  EXPECT_EQ(error("[known_load]\nfrom_s = 1\n"), "c.toml:11: known_load = {...}: expected tables [[known_load]]");
}

TEST_F(KnownLoads, MustNotOverlap) {
  const auto load = [](const char* from_s, const char* to_s) {
    return std::string("[[known_load]]\nfrom_s = ") + from_s + "\nto_s = " + to_s +
           "\nforce_tip_N = [0, 0, 0]\nsigma_N = 1\n";
  };
  EXPECT_EQ(
      error(load("1", "3") + load("5", "6") + load("2", "4")),
      "c.toml:22: known_load.from_s = 2: expected times outside the other known loads, here 2 to 4 s overlaps 1 to "
      "3 s");
  EXPECT_EQ(
      error(load("1", "3") + load("0", "9")),
      "c.toml:17: known_load.from_s = 0: expected times outside the other known loads, here 0 to 9 s overlaps 1 to "
      "3 s");
  EXPECT_EQ(read(load("1", "3") + load("3", "4") + load("0", "1")).size(), 3u) << "they may touch";
}

TEST_F(KnownLoads, AreSetOnTheFramesInside) {
  const KnownLoad first{.present = true, .force_N = {0, 0, 1}, .sigma_N = 0.1};
  const KnownLoad second{.present = true, .in_base = true, .sigma_N = 0.2};
  const std::vector<KnownLoadInterval> intervals{{1.0, 2.0, first}, {4.0, 5.0, second}, {8.0, 9.0, first}};
  std::vector<TrackerFrame> frames;
  for (const double time_s : {0.0, 1.0, 1.5, 2.0, 2.5, 4.5, std::nan(""), 6.0})
    frames.push_back({.time_s = time_s, .known_load = {}});
  EXPECT_EQ(attach_known_loads(intervals, frames), (std::vector<std::size_t>{3, 1, 0}));
  const double sigma_N[] = {0.0, 0.1, 0.1, 0.1, 0.0, 0.2, 0.0, 0.0};
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].known_load.present, sigma_N[i] > 0.0) << i;
    EXPECT_EQ(frames[i].known_load.sigma_N, sigma_N[i]) << i;
  }
  EXPECT_TRUE(frames[5].known_load.in_base);
  EXPECT_EQ(frames[1].known_load.force_N, Eigen::Vector3d(0, 0, 1));
}

TEST(ChooseState, EveryListWithForce) {
  const auto chosen = [](const std::vector<std::string>& names) -> std::string {
    ObserverOptions options;
    options.estimate_precurvature = true;  // what stood before is replaced, or left alone
    if (!choose_state(names, options)) return options.estimate_precurvature ? "refused" : "changed";
    return std::string(options.estimate_stiffness ? "s" : "-") + (options.estimate_precurvature ? "p" : "-");
  };
  EXPECT_EQ(chosen({"force"}), "--");
  EXPECT_EQ(chosen({"force", "stiffness"}), "s-");
  EXPECT_EQ(chosen({"precurvature", "force"}), "-p");
  EXPECT_EQ(chosen({"force", "stiffness", "precurvature"}), "sp");
  EXPECT_EQ(chosen({"stiffness"}), "refused");
  EXPECT_EQ(chosen({"force", "tendon"}), "refused");
  EXPECT_EQ(chosen({}), "refused");
}

}  // namespace
}  // namespace palpate
