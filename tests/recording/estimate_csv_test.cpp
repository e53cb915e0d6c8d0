// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <palpate/recording/estimate_csv.hpp>
#include <tests/random_draws.hpp>
#include <tests/recording/temporary_folder.hpp>

namespace palpate {
namespace {

/// As in formats/README.md.
constexpr std::string_view kHeader =
    "time_s,fx_tip_N,fy_tip_N,fz_tip_N,sigma_x_N,sigma_y_N,sigma_z_N,cov_xy_N2,cov_xz_N2,cov_yz_N2,"
    "fx_base_N,fy_base_N,fz_base_N,status,sensors_used,nis,dof,evaluations";

class EstimateCsv : public test::TemporaryFolder {
 protected:
  std::filesystem::path written(const std::vector<Estimate>& estimates, const EstimateColumns& columns = {}) const {
    EstimateCsvWriter writer(path("e.csv"), columns);
    for (const Estimate& e : estimates) writer.write(e);
    writer.commit();
    return path("e.csv");
  }
  std::string error(std::string_view rows) const {
    return error_of([&] { read_estimate_csv(write("e.csv", std::string(kHeader).append("\n").append(rows))); });
  }
};

TEST_F(EstimateCsv, HeaderAndRowAreTheContracts) {
  Estimate e;
  e.time_s = 0.025;
  e.status = EstimateStatus::kUpdated;
  e.force_tip_N = {0.1, -0.02, 0.003};
  e.covariance_tip_N2 << 1e-4, 2e-5, 3e-5, 2e-5, 4e-4, 4e-5, 3e-5, 4e-5, 9e-4;
  e.force_base_N = {1.0, 2.0, -3.5};
  e.sensors_used = 2;
  e.nis = 11.25;
  e.dof = 12;
  e.evaluations = 3;
  EXPECT_EQ(contents(written({e})),
            std::string(kHeader) +
                "\n0.025,0.1,-0.02,0.003,0.01,0.02,0.03,2e-05,3e-05,4e-05,1,2,-3.5,UPDATED,2,11.25,12,3\n");
}

TEST_F(EstimateCsv, EstimatedParametersFollowEachWithItsSigma) {
  Estimate e;
  e.status = EstimateStatus::kUpdated;
  e.shaft = {.stiffness_Nm2 = {2.5e-4, 1.5e-4, 2e-4},
             .stiffness_sigma_Nm2 = {1e-5, 2e-5, 3e-5},
             .precurvature_per_m = {40, -0.5, 9},
             .precurvature_sigma_per_m = {0.5, 0.25, 9}};
  e.forecast = {.mean_N = {1, 2, 3}, .covariance_N2 = Matrix3d::Identity()};
  const std::string row = "0,0,0,0,0,0,0,0,0,0,0,0,0,UPDATED,0,0,0,0";
  const std::string forecast =
      ",forecast_fx_tip_N,forecast_fy_tip_N,forecast_fz_tip_N,forecast_sigma_x_N,forecast_sigma_y_N,forecast_sigma_z_N";
  const auto text = [&](const EstimateColumns& columns) { return contents(written({e}, columns)); };
  const std::string header(kHeader);
  EXPECT_EQ(text({.stiffness = true}),
            header + ",EI1_Nm2,sigma_EI1_Nm2,EI2_Nm2,sigma_EI2_Nm2\n" + row + ",0.00025,1e-05,0.00015,2e-05\n");
  EXPECT_EQ(text({.precurvature = true}),
            header + ",k1_0_per_m,sigma_k1_0_per_m,k2_0_per_m,sigma_k2_0_per_m\n" + row + ",40,0.5,-0.5,0.25\n");
  EXPECT_EQ(text({.stiffness = true, .torsion = true, .precurvature = true, .forecast = true}),
            header +
                ",EI1_Nm2,sigma_EI1_Nm2,EI2_Nm2,sigma_EI2_Nm2,GJ_Nm2,sigma_GJ_Nm2,k1_0_per_m,sigma_k1_0_per_m,"
                "k2_0_per_m,sigma_k2_0_per_m" +
                forecast + "\n" + row + ",0.00025,1e-05,0.00015,2e-05,0.0002,3e-05,40,0.5,-0.5,0.25,1,2,3,1,1,1\n");
  EXPECT_EQ(read_estimate_csv(path("e.csv")).size(), 1U);
}

TEST_F(EstimateCsv, ColumnsFollowTheOptions) {
  ObserverOptions options;
  options.free_torsion = true;
  const EstimateColumns plain = EstimateColumns::of(options);
  EXPECT_FALSE(plain.stiffness || plain.torsion || plain.precurvature || plain.forecast) << "no stiffness, no torsion";
  options.estimate_stiffness = true;
  options.forecast_s = 0.1;
  const EstimateColumns more = EstimateColumns::of(options);
  EXPECT_TRUE(more.stiffness && more.torsion && more.forecast);
  EXPECT_FALSE(more.precurvature);
  options.free_torsion = false;
  EXPECT_FALSE(EstimateColumns::of(options).torsion);
}

/// Forces are written with nine digits, sigmas and covariances with six.
TEST_F(EstimateCsv, WhatIsWrittenIsRead) {
  test::Draws draws(91);
  std::vector<Estimate> estimates;
  for (std::size_t i = 0; i < 50; ++i) {
    Estimate e;
    e.time_s = 1.7e9 + 0.025 * static_cast<double>(i);
    e.status = static_cast<EstimateStatus>(i % kEstimateStatuses);
    e.force_tip_N = 0.1 * draws.normal3();
    const Matrix3d A = 0.01 * (Matrix3d() << draws.normal3(), draws.normal3(), draws.normal3()).finished();
    e.covariance_tip_N2 = A * A.transpose() + 1e-6 * Matrix3d::Identity();
    estimates.push_back(e);
  }
  const std::vector<EstimateRow> rows = read_estimate_csv(written(estimates));
  ASSERT_EQ(rows.size(), estimates.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].time_s, estimates[i].time_s) << "times keep every digit";
    EXPECT_EQ(rows[i].status, estimates[i].status);
    EXPECT_LT((rows[i].force_tip_N - estimates[i].force_tip_N).norm(), 1e-9);
    const Matrix3d& P = estimates[i].covariance_tip_N2;
    EXPECT_LT((rows[i].covariance_tip_N2 - P).norm(), 1e-5 * P.norm());
    EXPECT_EQ(rows[i].covariance_tip_N2, rows[i].covariance_tip_N2.transpose());
  }
}

