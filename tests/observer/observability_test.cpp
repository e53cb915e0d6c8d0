// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <palpate/observer/observability.hpp>
#include <tests/random_draws.hpp>

namespace palpate {
namespace {

TEST(Observability, SourcesHaveWords) {
  EXPECT_EQ(describe(UncertaintySource::kNoise), "noise");
  EXPECT_EQ(describe(UncertaintySource::kBias), "bias");
  EXPECT_EQ(describe(UncertaintySource::kStiffness), "stiffness");
  EXPECT_EQ(describe(UncertaintySource::kPrecurvature), "precurvature");
  EXPECT_EQ(describe(UncertaintySource::kBase), "base");
  EXPECT_EQ(describe(UncertaintySource::kMounting), "mounting");
  EXPECT_EQ(describe(UncertaintySource::kTendon), "tendon");
}

TEST(Observability, SaysInWordsWhatIsHidden) {
  EXPECT_EQ(describe(Observability{}), "all observable");
  EXPECT_EQ(describe(Observability{.shaft_straight = true}), "all observable") << "straight, but the axial force shows";
  EXPECT_EQ(describe(Observability{.axial_force_hidden = true}), "axial force hardly observable");
  EXPECT_EQ(describe(Observability{.axial_force_hidden = true, .shaft_straight = true}),
            "axial force not observable: shaft is straight");
  EXPECT_EQ(describe(Observability{.lateral_force_hidden = true}), "lateral force not observable");
  EXPECT_EQ(describe(Observability{.stiffness_rests_on_prior = true}), "stiffness scale rests on the prior");
  EXPECT_EQ(describe(Observability{.precurvature_rests_on_prior = true}), "precurvature rests on the prior");
  EXPECT_EQ(describe(Observability{.axial_force_hidden = true,
                                   .shaft_straight = true,
                                   .lateral_force_hidden = true,
                                   .stiffness_rests_on_prior = true,
                                   .precurvature_rests_on_prior = true}),
            "axial force not observable: shaft is straight; lateral force not observable; stiffness scale rests on the "
            "prior; precurvature rests on the prior");
}

TEST(Observability, BudgetsStartAtZero) {
  for (const Vector3d& sigma : zero_budget()) EXPECT_EQ(sigma, Vector3d::Zero());
}

/// Quantiles of chi-square with three degrees of freedom from tables: 7.81473 (95 %), 2.36597 (50 %).
TEST(ForceEllipsoid, SemiAxesOfADiagonalCovariance) {
  const Matrix3d P = Vector3d(4e-4, 9e-4, 1e-4).asDiagonal();
  const ForceEllipsoid region = force_ellipsoid(P);
  EXPECT_TRUE(region.semi_axes_N.isApprox(std::sqrt(7.81473) * Vector3d(0.03, 0.02, 0.01), 1e-6));
  EXPECT_NEAR(std::abs(region.axes(1, 0)), 1.0, 1e-12);
  EXPECT_NEAR(std::abs(region.axes(0, 1)), 1.0, 1e-12);
  EXPECT_NEAR(std::abs(region.axes(2, 2)), 1.0, 1e-12);
  EXPECT_NEAR(force_ellipsoid(P, 0.5).semi_axes_N.x(), std::sqrt(2.36597) * 0.03, 1e-7);
}

TEST(ForceEllipsoid, HoldsTheShareOfDraws) {
  test::Draws draws(17);
  const Matrix3d A = (Matrix3d() << draws.normal3(), draws.normal3(), draws.normal3()).finished();
  const ForceEllipsoid region = force_ellipsoid(A * A.transpose());
  EXPECT_TRUE(region.axes.isUnitary(1e-12));
  int inside = 0;
  constexpr int kDraws = 20000;
  for (int i = 0; i < kDraws; ++i) {
    const Vector3d force = A * draws.normal3();
    inside += (region.axes.transpose() * force).cwiseQuotient(region.semi_axes_N).squaredNorm() <= 1.0;
  }
  EXPECT_NEAR(inside, 0.95 * kDraws, 4.0 * std::sqrt(0.95 * 0.05 * kDraws));  // four binomial sigmas
}

TEST(ForceEllipsoid, DegenerateCovariances) {
  const Vector3d a(0.1, 0.2, -0.1);
  const Vector3d flat = force_ellipsoid(a * a.transpose()).semi_axes_N;
  EXPECT_NEAR(flat.x(), std::sqrt(7.81473) * a.norm(), 1e-6);
  EXPECT_GE(flat.z(), 0.0);
  EXPECT_LT(flat.y(), 1e-6);
  EXPECT_EQ(force_ellipsoid(Matrix3d::Zero()).semi_axes_N, Vector3d::Zero());
  EXPECT_TRUE(force_ellipsoid(Matrix3d::Constant(std::nan(""))).semi_axes_N.array().isNaN().all());
}

}  // namespace
}  // namespace palpate
