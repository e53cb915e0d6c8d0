// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <ostream>
#include <palpate/rod/relaxed_rod.hpp>
#include <tests/observer/allocation_counter.hpp>
#include <tests/random_draws.hpp>
#include <tests/rod/rod_cases.hpp>

namespace palpate {
namespace {

using test::Draws;
using Unknowns = RelaxedRod::Unknowns;
using Shape = RelaxedRod::Shape;

constexpr int kUnknowns = RelaxedRod::kUnknowns;

struct Loaded {
  Rod rod;
  TipLoad load;
};

Loaded uniform() { return {test::paper_catheter(30.0), {}}; }

/// Soft near the tip, a rigid stretch in the middle; four cells each, so that cells and sections have the same ends.
Loaded sectioned() {
  Loaded setup = uniform();
  const Section all = setup.rod.sections[0];
  Section hard = all, rigid = all, soft = all;
  hard.to_m = rigid.from_m = all.to_m / 3.0;
  rigid.to_m = soft.from_m = all.to_m * 2.0 / 3.0;
  rigid.rigid = true;
  rigid.precurvature_per_m = {5.0, -3.0, 2.0};
  soft.stiffness_Nm2 = 0.5 * all.stiffness_Nm2;
  setup.rod.sections = {hard, rigid, soft};
  return setup;
}

Loaded with_rigid_tip() {
  Loaded setup = uniform();
  setup.rod.rigid_tip_m = 0.006;
  return setup;
}

Loaded with_contact_offset() {
  Loaded setup = with_rigid_tip();
  setup.rod.contact_offset_m = {0.5e-3, -0.8e-3, 6e-3};
  return setup;
}

Loaded with_tip_moment() {
  Loaded setup = uniform();
  setup.load.moment_tip_Nm = {1.5e-3, -1e-3, 0.5e-3};
  return setup;
}

Loaded with_tendon_couple() {
  Loaded setup = uniform();
  setup.load.tendon_couple_Nm = {2e-3, 1e-3, 0.0};
  return setup;
}

/// The load changes the shaft; with a couple, whose curvature changes as well.
Loaded deviating(Loaded setup) {
  setup.load.tendon_couple_Nm = {1e-3, 0.5e-3, 0.0};
  setup.load.log_stiffness = {0.3, 0.1, -0.2};
  setup.load.precurvature_per_m = {-8.0, 5.0, 2.0};
  return setup;
}

Loaded with_deviation() { return deviating(with_contact_offset()); }
Loaded sectioned_with_deviation() { return deviating(sectioned()); }

struct Case {
  const char* name;
  std::function<Loaded()> make;

  friend void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }
};

const Case kCases[] = {
    {"uniform", uniform},
    {"sectioned", sectioned},
    {"rigid_tip", with_rigid_tip},
    {"contact_offset", with_contact_offset},
    {"tip_moment", with_tip_moment},
    {"tendon_couple", with_tendon_couple},
    {"deviation", with_deviation},
    {"sectioned_deviation", sectioned_with_deviation},
};

/// Ends, a cell's interior, a cell's boundary, the tip, and a place on the rigid tip where there is one.
std::vector<double> stations(const Rod& rod) {
  const double L = rod.length_m();
  return {0.0, 0.31 * L, 0.5 * L, 0.93 * L, L, L + 0.7 * rod.rigid_tip_m};
}

class RelaxedRodCase : public ::testing::TestWithParam<Case> {
 protected:
  Shape at(const Unknowns& z) const {
    Shape shape = relaxed_.make_shape();
    relaxed_.evaluate(setup_.load, z, shape);
    return shape;
  }
  Unknowns anywhere(Draws& draws) const {
    Unknowns z;
    for (int b = 0; b < RelaxedRod::kPowers; ++b) z.segment<3>(3 * b) = draws.normal3();
    z.tail<3>() = draws.in_ball(0.2);
    return z;
  }

