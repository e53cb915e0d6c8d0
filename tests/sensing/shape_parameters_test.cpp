// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <palpate/sensing/shape_model.hpp>
#include <tests/observer/allocation_counter.hpp>
#include <tests/sensing/shape_layouts.hpp>

/// ShapeModel with uncertain parameters that bend the rod: x = (f, p_rod).
namespace palpate {
namespace {

using test::Draws;
using test::Layout;
using Kind = ParameterKind;

using ShapeParameters = test::ShapeModelOfLayout;

TEST_P(ShapeParameters, StateIsTheForceAndWhatBendsTheRod) {
  EXPECT_EQ(model_.states(), 3 + parameters_.rod_count);
  show(test::exact_frame(catheter_, Vector3d::Zero()));
  EXPECT_EQ(at(StateVector::Zero(model_.states())).jacobian.cols(), model_.states());
}

/// Readings of the other catheter leave no residual at x. Both solve to 1e-8 of the length and as much in angle;
/// curvature divides that by 4.7 mm.
TEST_P(ShapeParameters, PredictionIsThatOfACatheterWithOtherNumbers) {
  Draws draws(31);
  const double angle_rad = 2e-8, curvature_per_m = 2.0 * angle_rad / 4.7e-3;
  for (int trial = 0; trial < 20; ++trial) {
    const StateVector x = test::drawn_state(parameters_, draws);
    const test::Reality real = test::reality_of(catheter_, parameters_, x);
    const test::TrueFrame seen = test::true_frame(real.catheter, real.load);
    show(seen.frame);
    const ResidualVector r = at(x).residual;
    const bool curvature = GetParam().kind == MeasurementKind::kTipAndCurvature;
    EXPECT_LT(r.head(6).cwiseAbs().maxCoeff(), angle_rad);
    EXPECT_LT(r.tail(r.size() - 6).cwiseAbs().maxCoeff(), curvature ? curvature_per_m : angle_rad);
    EXPECT_LT((model_.T_base_tip().p - seen.T_base_tip.p).norm(), 1e-9);
    EXPECT_LT((model_.T_base_tip().R - seen.T_base_tip.R).norm(), angle_rad);
  }
}

TEST_P(ShapeParameters, JacobianEqualsCentralDifferences) {
  Draws draws(32);
  for (int trial = 0; trial < 10; ++trial) {
    show(test::exact_frame(catheter_, draws.in_ball(0.12)));
    const StateVector x = test::drawn_state(parameters_, draws);
    test::expect_jacobian_is_difference(model_, x, test::typical_state(parameters_), 2e-5);
  }
}

/// All stiffnesses and, where there is one, the tendon's scale: nothing but newtons could tell.
StateVector common_scale(const UncertainParameters& parameters) {
  StateVector direction = StateVector::Zero(3 + parameters.rod_count);
  for (int i = 0; i < parameters.rod_count; ++i) {
    const Kind kind = parameters.all[static_cast<std::size_t>(i)].kind;
    if (kind == Kind::kLogStiffness || kind == Kind::kTendonScale) direction(3 + i) = 1.0;
  }
  return direction;
}

/// Rounding alone: 1e-12 of residuals up to 1 (m, rad), of curvatures up to 100 1/m.
TEST_P(ShapeParameters, ShapeDoesNotTellTheScaleOfStiffnessForceAndTendonTogether) {
  const bool scaled = parameters_.find(Kind::kLogStiffness, 0) >= 0;
  const bool tendon = catheter_.tendon.present, newtons = catheter_.rod.has_distributed_load();
  if (!scaled || (tendon && parameters_.find(Kind::kTendonScale, 0) < 0)) return;  // no such scale
  const StateVector scale = common_scale(parameters_);
  Draws draws(33);
  show(test::exact_frame(catheter_, {0.02, -0.03, -0.05}));
  for (int trial = 0; trial < 10; ++trial) {
    const StateVector x = test::drawn_state(parameters_, draws);
    const Linearization here = at(x), there = at(x + draws.uniform(0.2, 0.4) * scale);
    const double size = 1.0 + here.residual.cwiseAbs().maxCoeff();
    const double change = (there.residual - here.residual).cwiseAbs().maxCoeff();
    const double slope = (here.jacobian * scale).cwiseAbs().maxCoeff();
    if (newtons) {  // the shaft's weight is one
      EXPECT_GT(change, 1e-4);
      EXPECT_GT(slope, 1e-4);
      continue;
    }
    EXPECT_LT(change, 1e-12 * size);
    EXPECT_LT(slope, 1e-12 * here.jacobian.rightCols(parameters_.rod_count).cwiseAbs().maxCoeff());
  }
}

/// A tendon that keeps its newton metres, or a stiffness that goes alone, does show.
TEST(ShapeParameters, TheScaleOfStiffnessAloneShowsAgainstATendon) {
  const Catheter catheter = test::with_all(TendonModel::kCouple, test::two_sensors());
  const UncertainParameters parameters = uncertain_parameters(catheter, {.consider = true, .free_torsion = true});
  ShapeModel model(catheter, MeasurementKind::kPoses, parameters);
  model.set_tendon_moment(test::kTendonReading_Nm);
  Measurement measurement;
  register_frame(catheter, test::exact_frame(catheter, {0.02, -0.03, -0.05}), measurement);
  model.select(measurement, test::kAllSensors);
  StateVector scale = common_scale(parameters), x = StateVector::Zero(model.states());
  x.head<3>() << 0.02, -0.03, -0.05;
  Linearization here;
  ASSERT_TRUE(model.linearize(x, here));
  scale(3 + parameters.find(Kind::kTendonScale, 0)) = 0.0;
  EXPECT_GT((here.jacobian * scale).cwiseAbs().maxCoeff(), 1e-3);
}

Vector3d first_seed(ShapeModel& model, StateVector x) {
  Linearization unused;
  int work = 0;
  EXPECT_TRUE(model.linearize(x, unused) && model.seed(0, x, work));
  return x.head<3>();
}

/// A model without parameters, of the catheter with the other numbers, begins at the same force, in newtons. Both are
/// rough, and what counts as an absurd force follows the file's stiffness; a scale left out is wrong by up to 0.03 N.
TEST_P(ShapeParameters, SeedsAreForcesAsTheStateCountsThem) {
  Draws draws(34);
  for (int trial = 0; trial < 10; ++trial) {
    const StateVector x = test::drawn_state(parameters_, draws);
    const test::Reality real = test::reality_of(catheter_, parameters_, x);
    show(test::true_frame(real.catheter, real.load).frame);
    ShapeModel plain(real.catheter, GetParam().kind, {}, Accuracy::kReference);
    plain.set_tendon_moment((real.load.tendon_couple_Nm + real.load.moment_tip_Nm).head<2>());
    plain.select(measurement_, test::kAllSensors);
    const Vector3d F = real.load.force_tip_N, newtons = F.cwiseQuotient(Vector3d(x.head<3>()));
    const Vector3d expected = first_seed(plain, F);
    EXPECT_LT((newtons.cwiseProduct(first_seed(model_, x)) - expected).norm(), 1e-3 + (expected - F).norm());
  }
}

TEST_P(ShapeParameters, NothingAllocates) {
  Draws draws(35);
  show(test::exact_frame(catheter_, {0.02, -0.03, -0.05}));
  const StateVector x = test::drawn_state(parameters_, draws);
  Linearization out;
  ResidualMatrix R;
  PoseErrorMatrix B;
  const test::CountAllocations allocations;
  model_.set_tendon_moment({1e-3, 0.0});
  model_.set_known_load({.present = true, .in_base = true, .force_N = {0.0, 0.0, -0.1}, .sigma_N = 1e-3});
  model_.select(measurement_, test::kAllSensors);
  const bool solved = model_.linearize(x, out);
  model_.noise(R);
  model_.pose_errors(B);
  EXPECT_EQ(allocations.so_far(), 0U);
  EXPECT_TRUE(solved);
  EXPECT_EQ(out.jacobian.rows(), B.rows());
}

INSTANTIATE_TEST_SUITE_P(Every, ShapeParameters, ::testing::ValuesIn(test::kLayouts),
                         [](const auto& test_case) { return std::string(test_case.param.name); });

/// Most sensors, most parameters: what the fixed capacities must hold.
TEST(ShapeParametersLimits, EverythingUncertainOfEightSensorsFits) {
  Catheter catheter = test::with_all(TendonModel::kCouple, test::with_tracked_base(test::eight_sensors()));
  catheter.base.position_sigma_m = catheter.base.rotation_sigma_rad = 1e-3;
  for (Sensor& sensor : catheter.sensors) sensor.mount_sigma_m = sensor.bias_m = sensor.bias_rad = 1e-3;
  const UncertainParameters all =
      uncertain_parameters(catheter, {.consider = true, .estimate_stiffness = true, .free_torsion = true});
  EXPECT_EQ(all.rod_count, UncertainParameters::kMaxRod);
  ASSERT_EQ(all.pose_count(), kMaxPoseParameters);
  ShapeModel model(catheter, MeasurementKind::kPoses, all);
  Measurement measurement;
  register_frame(catheter, test::exact_frame(catheter, Vector3d::Zero()), measurement);
  model.set_known_load({.present = true, .in_base = false, .force_N = Vector3d::Zero(), .sigma_N = 1e-3});
  Linearization out;
  ResidualMatrix R;
  PoseErrorMatrix B;
  const test::CountAllocations allocations;
  model.select(measurement, test::kAllSensors);
  const bool solved = model.linearize(StateVector::Zero(model.states()), out);
  model.noise(R);
  model.pose_errors(B);
  EXPECT_EQ(allocations.so_far(), 0U);
  EXPECT_TRUE(solved);
  EXPECT_EQ(B.rows(), 6 * kMaxSensors + 3);
  EXPECT_EQ(B.cols(), all.pose_count());
}

/// Nothing bends such a shaft, but it is a valid one.
TEST(ShapeParametersLimits, AShaftWithoutAFlexibleSectionIsPredicted) {
  Catheter catheter = test::two_sensors();
  catheter.rod.sections = {{0.0, 0.07, Stiffness::Zero(), {30.0, 0.0, 0.0}, true}};
  ShapeModel model(catheter, MeasurementKind::kPoses);
  Measurement measurement;
  register_frame(catheter, test::exact_frame(catheter, Vector3d::Zero()), measurement);
  model.select(measurement, test::kAllSensors);
  Linearization out;
  ASSERT_TRUE(model.linearize(Vector3d(0.1, 0.0, 0.0), out));
  EXPECT_LT(out.residual.cwiseAbs().maxCoeff(), 1e-9);
}

}  // namespace
}  // namespace palpate
