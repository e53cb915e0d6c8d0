// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>
#include <palpate/recording/budget_csv.hpp>
#include <tests/recording/temporary_folder.hpp>

namespace palpate {
namespace {

class BudgetCsv : public test::TemporaryFolder {
 protected:
  std::string written(const Estimate& estimate) const {
    BudgetCsvWriter writer(path("b.csv"));
    writer.write(estimate);
    writer.commit();
    return contents(path("b.csv"));
  }
};

constexpr std::string_view kHeader =
    "time_s,not_observable,weakest_fx_N,weakest_fy_N,weakest_fz_N,weakest_sigmas,"
    "sigma_noise_x_N,sigma_noise_y_N,sigma_noise_z_N,sigma_bias_x_N,sigma_bias_y_N,sigma_bias_z_N,"
    "sigma_stiffness_x_N,sigma_stiffness_y_N,sigma_stiffness_z_N,"
    "sigma_precurvature_x_N,sigma_precurvature_y_N,sigma_precurvature_z_N,"
    "sigma_base_x_N,sigma_base_y_N,sigma_base_z_N,sigma_mounting_x_N,sigma_mounting_y_N,sigma_mounting_z_N,"
    "sigma_tendon_x_N,sigma_tendon_y_N,sigma_tendon_z_N\n";

TEST_F(BudgetCsv, EveryNumberHasItsColumn) {
  Estimate e;
  e.time_s = 0.025;
  e.observability.weakest_force_N = {0.001, -0.002, 0.3};
  e.observability.weakest_sigmas = 0.25;
  for (std::size_t i = 0; i < kUncertaintySources; ++i)
    e.sigma_by_source_N[i] = Vector3d(1, 2, 3) * 0.01 + Vector3d::Constant(static_cast<double>(i));
  EXPECT_EQ(written(e), std::string(kHeader) +
                            "0.025,,0.001,-0.002,0.3,0.25,0.01,0.02,0.03,1.01,1.02,1.03,2.01,2.02,2.03,3.01,3.02,3.03,"
                            "4.01,4.02,4.03,5.01,5.02,5.03,6.01,6.02,6.03\n");
}

TEST_F(BudgetCsv, WordsAreOneFieldAndABlindFrameIsInfinite) {
  Estimate e;
  e.observability.axial_force_hidden = e.observability.shaft_straight = true;
  e.observability.stiffness_rests_on_prior = true;
  e.observability.weakest_sigmas = std::numeric_limits<double>::infinity();
  EXPECT_EQ(written(e), std::string(kHeader) +
                            "0,axial force not observable: shaft is straight; stiffness scale rests on the prior,"
                            "0,0,0,inf,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0\n");
}

TEST_F(BudgetCsv, WithoutCommitThereIsNoFile) {
  { BudgetCsvWriter(path("b.csv")).write(Estimate{}); }
  EXPECT_FALSE(std::filesystem::exists(path("b.csv")));
}

}  // namespace
}  // namespace palpate