  Loaded setup_ = GetParam().make();
  std::vector<double> stations_ = stations(setup_.rod);
  RelaxedRod relaxed_{setup_.rod, stations_};
};

/// log(R^T R_moved) without the code's own log: the skew part of a turn of 1e-5 rad, wrong by its cube.
Vector3d small_rotation(const Matrix3d& R, const Matrix3d& R_moved) {
  const Matrix3d E = R.transpose() * R_moved;
  return 0.5 * Vector3d(E(2, 1) - E(1, 2), E(0, 2) - E(2, 0), E(1, 0) - E(0, 1));
}

/// Columns by central differences at h = 1e-5 of an unknown's scale (1 rad, 0.1 N); the truncation is h^2 = 1e-10 of
/// the column times its own third derivative (a few units), rounding 1e-16 / 1e-5 = 1e-11 of the outputs: 1e-8 of the
/// larger of the column and its outputs' unit is safe by an order, and a hundred times below any term left out.
TEST_P(RelaxedRodCase, TangentsEqualCentralDifferences) {
  Draws draws(101);
  const double length_m = setup_.rod.length_m();
  for (int trial = 0; trial < 10; ++trial) {
    const Unknowns z = anywhere(draws);
    const Shape here = at(z);
    for (int j = 0; j < kUnknowns; ++j) {
      const double scale = j < 9 ? 1.0 : 0.1, h = 1e-5 * scale;
      const Shape more = at(z + h * Unknowns::Unit(j)), less = at(z - h * Unknowns::Unit(j));
      const auto defect = ((more.defect - less.defect) / (2.0 * h)).eval();
      const auto exact = here.defect_by_unknown.col(j);
      EXPECT_LT(scale * (defect - exact).cwiseAbs().maxCoeff(), 1e-8 * (1.0 + scale * exact.cwiseAbs().maxCoeff()));
      for (std::size_t k = 0; k < stations_.size(); ++k) {
        const Pose &A = less.curve.points[k].T_base_local, &B = more.curve.points[k].T_base_local;
        const Vector3d slope_m = (B.p - A.p) / (2.0 * h);
        const Vector3d turn = small_rotation(A.R, B.R) / (2.0 * h);
        const RodPointTangent<kUnknowns>& tangent = here.curve.tangents[k];
        EXPECT_LT(scale * (slope_m - tangent.position_m.col(j)).norm(), 1e-8 * length_m) << j << ", station " << k;
        EXPECT_LT(scale * (turn - tangent.rotation.col(j)).norm(), 1e-8) << j << ", station " << k;
      }
    }
  }
}

/// The curve that start() recommends, against the solver's at its reference accuracy, in a ball of 1.5 buckling loads.
/// Two errors: the midpoint rule on 12 cells, and a cubic in place of the curvature. Measured: 0.70 % of the length and
/// 0.016 rad at worst, below the loosened sigmas that the curve is compared with (L / 70, 0.02 rad), which is all a
/// start needs. The defect, 0.03-0.05 rad and 0.094 where sections jump in stiffness, is what no cubic can follow.
TEST_P(RelaxedRodCase, StartIsNearTheEquilibriumUnderItsForce) {
  Draws draws(102);
  const double length_m = setup_.rod.length_m();
  double worst_position = 0.0, worst_angle = 0.0, worst_defect = 0.0;
  for (int trial = 0; trial < 100; ++trial) {
    TipLoad load = setup_.load;
    load.force_tip_N = draws.in_ball(1.5 * relaxed_.buckling_force_N());
    Shape started = relaxed_.make_shape();
    const Unknowns z = relaxed_.start(load, started);
    EXPECT_EQ(Vector3d(z.tail<3>()), load.force_tip_N);
    const Shape shape = at(z);
    const RodSolution<0> exact = test::solve(setup_.rod, load, stations_);
    worst_defect = std::max(worst_defect, shape.defect.norm());
    for (std::size_t k = 0; k < stations_.size(); ++k) {
      const Pose& T = exact.points[k].T_base_local;
      for (const Shape& coarse : {shape, started}) {
        const Pose& C = coarse.curve.points[k].T_base_local;
        worst_position = std::max(worst_position, (C.p - T.p).norm() / length_m);
        worst_angle = std::max(worst_angle, (C.R - T.R).norm() / std::sqrt(2.0));  // rad where small
      }
    }
  }
  RecordProperty("worst_position", std::to_string(worst_position));
  RecordProperty("worst_angle", std::to_string(worst_angle));
  RecordProperty("worst_defect", std::to_string(worst_defect));
  EXPECT_LT(worst_position, 0.010);
  EXPECT_LT(worst_angle, 0.020);
  EXPECT_LT(worst_defect, 0.120);
}

/// Without a tip force and a free moment nothing bends but precurvature and couple, constant in each cell: exact for
/// any number of steps, as all sections end where cells do. (A free tip moment alone turns with the shaft.)
TEST_P(RelaxedRodCase, NoLoadLeavesTheShaftAsItIsMade) {
  setup_.load.moment_tip_Nm.setZero();
  const Shape shape = at(Unknowns::Zero());
  EXPECT_LT(shape.defect.norm(), 1e-14);
  const RodSolution<0> exact = test::solve(setup_.rod, setup_.load, stations_);
  for (std::size_t k = 0; k < stations_.size(); ++k) {
    const Pose &C = shape.curve.points[k].T_base_local, &T = exact.points[k].T_base_local;
    EXPECT_LT((C.R - T.R).norm(), 1e-6);
    // the chord of a cell of 0.175 rad stands for its arc: a share of 0.175^2 / 24 = 0.13 % of the length is missing
    EXPECT_LT((C.p - T.p).norm(), 3e-3 * setup_.rod.length_m()) << k;
  }
  Shape started = relaxed_.make_shape();
  EXPECT_LT(relaxed_.start(setup_.load, started).norm(), 1e-14);
}

TEST_P(RelaxedRodCase, NothingIsAllocated) {
  Shape shape = relaxed_.make_shape();
  const test::CountAllocations count;
  const Unknowns z = relaxed_.start(setup_.load, shape);
  relaxed_.evaluate(setup_.load, z, shape);
  EXPECT_EQ(count.so_far(), 0U);
}

TEST_P(RelaxedRodCase, StartLeavesTheDefectAndNoTangents) {
  Draws draws(104);
  Shape shape = at(anywhere(draws));
  const auto defect = shape.defect;
  relaxed_.start(setup_.load, shape);
  EXPECT_EQ(shape.defect, defect);
  for (const RodPointTangent<kUnknowns>& tangent : shape.curve.tangents)
    EXPECT_TRUE(tangent.rotation.isZero(0.0) && tangent.position_m.isZero(0.0));
}

INSTANTIATE_TEST_SUITE_P(Every, RelaxedRodCase, ::testing::ValuesIn(kCases),
                         [](const auto& test_case) { return std::string(test_case.param.name); });

Shape straight_shape(const RelaxedRod& relaxed, const TipLoad& load, const Vector3d& force_tip_N) {
  Shape shape = relaxed.make_shape();
  Unknowns z = Unknowns::Zero();
  z.tail<3>() = force_tip_N;
  relaxed.evaluate(load, z, shape);
  return shape;
}

/// On a straight shaft the moment of the weight is sigma^2 / 2 w, that of the force sigma F: the defect, by hand. The
/// centroid of each half cell of the midpoint rule lies where it should, so that rounding is the only error.
TEST(RelaxedRod, WeightEntersTheDefectAsItsMoment) {
  const double EI1 = 2e-4, EI2 = 3e-4, length_m = 0.08, w1 = -0.4, w2 = 0.3, F1 = 0.05, F2 = -0.02;
  const RelaxedRod relaxed(uniform_rod(length_m, {EI1, EI2, 1e-4}, Vector3d::Zero()), std::vector{length_m});
  const TipLoad load{.distributed_tip_N_per_m = {w1, w2, 0.7}};
  const Shape shape = straight_shape(relaxed, load, {F1, F2, 0.0});
  const double scale = length_m / std::sqrt(static_cast<double>(RelaxedRod::kCells));
  for (int i = 0; i < RelaxedRod::kCells; ++i) {
    const double sigma = (i + 0.5) * length_m / RelaxedRod::kCells;
    const double m1 = -(sigma * F2 + 0.5 * sigma * sigma * w2), m2 = sigma * F1 + 0.5 * sigma * sigma * w1;
    const Vector3d expected = -scale * Vector3d(m1 / EI1, m2 / EI2, 0.0);
    EXPECT_LT((shape.defect.segment<3>(3 * i) - expected).norm(), 1e-14) << i;
  }
}

/// The oracle with weight on a bent shaft: RodSolver takes the same load in tip components.
TEST(RelaxedRod, StartBendsUnderItsWeightAsTheSolverDoes) {
  const Rod rod = test::paper_catheter(10.0);
  const std::vector<double> tip{rod.length_m()};
  const RelaxedRod relaxed(rod, tip);
  const TipLoad load{.force_tip_N = {0.01, 0.02, -0.03}, .distributed_tip_N_per_m = {0.3, -0.6, 0.2}};
  TipLoad weightless = load;
  weightless.distributed_tip_N_per_m.setZero();
  Shape shape = relaxed.make_shape();
  const Unknowns z = relaxed.start(load, shape);
  const Vector3d p = test::solve(rod, load, tip).T_base_tip.p;
  const double bent_m = (p - test::solve(rod, weightless, tip).T_base_tip.p).norm();
  EXPECT_GT(bent_m, 5e-3);
  EXPECT_LT((shape.curve.T_base_tip.p - p).norm(), 0.1 * bent_m);
  relaxed.evaluate(load, z, shape);
  EXPECT_LT(shape.defect.norm(), 0.05);
}

/// A station beyond the flexible end is carried by the tip frame.
TEST(RelaxedRod, StationOnTheRigidTipLiesStraightAheadOfTheTip) {
  const Rod rod = with_rigid_tip().rod;
  const double L = rod.length_m(), beyond_m = 0.004;
  const RelaxedRod relaxed(rod, std::vector{L + beyond_m, L});
  Draws draws(103);
  Unknowns z;
  for (int i = 0; i < kUnknowns; ++i) z(i) = (i < 9 ? 1.0 : 0.1) * draws.normal();
  Shape shape = relaxed.make_shape();
  relaxed.evaluate({}, z, shape);
  const Pose &tip = shape.curve.T_base_tip, &end = shape.curve.points[1].T_base_local;
  const Pose& station = shape.curve.points[0].T_base_local;
  EXPECT_LT((end.R - tip.R).norm() + (end.p - tip.p).norm(), 1e-15);
  EXPECT_LT((station.R - tip.R).norm(), 1e-15);
  EXPECT_LT((station.p - (tip.p + beyond_m * tip.R.col(2))).norm(), 1e-15);
  const auto &at_end = shape.curve.tangents[1], &at_station = shape.curve.tangents[0];
  const Eigen::Matrix<double, 3, kUnknowns> swept =
      at_end.position_m - beyond_m * tip.R * hat(Vector3d::UnitZ()) * at_end.rotation;
  EXPECT_LT((at_station.position_m - swept).norm(), 1e-14);
}

/// pi^2 EI / (4 L^2), Euler's column clamped at one end, by hand.
TEST(RelaxedRod, BucklingForceIsEulers) {
  const RelaxedRod relaxed(uniform_rod(0.1, {1e-4, 3e-4, 1e-4}, Vector3d::Zero()), std::vector{0.1});
  EXPECT_NEAR(relaxed.buckling_force_N(), 9.8696044 * 2e-4 / 0.04, 1e-8);
}

TEST(RelaxedRod, ShaftThatIsAllRigidStaysAsItIsAndFinite) {
  Rod rod = test::paper_catheter(30.0);
  rod.sections[0].rigid = true;
  const RelaxedRod relaxed(rod, stations(rod));
  EXPECT_EQ(relaxed.buckling_force_N(), 0.0);
  Shape shape = relaxed.make_shape();
  const Unknowns z = relaxed.start({.force_tip_N = {0.1, 0.2, -0.3}}, shape);
  relaxed.evaluate({}, z, shape);
  EXPECT_EQ(shape.defect.norm(), 0.0);
  EXPECT_LT((z.head<9>().norm()), 1e-15);
  EXPECT_TRUE(shape.curve.T_base_tip.p.allFinite());
}

}  // namespace
}  // namespace palpate