TEST_F(EstimateCsv, FrameWithoutATimeIsWrittenAndRead) {
  Estimate e;
  e.time_s = std::nan("");
  e.status = EstimateStatus::kRejected;
  e.covariance_tip_N2.setIdentity();
  const auto rows = read_estimate_csv(written({e}));
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_TRUE(std::isnan(rows[0].time_s));
  EXPECT_EQ(rows[0].status, EstimateStatus::kRejected);
}

TEST_F(EstimateCsv, ColumnsMayStandInAnyOrderAndMoreMayFollow) {
  const auto rows = read_estimate_csv(write(
      "e.csv",
      "status,EI1_Nm2,time_s,fz_tip_N,fy_tip_N,fx_tip_N,sigma_x_N,sigma_y_N,sigma_z_N,cov_xy_N2,cov_xz_N2,cov_yz_N2\n"
      "HELD,2e-4,1.5,3,2,1,0.1,0.2,0.3,0.01,0,0\n"));
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].force_tip_N, Vector3d(1, 2, 3));
  EXPECT_EQ(rows[0].status, EstimateStatus::kHeld);
  EXPECT_DOUBLE_EQ(rows[0].covariance_tip_N2(2, 2), 0.09);
  EXPECT_DOUBLE_EQ(rows[0].covariance_tip_N2(1, 0), 0.01);
}

TEST_F(EstimateCsv, FaultsNameLineFieldAndValue) {
  const std::string unknown = error("0,1,2,3,1,1,1,0,0,0,1,2,3,GOOD,2,12,12,3\n");
  EXPECT_NE(unknown.find("e.csv:2"), std::string::npos) << unknown;
  EXPECT_NE(unknown.find("'GOOD'"), std::string::npos) << unknown;
  EXPECT_NE(unknown.find("UPDATED"), std::string::npos) << unknown;
  const std::string text = error("0,1,2,3,1,1,1,0,0,0,1,2,3,HELD,0,0,0,0\n0,x,2,3,1,1,1,0,0,0,1,2,3,HELD,0,0,0,0\n");
  EXPECT_NE(text.find("e.csv:3"), std::string::npos) << text;
  EXPECT_NE(text.find("fx_tip_N"), std::string::npos) << text;
  const std::string lacking = error_of([&] { read_estimate_csv(write("e.csv", "time_s,fx_tip_N\n0,1\n")); });
  EXPECT_NE(lacking.find("fy_tip_N"), std::string::npos) << lacking;
}

TEST_F(EstimateCsv, WithoutCommitThereIsNoFile) {
  { EstimateCsvWriter(path("e.csv")).write(Estimate{}); }
  EXPECT_FALSE(std::filesystem::exists(path("e.csv")));
}

}  // namespace
}  // namespace palpate
