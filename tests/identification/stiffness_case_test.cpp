// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>
#include <palpate/identification/stiffness_case.hpp>

#include "tests/identification/stiffness_setups.hpp"

/// Residuals of one case: their derivatives against central differences, and what own weight does to them.
namespace palpate {
namespace {

using namespace stiffness;
using OwnWeight = StiffnessOptions::OwnWeight;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

Rod heavy_rod(bool shears) {
  Rod rod = test::paper_catheter(12.0);
  rod.sections[0].to_m = 0.04;
  rod.sections.push_back({0.04, 0.07, {3e-4, 2e-4, 2e-4}, {5.0, -3.0, 1.0}, false});
  rod.rigid_tip_m = 0.005;
  rod.contact_offset_m = {0.001, 0.0, 0.004};
  rod.distributed_load_base_N_per_m = {0.3, -0.4, -0.6};
  if (shears) rod.shear_stiffness_N = 6.0, rod.axial_stiffness_N = 15.0;
  return rod;
}

LoadCase every_kind_of_point(bool orientation) {
  LoadCase one{.name = "all", .force_base_N = {0.04, 0.05, -0.02}, .points = {}};
  for (const double s : {0.01, 0.035, 0.07, 0.074}) {
    ShapePoint point;
    point.arc_length_m = s;
    point.T_local_sensor = {exp_so3(Vector3d(0.3, -0.2, 0.5)), {0.001, -0.002, 0.0005}};
    point.position_base_m = {0.01, 0.01, 0.03};
    point.sigma_m = {1e-3, 2e-3, 3e-3};
    point.sigma_rad = 0.1;
    if (orientation) point.R_base_sensor = exp_so3(Vector3d(0.2, 0.3, 0.1));
    one.points.push_back(point);
    point = {};
    point.arc_length_m = kUnknown;
    point.position_base_m = {0.0, kUnknown, 0.5 * s};
    point.sigma_m.setConstant(1e-3);
    one.points.push_back(point);
  }
  return one;
}

struct Evaluated {
  Eigen::VectorXd r;
  Eigen::Matrix<double, Eigen::Dynamic, kNumbers> by_q;
};

Evaluated evaluate(CaseModel& model, const Numbers& q) {
  Evaluated out{Eigen::VectorXd(model.rows()), {}};
  out.by_q.setZero(model.rows(), kNumbers);
  EXPECT_TRUE(model.evaluate(q, 1e-3, out.r, out.by_q, 1e-8));
  return out;
}

void check_derivatives(bool shears, OwnWeight own_weight) {
  const LoadCase one = every_kind_of_point(own_weight == OwnWeight::kIncluded);
  CaseModel model(heavy_rod(shears), one, own_weight,
                  {.shear = shears, .turn = true, .precurvature = true, .force = true}, {0.6, 0.0, 0.8});
  Numbers q;
  q << 0.1, -0.2, 0.15, (shears ? 0.3 : 0.0), 0.05, -0.04, 0.08, 0.001, 0.002, -0.001, 1.0, -2.0, 0.5, 0.01;
  Numbers h;
  h << Vector3d::Constant(1e-3), 1e-3, Vector3d::Constant(1e-3), Vector3d::Constant(1e-5), Vector3d::Constant(1e-1),
      1e-4;
  const Evaluated at = evaluate(model, q);
  for (int j = 0; j < kNumbers; ++j) {
    if (j == kLogShear && !shears) continue;
    const Numbers d = h(j) * Numbers::Unit(j);
    const Eigen::VectorXd difference = (evaluate(model, q + d).r - evaluate(model, q - d).r) / (2.0 * h(j));
    const double scale = at.by_q.col(j).cwiseAbs().maxCoeff();
    EXPECT_GT(scale, 0.0) << j;
    EXPECT_LT((difference - at.by_q.col(j)).cwiseAbs().maxCoeff(), 5e-5 * scale) << "number " << j;
  }
}

TEST(StiffnessCase, DerivativesAreThoseOfTheResiduals) {
  for (const bool shears : {false, true})
    for (const OwnWeight own_weight : {OwnWeight::kIncluded, OwnWeight::kSubtracted})
      check_derivatives(shears, own_weight);
}

/// A place found by z is the one with that arc length.
TEST(StiffnessCase, PlaceFoundByHeightIsThatOfTheArcLength) {
  const Rod rod = heavy_rod(false);
  LoadCase one = every_kind_of_point(true);
  CaseModel model(rod, one, OwnWeight::kIncluded, {}, Vector3d::Zero());
  evaluate(model, Numbers::Zero());
  const Vector3d known = model.points()[2].T_base_point * one.points[2].T_local_sensor.inverse().p;
  one.points[3].position_base_m = {0.0, kUnknown, known.z()};
  evaluate(model, Numbers::Zero());
  EXPECT_LT((model.points()[3].T_base_point.p - known).norm(), 1e-8);
}

/// Subtracted: measured = loaded - own weight alone + no load, each an equilibrium of its own.
TEST(StiffnessCase, SubtractedWeightGivesBackTheStiffnessOfTheHangingShaft) {
  Rod rod = test::paper_catheter(12.0);
  rod.distributed_load_base_N_per_m = {0.3, -0.4, -0.6};
  const std::vector<double> s = test::every_centimetre(rod);
  Rod weightless = rod;
  weightless.distributed_load_base_N_per_m.setZero();
  std::vector<LoadCase> hanging = test::hang(rod, {{0.04, 0.05, 0.0}, {0.05, -0.03, 0.02}}, s, 1e-6), points = hanging;
  const LoadCase own = test::hang(rod, {Vector3d::Zero()}, s, 1e-6)[0];
  const LoadCase none = test::hang(weightless, {Vector3d::Zero()}, s, 1e-6)[0];
  for (LoadCase& one : points)
    for (std::size_t i = 0; i < s.size(); ++i)
      one.points[i].position_base_m += none.points[i].position_base_m - own.points[i].position_base_m;
  Catheter stated = test::catheter_of(rod);
  test::scale_stiffness(stated.rod, {1.5, 1.5, 1.5});
  const StiffnessFit included = identify_stiffness(stated, hanging);
  const StiffnessFit subtracted = identify_stiffness(stated, points, {.own_weight = OwnWeight::kSubtracted});
  const StiffnessFit wrong = identify_stiffness(stated, points);
  for (int i = 0; i < 2; ++i) {
    EXPECT_LT(test::relative_error(included.unknowns[i], rod.sections[0].stiffness_Nm2(i)), 1e-5);
    EXPECT_LT(test::relative_error(subtracted.unknowns[i], rod.sections[0].stiffness_Nm2(i)), 1e-5);
    EXPECT_GT(test::relative_error(wrong.unknowns[i], rod.sections[0].stiffness_Nm2(i)), 1e-2);
  }
}

}  // namespace
}  // namespace palpate
