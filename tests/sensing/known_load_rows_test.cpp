// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <palpate/sensing/shape_model.hpp>
#include <set>
#include <tests/sensing/shape_layouts.hpp>

/// Three more rows where the force is known: the newtons that tell a stiffness from a force.
namespace palpate {
namespace {

using test::Draws;

const Vector3d kForce_N{0.03, 0.02, -0.06}, kKnown_N{0.01, -0.04, 0.08};

KnownLoad known_load(bool in_base) {
  return {.present = true, .in_base = in_base, .force_N = kKnown_N, .sigma_N = 2e-3};
}

class KnownLoadRows : public test::ShapeModelOfLayout {
 protected:
  KnownLoadRows() { show(test::exact_frame(catheter_, kForce_N)); }
  void select(const KnownLoad& load, unsigned mask = test::kAllSensors) {
    model_.set_known_load(load);
    model_.select(measurement_, mask);
  }
};

TEST_P(KnownLoadRows, HoldTheKnownLessTheForceInNewtons) {
  Draws draws(41);
  for (int trial = 0; trial < 5; ++trial) {
    const StateVector x = test::drawn_state(parameters_, draws);
    const test::Reality real = test::reality_of(catheter_, parameters_, x);
    const Matrix3d R_base_tip = test::true_frame(real.catheter, real.load).T_base_tip.R;
    select(known_load(false));
    const Vector3d in_tip = at(x).residual.tail<3>(), F = real.load.force_tip_N;
    EXPECT_LT((in_tip - (kKnown_N - F)).norm(), 1e-15);
    select(known_load(true));
    const Vector3d in_base = at(x).residual.tail<3>();
    EXPECT_LT((in_base - (kKnown_N - R_base_tip * F)).norm(), 1e-8);
  }
}

TEST_P(KnownLoadRows, JacobianEqualsCentralDifferences) {
  Draws draws(42);
  for (const bool in_base : {false, true})
    for (int trial = 0; trial < 5; ++trial) {
      select(known_load(in_base));
      const StateVector x = test::drawn_state(parameters_, draws);
      test::expect_jacobian_is_difference(model_, x, test::typical_state(parameters_), 2e-5);
    }
}

/// Stiffnesses that grow together make newtons of the same f, which the shape does not show.
TEST_P(KnownLoadRows, TellTheScaleOfTheStiffness) {
  if (parameters_.find(ParameterKind::kLogStiffness, 0) < 0) return;  // stiffness is exact
  Draws draws(43);
  const StateVector x = test::drawn_state(parameters_, draws);
  select(known_load(false));
  StateVector scale = StateVector::Zero(x.size());
  for (int axis = 0; axis < 3; ++axis)
    if (const int i = parameters_.find(ParameterKind::kLogStiffness, axis); i >= 0) scale(3 + i) = 1.0;
  const ResidualVector slope = at(x).jacobian * scale;
  const Vector3d F = test::reality_of(catheter_, parameters_, x).load.force_tip_N;
  EXPECT_LT((slope.tail<3>() - F).norm(), 1e-14);
}

TEST_P(KnownLoadRows, HaveNoiseOfTheirOwn) {
  select({});
  ResidualMatrix without, with;
  model_.noise(without);
  select(known_load(true));
  model_.noise(with);
  const Eigen::Index n = without.rows();
  ASSERT_EQ(with.rows(), n + 3);
  EXPECT_EQ(ResidualMatrix(with.topLeftCorner(n, n)), without);
  EXPECT_TRUE(with.topRightCorner(n, 3).isZero(0.0));
  EXPECT_TRUE(with.bottomLeftCorner(3, n).isZero(0.0));
  EXPECT_TRUE(with.bottomRightCorner(3, 3).isApprox(4e-6 * Matrix3d::Identity(), 1e-14));
}

TEST_P(KnownLoadRows, LeaveTheOtherRowsAlone) {
  Draws draws(44);
  const StateVector x = test::drawn_state(parameters_, draws);
  select({});
  const Linearization without = at(x);
  select(known_load(true));
  const Linearization with = at(x);
  const Eigen::Index n = without.residual.size();
  ASSERT_EQ(with.residual.size(), n + 3);
  EXPECT_TRUE(with.residual.head(n).isApprox(without.residual, 1e-14));
  EXPECT_TRUE(with.jacobian.topRows(n).isApprox(without.jacobian, 1e-14));
}

TEST_P(KnownLoadRows, AreABlockWithChannelsOfItsOwn) {
  select({});
  const int n = model_.rows();
  std::vector<int> ends;
  for (int row = 0; row < n; ++row) ends.push_back(model_.block_end(row));
  select(known_load(false));
  ASSERT_EQ(model_.rows(), n + 3);
  ends.insert(ends.end(), 3, n + 3);
  std::set<int> channels;
  for (int row = 0; row < model_.rows(); ++row) {
    EXPECT_EQ(model_.block_end(row), ends[static_cast<std::size_t>(row)]) << row;
    channels.insert(model_.channels()[static_cast<std::size_t>(row)]);
  }
  EXPECT_EQ(static_cast<int>(channels.size()), n + 3);
  EXPECT_LT(*channels.rbegin(), ShapeModel::kChannels);
}

/// Errors of the poses are no errors of the force.
TEST_P(KnownLoadRows, DoNotMoveWithThePoses) {
  Catheter catheter = catheter_;
  catheter.base.position_sigma_m = catheter.base.rotation_sigma_rad = catheter.sensors[0].bias_rad = 1e-3;
  ShapeModel model(catheter, GetParam().kind, uncertain_parameters(catheter, {.consider = true}));
  model.set_known_load(known_load(true));
  model.select(measurement_, test::kAllSensors);
  PoseErrorMatrix B;
  model.pose_errors(B);
  ASSERT_EQ(B.rows(), model.rows());
  EXPECT_EQ(B.cols(), 9);
  EXPECT_TRUE(B.bottomRows(3).isZero(0.0));
  EXPECT_FALSE(B.topRows(6).isZero(0.0));
}

TEST_P(KnownLoadRows, ComeWithTheNextSelectionAndOnlyBesideASensor) {
  select({});
  const int n = model_.rows();
  model_.set_known_load(known_load(false));
  EXPECT_EQ(model_.rows(), n);
  model_.select(measurement_, test::kAllSensors);
  EXPECT_EQ(model_.rows(), n + 3);
  model_.select(measurement_, 0);
  EXPECT_EQ(model_.rows(), 0);
  EXPECT_EQ(model_.used(), 0U);
}

INSTANTIATE_TEST_SUITE_P(Every, KnownLoadRows, ::testing::ValuesIn(test::kLayouts),
                         [](const auto& test_case) { return std::string(test_case.param.name); });

}  // namespace
}  // namespace palpate
