// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <iostream>
#include <limits>
#include <sstream>

#include "tests/identification/stiffness_setups.hpp"

/// Stiffness found where it is known: from virtual shapes, from closed forms, from another program's shapes, and from
/// a real rod.
namespace palpate {
namespace {

using test::relative_error;
using Unknowns = StiffnessOptions::Unknowns;
using Method = StiffnessOptions::Method;

constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

/// The file is off by a factor, up to a hundred either way, and by another in each stiffness.
TEST(Stiffness, OneMicrometreTellsBothToATenthOfAPercentFromAnyStart) {
  for (const double k1 : {0.0, 19.41}) {
    const Rod truth = test::paper_catheter(k1);
    std::mt19937_64 random(1);
    const auto cases =
        test::with_noise(test::hang(truth, test::ten_forces_N(), test::every_centimetre(truth), 1e-6), 1e-6, random);
    for (const double off : {1.0, 0.1, 10.0, 0.01, 100.0}) {
      Rod stated = truth;
      test::scale_stiffness(stated, off * Vector3d(1.0, 1.6, 1.2));
      const double GJ = stated.sections[0].stiffness_Nm2(2) * (truth.sections[0].stiffness_Nm2.head<2>().sum()) /
                        stated.sections[0].stiffness_Nm2.head<2>().sum();
      stated.sections[0].stiffness_Nm2(2) *= truth.sections[0].stiffness_Nm2(2) / GJ;  // its true share
      const StiffnessFit fit = identify_stiffness(test::catheter_of(stated), cases);
      EXPECT_TRUE(fit.converged);
      ASSERT_EQ(fit.unknowns.size(), 2u);
      EXPECT_LT(relative_error(fit.unknowns[0], 0.2612e-3), 1e-3) << off;
      EXPECT_LT(relative_error(fit.unknowns[1], 0.16664e-3), 1e-3) << off;
      EXPECT_LT(fit.unknowns[0].log_sigma, 1e-4);
      EXPECT_LT(fit.rms_m, 1.3e-6);
      EXPECT_NEAR(fit.chi_square, fit.degrees_of_freedom, 5.0 * std::sqrt(2.0 * fit.degrees_of_freedom));
      EXPECT_TRUE(fit.warnings.empty());
    }
  }
}

TEST(Stiffness, NelderMeadAndLevenbergMarquardtAgree) {
  for (const bool uncertain : {false, true}) {
    const Rod truth = test::paper_catheter(19.41);
    std::mt19937_64 random(2);
    const auto cases = test::with_noise(test::hang(truth, test::ten_forces_N(), test::every_centimetre(truth), 0.28e-3),
                                        0.28e-3, random);
    Catheter stated = test::catheter_of(truth);
    if (uncertain) stated = test::with_uncertain_setup(stated);
    test::scale_stiffness(stated.rod, {1.4, 0.8, 1.1});
    for (const Unknowns unknowns : {Unknowns::kScale, Unknowns::kBending, Unknowns::kBendingAndTorsion}) {
      const StiffnessFit a = identify_stiffness(stated, cases, {.unknowns = unknowns});
      const StiffnessFit b = identify_stiffness(stated, cases, {.unknowns = unknowns, .method = Method::kNelderMead});
      EXPECT_TRUE(a.converged && b.converged);
      for (std::size_t i = 0; i < a.unknowns.size(); ++i)
        EXPECT_LT(relative_error(b.unknowns[i], a.unknowns[i].value), 1e-4) << a.unknowns[i].name;
      EXPECT_NEAR(a.chi_square, b.chi_square, 1e-6 * a.chi_square);
    }
  }
}

/// A cantilever under a small dead load F on its end: y(s) = F s^2 (3 L - s) / (6 EI), to (F L^2 / EI)^2 = 1e-6.
TEST(Stiffness, SmallDeflectionsGiveTheCantileversClosedForm) {
  const double L = 0.3, EI1 = 0.8, EI2 = 0.5, F = 1e-3 * EI2 / (L * L);
  const auto deflected = [&](double s, double EI) { return F * s * s * (3.0 * L - s) / (6.0 * EI); };
  std::vector<LoadCase> cases(2);
  for (const double s : {0.1, 0.2, 0.3}) {
    ShapePoint point;
    point.arc_length_m = s;
    point.position_base_m = {deflected(s, EI2), kNotMeasured, kNotMeasured};  // along d1: bends about d2
    cases[0].points.push_back(point);
    point.position_base_m = {kNotMeasured, deflected(s, EI1), kNotMeasured};
    cases[1].points.push_back(point);
  }
  cases[0].force_base_N = {F, 0.0, 0.0};
  cases[1].force_base_N = {0.0, F, 0.0};
  const Catheter stated = test::catheter_of(uniform_rod(L, {0.1, 0.1, 0.1}, Vector3d::Zero()));
  const StiffnessFit fit = identify_stiffness(stated, cases);
  EXPECT_LT(relative_error(fit.unknowns[0], EI1), 2e-6);
  EXPECT_LT(relative_error(fit.unknowns[1], EI2), 2e-6);
}

/// Timoshenko's cantilever adds F s / (kGA): thick and soft, shear tells itself by the slope at the clamp.
TEST(Stiffness, ShearIsToldByTimoshenkosClosedForm) {
  const double L = 0.1, EI = 0.018, GA = 66.0, F = 1e-3 * EI / (L * L);
  LoadCase one{.name = "end load", .force_base_N = {F, 0.0, 0.0}, .points = {}};
  for (const double s : {0.02, 0.04, 0.06, 0.08, 0.1}) {
    ShapePoint point;
    point.arc_length_m = s;
    point.position_base_m = {F * s * s * (3.0 * L - s) / (6.0 * EI) + F * s / GA, kNotMeasured, kNotMeasured};
    one.points.push_back(point);
  }
  Catheter stated = test::catheter_of(uniform_rod(L, {0.05, 0.05, 0.03}, Vector3d::Zero()));
  stated.rod.shear_stiffness_N = 20.0;
  stated.rod.axial_stiffness_N = 60.0;
  const StiffnessFit fit =
      identify_stiffness(stated, std::span(&one, 1), {.unknowns = Unknowns::kScale, .free_shear = true});
  ASSERT_EQ(fit.unknowns.size(), 2u);
  EXPECT_LT(relative_error(fit.unknowns[0], EI / 0.05), 1e-5);
  EXPECT_LT(relative_error(fit.unknowns[1], GA), 1e-4);
  EXPECT_NEAR(fit.rod.axial_stiffness_N, 3.0 * fit.rod.shear_stiffness_N, 1e-9);
}

/// Shapes that two other programs agree on, where the dead load leaves the shaft on its branch from rest. Two loads for
/// each precurvature tell all three stiffnesses.
TEST(Stiffness, ShapesFromOtherProgramsGiveTheirStiffness) {
  PALPATE_NEEDS_SHARED(test::kRodStatics);
  int groups = 0;
  std::vector<test::ReferenceRod> rods = test::reference_rods();
  for (std::size_t i = 0; i + 1 < rods.size(); ++i) {
    std::vector<LoadCase> cases;
    for (const test::ReferenceRod* rod : {&rods[i], &rods[i + 1]}) {
      const RodSolver solver(rod->rod, std::vector<double>{}, Accuracy::kReference);
      const Equilibrium dead = follow_from_rest(solver, {.force_base_N = rod->force_base_N, .tip = {}});
      const bool same = (dead.T_base_tip.p - rod->stations.back().T_base_local.p).norm() < 1e-6;
      if (rod->force_base_N.isZero(0.0) || dead.status != EquilibriumStatus::kStable || !same) break;
      LoadCase one{.name = "other", .force_base_N = rod->force_base_N, .points = {}};
      for (const auto& station : rod->stations) {
        ShapePoint point;
        point.arc_length_m = station.s_m;
        point.position_base_m = station.T_base_local.p;
        point.sigma_m.setConstant(1e-6);
        one.points.push_back(point);
      }
      cases.push_back(one);
    }
    const Rod &a = rods[i].rod, &b = rods[i + 1].rod;
    const bool alike = a.sections[0].precurvature_per_m == b.sections[0].precurvature_per_m &&
                       a.sections[0].stiffness_Nm2 == b.sections[0].stiffness_Nm2 && a.length_m() == b.length_m();
    if (cases.size() < 2 || !alike) continue;
    Catheter stated = test::catheter_of(a);
    test::scale_stiffness(stated.rod, {3.0, 5.0, 4.0});
    const StiffnessFit fit = identify_stiffness(stated, cases, {.unknowns = Unknowns::kBendingAndTorsion});
    for (int k = 0; k < 3; ++k) EXPECT_LT(relative_error(fit.unknowns[k], a.sections[0].stiffness_Nm2(k)), 1e-4);
    EXPECT_LT(fit.rms_m, 1e-7);
    ++groups;
  }
  EXPECT_GE(groups, 5);
}

std::vector<LoadCase> copper_rod(bool by_arc_length) {
  std::ifstream file(test::shared_data("data/copper_rods/rund_einseitig.csv"));
  LoadCase one{.name = "0.5 kg", .force_base_N = {0.5 * 9.81, 0.0, 0.0}, .points = {}};
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::replace(line.begin(), line.end(), ';', ' ');
    std::istringstream numbers(line);
    double x_cm = 0.0, y_mm = 0.0;
    if (!(numbers >> x_cm >> y_mm)) continue;
    ShapePoint point;
    point.arc_length_m = by_arc_length ? 0.01 * x_cm : kNotMeasured;
    point.position_base_m = {1e-3 * y_mm, kNotMeasured, by_arc_length ? kNotMeasured : 0.01 * x_cm};
    one.points.push_back(point);
  }
  return {one};
}

/// data/README: least squares of the beam's closed form gives 58.9 N m^2, rms 0.043 mm.
TEST(Stiffness, OfTheCopperRodIsThatOfTheBeamsClosedForm) {
  PALPATE_NEEDS_SHARED("data/copper_rods");
  const Catheter stated =
      test::catheter_of(uniform_rod(0.51, round_shaft_stiffness(110e9, 0.01, 0.34), Vector3d::Zero()));
  for (const bool by_arc_length : {true, false}) {
    const StiffnessFit fit = identify_stiffness(stated, copper_rod(by_arc_length), {.unknowns = Unknowns::kScale});
    const double EI = fit.rod.sections[0].stiffness_Nm2(0);
    std::cout << "copper rod: EI " << EI << " N m^2, sigma " << 100.0 * fit.unknowns[0].log_sigma << " %, rms "
              << 1e3 * fit.rms_m << " mm\n";
    EXPECT_NEAR(EI, 58.9, 0.02 * 58.9);
    EXPECT_LE(fit.rms_m, 0.05e-3);
    EXPECT_EQ(fit.degrees_of_freedom, 19);
    EXPECT_GT(fit.unknowns[0].log_sigma, 1e-3);
    EXPECT_LT(fit.unknowns[0].log_sigma, 2e-2);
  }
}

/// Linear least squares of 1 / EI in the beam's y = F s^2 (3 L - s) / (6 EI), sigma included.
TEST(Stiffness, SigmaOfTheCopperRodIsThatOfLinearLeastSquares) {
  PALPATE_NEEDS_SHARED("data/copper_rods");
  const std::vector<LoadCase> cases = copper_rod(true);
  double fy = 0.0, ff = 0.0, yy = 0.0;
  for (const ShapePoint& point : cases[0].points) {
    const double s = point.arc_length_m, f = cases[0].force_base_N.x() * s * s * (3.0 * 0.51 - s) / 6.0;
    fy += f * point.position_base_m.x(), ff += f * f, yy += std::pow(point.position_base_m.x(), 2);
  }
  const double compliance = fy / ff, variance = (yy - compliance * fy) / 19.0;
  const Catheter stated = test::catheter_of(uniform_rod(0.51, {30.0, 30.0, 20.0}, Vector3d::Zero()));
  const StiffnessFit fit = identify_stiffness(stated, cases, {.unknowns = Unknowns::kScale});
  EXPECT_NEAR(fit.rod.sections[0].stiffness_Nm2(0), 1.0 / compliance, 1e-3 / compliance);
  EXPECT_NEAR(fit.unknowns[0].log_sigma, std::sqrt(variance / ff) / compliance, 0.01 * fit.unknowns[0].log_sigma);
  EXPECT_NEAR(fit.point_sigma_m, std::sqrt(variance), 0.01 * fit.point_sigma_m);
}

}  // namespace
}  // namespace palpate
