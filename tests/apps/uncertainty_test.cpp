// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <tests/apps/app_fixture.hpp>

namespace palpate {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kHeader =
    "time_s,fx_tip_N,fy_tip_N,fz_tip_N,sigma_x_N,sigma_y_N,sigma_z_N,cov_xy_N2,cov_xz_N2,cov_yz_N2,"
    "fx_base_N,fy_base_N,fz_base_N,status,sensors_used,nis,dof,evaluations";

/// What `palpate estimate` says about what it cannot know: which files, columns and members there are. The numbers in
/// them are tested where they are made.
class Uncertainty : public test::App {
 protected:
  void SetUp() override {
    test::App::SetUp();
    write_catheter("length_mm = 70.0",
                   "length_mm = 70.0\nstiffness_sigma_percent = 5.0\nprecurvature_sigma_per_m = [0.7, 0.7, 0.0]");
  }
  std::string header() const {
    const std::string text = contents(path("e.csv"));
    return text.substr(0, text.find('\n'));
  }
};

TEST_F(Uncertainty, EveryStateHasItsColumns) {
  const std::string stiffness = ",EI1_Nm2,sigma_EI1_Nm2,EI2_Nm2,sigma_EI2_Nm2";
  const std::string precurvature = ",k1_0_per_m,sigma_k1_0_per_m,k2_0_per_m,sigma_k2_0_per_m";
  const std::pair<const char*, std::string> states[] = {{"force", ""},
                                                        {"force,stiffness", stiffness},
                                                        {"precurvature, force", precurvature},
                                                        {"force,precurvature,stiffness", stiffness + precurvature}};
  for (const auto& [state, columns] : states) {
    const auto run = estimate({"--state", state});
    EXPECT_EQ(run.exit_code, 0);
    EXPECT_EQ(run.err, "");
    EXPECT_EQ(header(), kHeader + columns) << state;
    EXPECT_EQ(table().size(), 160u);
  }
}

TEST_F(Uncertainty, StateOfTheCatheterFileGivesWay) {
  const std::string catheter = contents(path("c.toml"));
  write("c.toml", catheter + "[estimator]\nstate = [\"force\", \"stiffness\"]\ntorsion = \"free\"\n");
  EXPECT_EQ(summary()["state"], (nlohmann::json{"force", "stiffness"}));
  EXPECT_THAT(header(), HasSubstr(",sigma_EI2_Nm2,GJ_Nm2,sigma_GJ_Nm2"));
  EXPECT_EQ(summary({"--state", "force"})["state"], nlohmann::json::array({"force"}));
  EXPECT_EQ(header(), kHeader);
}

TEST_F(Uncertainty, SummaryForAPerson) {
  const auto force = estimate();
  EXPECT_THAT(force.out, HasSubstr("\nstiffness scale: the catheter file's, "));
  EXPECT_THAT(force.out, HasSubstr("\n95 % ellipsoid of the last frame: semi-axes "));
  EXPECT_THAT(force.out, Not(HasSubstr("EI1")));
  EXPECT_THAT(force.out, Not(HasSubstr("noise alone")));
  const auto all = estimate({"--state", "force,stiffness,precurvature", "--no-consider"});
  EXPECT_THAT(all.out, HasSubstr("\nsigma is of noise and of what is estimated: "));
  EXPECT_THAT(all.out, HasSubstr("\nstiffness scale: "));
  EXPECT_THAT(all.out, HasSubstr("\nEI1 = "));
  EXPECT_THAT(all.out, HasSubstr("; k1,0 = "));
}

TEST_F(Uncertainty, SummaryForAProgram) {
  const auto force = summary();
  EXPECT_EQ(force["consider"], true);
  EXPECT_EQ(force["frames_used"], 160);
  EXPECT_EQ(force["median_sigma_by_source_N"].size(), 7u);
  EXPECT_EQ(force["median_sigma_by_source_N"]["noise"].size(), 3u);
  EXPECT_EQ(force["weakest_direction"]["force_N"].size(), 3u);
  EXPECT_LE(force["frames_not_observable"]["axial_force"], 160);
  EXPECT_GT(force["last"]["ellipsoid_95"]["semi_axes_N"][0], 0.0);
  EXPECT_EQ(force["last"]["ellipsoid_95"]["axes_tip"].size(), 3u);
  EXPECT_FALSE(force.contains("stiffness_scale"));
  EXPECT_FALSE(force["last"].contains("EI1_Nm2"));
  const auto all = summary({"--state", "force,stiffness,precurvature", "--no-consider"});
  EXPECT_EQ(all["consider"], false);
  EXPECT_TRUE(all["stiffness_scale"].contains("rests_on_prior"));
  for (const char* name : {"EI1_Nm2", "sigma_EI1_Nm2", "EI2_Nm2", "k1_0_per_m", "sigma_k2_0_per_m"})
    EXPECT_TRUE(all["last"].contains(name)) << name;
  EXPECT_FALSE(all["last"].contains("GJ_Nm2")) << "tied to EI";
}

TEST_F(Uncertainty, BudgetIsARowAFrame) {
  EXPECT_EQ(estimate().exit_code, 0);
  const std::string without = contents(path("e.csv"));
  const auto run = estimate({"--budget", "b.csv"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(contents(path("e.csv")) == without);
  const auto rows = table("b.csv");
  ASSERT_EQ(rows.size(), 160u);
  EXPECT_EQ(test::number(rows[159], "time_s"), test::number(table()[159], "time_s"));
  for (const char* name : {"not_observable", "weakest_fx_N", "weakest_sigmas", "sigma_noise_x_N", "sigma_tendon_z_N"})
    EXPECT_TRUE(rows[0].contains(name)) << name;
}

TEST_F(Uncertainty, TendonComesWithoutAWarning) {
  const std::string catheter = contents(path("c.toml"));
  write("c.toml", catheter + "[tendon]\nmodel = \"couple\"\nmoment_sigma_percent = 2.0\n");
  write("t.csv", "time_s,moment_1_Nm,moment_2_Nm,sigma_Nm\n0,0,0,1e-4\n4,0,0,1e-4\n");
  const auto run = estimate({"--tendon", "t.csv"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_EQ(run.err, "");
}

}  // namespace
}  // namespace palpate
