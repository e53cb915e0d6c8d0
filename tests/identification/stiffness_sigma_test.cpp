// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <iostream>

#include "tests/identification/stiffness_setups.hpp"

/// The sigmas are honest: how often the intervals hold the truth.
namespace palpate {
namespace {

using Unknowns = StiffnessOptions::Unknowns;

constexpr int kSeeds = 200;
constexpr double kNoise_m = 0.28e-3;

struct Coverage {
  Eigen::ArrayXd within;
  double chi_square_per_dof = 0.0;
};

/// Noise, clamp and precurvature drawn anew from what is stated; share of the seeds whose 95 % interval, 1.96 sigma of
/// the logarithm, holds the truth.
Coverage coverage(const Catheter& stated, const StiffnessOptions& options, double stated_sigma_m) {
  std::mt19937_64 random(7);
  Coverage out;
  const Stiffness truth = stated.rod.sections[0].stiffness_Nm2;
  const bool one_truth = stated.base.position_sigma_m == 0.0 && stated.precurvature_sigma_per_m.isZero(0.0);
  std::vector<LoadCase> exact;
  for (int seed = 0; seed < kSeeds; ++seed) {
    Rod rod = stated.rod;
    rod.sections[0].precurvature_per_m += stated.precurvature_sigma_per_m.cwiseProduct(test::normal3(random));
    const Pose clamp{exp_so3(stated.base.rotation_sigma_rad * test::normal3(random)),
                     stated.base.position_sigma_m * test::normal3(random)};
    if (exact.empty() || !one_truth)
      exact = test::hang(rod, test::ten_forces_N(), test::every_centimetre(rod), stated_sigma_m, clamp);
    const auto cases = test::with_noise(exact, kNoise_m, random);
    const StiffnessFit fit = identify_stiffness(stated, cases, options);
    if (seed == 0) out.within = Eigen::ArrayXd::Zero(static_cast<Eigen::Index>(fit.unknowns.size()));
    for (std::size_t i = 0; i < fit.unknowns.size(); ++i) {
      const double error = std::log(fit.unknowns[i].value / truth(static_cast<Eigen::Index>(i)));
      out.within(static_cast<Eigen::Index>(i)) += std::abs(error) <= 1.96 * fit.unknowns[i].log_sigma;
    }
    out.chi_square_per_dof += fit.chi_square / fit.degrees_of_freedom / kSeeds;
  }
  out.within *= 100.0 / kSeeds;
  return out;
}

void expect_honest(const Coverage& found, const char* what) {
  std::cout << what << ": 95 % intervals hold the truth in " << found.within.transpose() << " % of " << kSeeds
            << " seeds; chi^2 / dof " << found.chi_square_per_dof << "\n";
  for (const double share : found.within) {
    EXPECT_GE(share, 92.0) << what;
    EXPECT_LE(share, 98.0) << what;
  }
}

TEST(StiffnessSigma, IntervalsHoldTheTruthWhereOnlyThePointsAreUncertain) {
  expect_honest(coverage(test::catheter_of(test::paper_catheter(19.41)), {}, kNoise_m), "points");
}

TEST(StiffnessSigma, IntervalsHoldTheTruthWhereClampAndPrecurvatureAreUncertainToo) {
  const Catheter stated = test::with_uncertain_setup(test::catheter_of(test::paper_catheter(19.41)));
  const Coverage found = coverage(stated, {.unknowns = Unknowns::kBendingAndTorsion}, kNoise_m);
  expect_honest(found, "points, clamp, precurvature; GJ free");
  EXPECT_NEAR(found.chi_square_per_dof, 1.0, 0.03);
}

TEST(StiffnessSigma, IntervalsHoldTheTruthWhereTheResidualsTellTheNoise) {
  expect_honest(coverage(test::catheter_of(test::paper_catheter(19.41)), {}, 0.0), "noise unknown");
}

TEST(StiffnessSigma, ResidualsBeyondTheStatedSigmaWidenItAndAreTold) {
  const Rod rod = test::paper_catheter(19.41);
  std::mt19937_64 random(5);
  const auto cases =
      test::with_noise(test::hang(rod, test::ten_forces_N(), test::every_centimetre(rod), 0.1e-3), 0.3e-3, random);
  const StiffnessFit fit = identify_stiffness(test::catheter_of(rod), cases);
  ASSERT_EQ(fit.warnings.size(), 1u);
  EXPECT_NE(fit.warnings[0].find("times what the points' sigmas allow"), std::string::npos);
  auto stated = cases;
  for (LoadCase& one : stated)
    for (ShapePoint& point : one.points) point.sigma_m.setConstant(0.3e-3);
  const StiffnessFit honest = identify_stiffness(test::catheter_of(rod), stated);
  EXPECT_TRUE(honest.warnings.empty());
  EXPECT_NEAR(fit.unknowns[0].log_sigma, honest.unknowns[0].log_sigma, 0.15 * honest.unknowns[0].log_sigma);
}

/// 25 sets of six cases, one without load, each left out in turn: the squared error over sigma^2 has mean 1.
/// The scatter of 150 of them is sqrt(2 / 150) = 0.12, a little more as those of a set share data.
TEST(StiffnessSigma, LeftOutLoadsArePredictedWithinTheirSigma) {
  const Catheter stated = test::with_uncertain_setup(test::catheter_of(test::paper_catheter(19.41)));
  std::vector<Vector3d> forces = test::ten_forces_N();
  forces.resize(5);
  forces.push_back(Vector3d::Zero());
  std::mt19937_64 random(9);
  double sum = 0.0, rms = 0.0;
  int count = 0;
  for (int set = 0; set < 25; ++set) {
    Rod rod = stated.rod;
    rod.sections[0].precurvature_per_m += stated.precurvature_sigma_per_m.cwiseProduct(test::normal3(random));
    const Pose clamp{exp_so3(stated.base.rotation_sigma_rad * test::normal3(random)),
                     stated.base.position_sigma_m * test::normal3(random)};
    const auto cases =
        test::with_noise(test::hang(rod, forces, test::every_centimetre(rod), kNoise_m, clamp), kNoise_m, random);
    for (const LeftOut& one : leave_one_out(stated, cases)) {
      sum += std::pow((one.predicted_N - one.stated_N) / one.sigma_N, 2);
      rms += one.rms_m;
      ++count;
    }
  }
  EXPECT_EQ(count, 150);
  std::cout << "left out: squared error over sigma^2, mean " << sum / count << "; rms " << 1e3 * rms / count << " mm\n";
  EXPECT_NEAR(sum / count, 1.0, 0.3);
  EXPECT_LT(rms / count, 2.0 * kNoise_m);
}

}  // namespace
}  // namespace palpate
