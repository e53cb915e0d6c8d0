// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <functional>
#include <ostream>
#include <palpate/math/errors.hpp>
#include <palpate/sensing/shape_model.hpp>
#include <set>
#include <tests/sensing/virtual_setups.hpp>

/// One conformance suite for every measurement kind and sensor mix.
namespace palpate {
namespace {

using test::Draws;

struct Case {
  const char* name;
  MeasurementKind kind;
  std::function<Catheter()> make;

  friend void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }
};

const Case kCases[] = {
    {"poses", MeasurementKind::kPoses, [] { return test::two_sensors(); }},
    {"pose5", MeasurementKind::kPoses, [] { return test::two_sensors(SensorKind::kPose5); }},
    {"position", MeasurementKind::kPoses, [] { return test::two_sensors(SensorKind::kPosition); }},
    {"mixed", MeasurementKind::kPoses, test::mixed_sensors},
    {"mounted", MeasurementKind::kPoses, [] { return test::mounted(test::two_sensors()); }},
    {"tracked_base", MeasurementKind::kPoses, [] { return test::with_tracked_base(test::mixed_sensors()); }},
    {"own_weight", MeasurementKind::kPoses, [] { return test::with_own_weight(test::two_sensors()); }},
    {"two_trackers", MeasurementKind::kPoses, [] { return test::with_second_tracker(test::mixed_sensors()); }},
    {"tracked_base_two_trackers", MeasurementKind::kPoses,
     [] { return test::with_second_tracker(test::with_tracked_base(test::two_sensors())); }},
    {"tip_and_curvature_two_trackers", MeasurementKind::kTipAndCurvature,
     [] { return test::with_second_tracker(test::mounted(test::two_sensors())); }},
    {"tip_and_curvature", MeasurementKind::kTipAndCurvature, [] { return test::two_sensors(); }},
    {"tip_and_curvature_mounted", MeasurementKind::kTipAndCurvature, [] { return test::mounted(test::two_sensors()); }},
    {"tip_and_curvature_tracked_base", MeasurementKind::kTipAndCurvature,
     [] { return test::with_tracked_base(test::mounted(test::two_sensors())); }},
    {"tip_and_curvature_own_weight", MeasurementKind::kTipAndCurvature,
     [] { return test::with_own_weight(test::two_sensors()); }},
};

constexpr unsigned kAll = 0xff;

class ShapeModelConformance : public ::testing::TestWithParam<Case> {
 protected:
  void show(const TrackerFrame& frame, unsigned mask = kAll) { show(catheter_, frame, mask); }
  void show(const Catheter& catheter, const TrackerFrame& frame, unsigned mask = kAll) {
    register_frame(catheter, frame, measurement_);
    model_.select(measurement_, mask);
  }
  Linearization at(const Vector3d& force_tip_N) {
    Linearization out;
    EXPECT_TRUE(model_.linearize(force_tip_N, out));
    return out;
  }

  Catheter catheter_ = GetParam().make();
  ShapeModel model_{catheter_, GetParam().kind, {}, Accuracy::kReference};
  Measurement measurement_;
};

/// Central differences with h = 1e-4 N. Residuals bend by about 10 J per newton at 0.1 N, so that h^2 r''' / 6 is below
/// 1e-6 J; rounding is 1e-13 / h = 1e-9, curvature rows (divided by 4.7 mm) two hundred times that.
TEST_P(ShapeModelConformance, JacobianEqualsCentralDifferences) {
  constexpr double h = 1e-4;
  Draws draws(21);
  for (int trial = 0; trial < 10; ++trial) {
    show(test::exact_frame(catheter_, draws.in_ball(0.15)));
    const Vector3d x = draws.in_ball(0.15);
    const Linearization here = at(x);
    for (int j = 0; j < 3; ++j) {
      const Vector3d dx = h * Vector3d::Unit(j);
      const ResidualVector slope = (at(x + dx).residual - at(x - dx).residual) / (2.0 * h);
      const double scale = here.jacobian.col(j).cwiseAbs().maxCoeff();
      EXPECT_LT((slope + here.jacobian.col(j)).cwiseAbs().maxCoeff(), 2e-5 * scale + 1e-8);
    }
  }
}

TEST_P(ShapeModelConformance, ExactReadingsLeaveNoResidual) {
  Draws draws(22);
  for (const Vector3d& force : {Vector3d(0.0, 0.0, 0.0), draws.in_ball(0.15), draws.in_ball(0.15)}) {
    show(test::exact_frame(catheter_, force));
    EXPECT_LT(at(force).residual.cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST_P(ShapeModelConformance, MovingBaseAndReadingsTogetherChangesNoResidual) {
  Draws draws(23);
  const TrackerFrame frame = test::exact_frame(catheter_, {0.02, -0.03, -0.08});
  const Vector3d x(0.01, 0.0, -0.05);
  show(frame);
  const Linearization here = at(x);
  const Pose move = draws.pose(1.0);
  show(test::moved(move, catheter_), test::moved(move, frame));
  const Linearization there = at(x);
  EXPECT_LT((there.residual - here.residual).cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_LT((there.jacobian - here.jacobian).cwiseAbs().maxCoeff(), 1e-11);
}

/// The residuals of 20000 frames with the noise that the catheter states. An entry of a sample covariance scatters by
/// sqrt((R_ii R_jj + R_ij^2) / n); 5 of that is passed by one entry in two million. The noise is small enough for the
/// linear formula (0.17 deg: second order 0.3 %, squared into the covariance 1e-5).
TEST_P(ShapeModelConformance, NoiseIsTheSampleCovarianceOfResiduals) {
  constexpr int kFrames = 20000;
  const Vector3d force(0.03, 0.02, -0.06);
  const TrackerFrame exact = test::exact_frame(catheter_, force);
  show(exact);
  ResidualMatrix R;
  model_.noise(R);
  Draws draws(24);
  ResidualMatrix sum = ResidualMatrix::Zero(model_.rows(), model_.rows());
  for (int i = 0; i < kFrames; ++i) {
    show(test::with_noise(catheter_, exact, draws));
    const ResidualVector r = at(force).residual;
    sum += r * r.transpose();
  }
  for (int i = 0; i < R.rows(); ++i)
    for (int j = 0; j < R.cols(); ++j) {
      const double scatter = std::sqrt((R(i, i) * R(j, j) + R(i, j) * R(i, j)) / kFrames);
      EXPECT_NEAR(sum(i, j) / kFrames, R(i, j), 5.0 * scatter) << "rows " << i << ", " << j;
    }
}

TEST_P(ShapeModelConformance, NoiseIsSymmetricPositiveDefiniteForEveryMask) {
  const TrackerFrame frame = test::exact_frame(catheter_, {0.03, 0.02, -0.06});
  for (unsigned mask = 0; mask < 1U << catheter_.sensors.size(); ++mask) {
    show(frame, mask);
    ResidualMatrix R;
    model_.noise(R);
    ASSERT_EQ(R.rows(), model_.rows());
    ASSERT_EQ(R.cols(), model_.rows());
    if (model_.rows() == 0) continue;
    EXPECT_TRUE(R.isApprox(R.transpose(), 1e-15));
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(R).eigenvalues()(0), 0.0);
  }
}

TEST_P(ShapeModelConformance, EachRowHasAChannelOfItsOwnThatStaysWhenOtherSensorsLeave) {
  const TrackerFrame frame = test::exact_frame(catheter_, Vector3d::Zero());
  show(frame);
  const auto channels_now = [&] {
    return std::set<int>(model_.channels().begin(), model_.channels().begin() + model_.rows());
  };
  const std::set<int> all = channels_now();
  EXPECT_EQ(static_cast<int>(all.size()), model_.rows());
  EXPECT_GE(*all.begin(), 0);
  EXPECT_LT(*all.rbegin(), ShapeModel::kChannels);
  show(frame, 0b01);
  const std::set<int> tip = channels_now();
  EXPECT_TRUE(std::includes(all.begin(), all.end(), tip.begin(), tip.end()));
}

TEST_P(ShapeModelConformance, ForceThatIsNotFiniteIsRefused) {
  show(test::exact_frame(catheter_, Vector3d::Zero()));
  Linearization out;
  EXPECT_FALSE(model_.linearize(Vector3d(0.0, std::nan(""), 0.0), out));
  EXPECT_FALSE(model_.linearize(Vector3d(std::numeric_limits<double>::infinity(), 0.0, 0.0), out));
}

TEST(ShapeModel, PapersVectorWantsAFullPoseAtTheTip) {
  Catheter catheter = test::two_sensors();
  catheter.sensors[0].kind = SensorKind::kPose5;
  EXPECT_THROW(ShapeModel(catheter, MeasurementKind::kTipAndCurvature), InputError);
}

INSTANTIATE_TEST_SUITE_P(Every, ShapeModelConformance, ::testing::ValuesIn(kCases),
                         [](const auto& test_case) { return std::string(test_case.param.name); });

TEST(ShapeModel, MaskSelectsSensorsOfRawPoses) {
  const Catheter catheter = test::mixed_sensors();
  ShapeModel model(catheter, MeasurementKind::kPoses);
  Measurement m;
  register_frame(catheter, test::exact_frame(catheter, Vector3d::Zero()), m);
  const int rows[] = {6, 5, 3};
  for (unsigned mask = 0; mask < 8; ++mask) {
    model.select(m, mask);
    int expected = 0;
    for (unsigned i = 0; i < 3; ++i) expected += mask >> i & 1U ? rows[i] : 0;
    EXPECT_EQ(model.rows(), expected);
    EXPECT_EQ(model.used(), mask);
  }
}

TEST(ShapeModel, TheRowsThatAMaskLeavesAreThoseOfTheFullMeasurement) {
  const Catheter catheter = test::mixed_sensors();
  ShapeModel model(catheter, MeasurementKind::kPoses);
  Measurement m;
  register_frame(catheter, test::exact_frame(catheter, {0.01, 0.03, -0.08}), m);
  Linearization full, part;
  model.select(m, 0b111);
  ASSERT_TRUE(model.linearize(Vector3d::Zero(), full));
  model.select(m, 0b110);
  ASSERT_TRUE(model.linearize(Vector3d::Zero(), part));
  EXPECT_EQ(part.residual, ResidualVector(full.residual.tail(8)));
  EXPECT_EQ(part.jacobian, JacobianMatrix(full.jacobian.bottomRows(8)));
}

TEST(ShapeModel, PapersVectorNeedsTheTipAndDropsTheCurvatureWithoutTheSecondSensor) {
  Catheter catheter = test::mixed_sensors();
  std::swap(catheter.sensors[0], catheter.sensors[2]);  // order in the file does not matter, nor do other kinds
  catheter.sensors.push_back(test::sensor_at("shaft", 0.06));
  ShapeModel model(catheter, MeasurementKind::kTipAndCurvature);
  Measurement m;
  register_frame(catheter, test::exact_frame(catheter, Vector3d::Zero()), m);
  const auto select = [&](unsigned mask) {
    model.select(m, mask);
    return std::pair(model.rows(), model.used());
  };
  EXPECT_EQ(select(0b1111), std::pair(9, 0b1100U));
  EXPECT_EQ(select(0b0111), std::pair(6, 0b0100U));
  EXPECT_EQ(select(0b1011), std::pair(0, 0U));
  EXPECT_EQ(select(0), std::pair(0, 0U));
}

/// A tracked base's noise cancels in the curvature where both share it, and would not where one does.
TEST(ShapeModel, PapersVectorRefusesOneSensorOnATrackedBaseAndOneBeside) {
  const Catheter mixed = test::with_second_tracker(test::with_tracked_base(test::two_sensors()));
  EXPECT_THROW(ShapeModel(mixed, MeasurementKind::kTipAndCurvature), InputError);
  EXPECT_NO_THROW(ShapeModel(mixed, MeasurementKind::kPoses));
  EXPECT_NO_THROW(ShapeModel(test::with_second_tracker(test::two_sensors()), MeasurementKind::kTipAndCurvature));
}

TEST(ShapeModel, PapersVectorRefusesSensorsThatCannotGiveIt) {
  Catheter points = test::two_sensors(SensorKind::kPose5);
  EXPECT_THROW(ShapeModel(points, MeasurementKind::kTipAndCurvature), InputError);
  Catheter together = test::two_sensors();
  together.sensors[1].arc_length_m = together.sensors[0].arc_length_m;
  EXPECT_THROW(ShapeModel(together, MeasurementKind::kTipAndCurvature), InputError);
}

/// For constant K a couple m_t is the precurvature K^-1 m_t; an end moment is not, once a force bends the shaft.
TEST(ShapeModel, TendonCoupleActsAsPrecurvatureAndEndMomentDoesNot) {
  Catheter catheter = test::two_sensors();
  const Vector3d force(0.05, 0.05, -0.1);
  const TrackerFrame frame = test::exact_frame(catheter, force);
  Measurement m;
  register_frame(catheter, frame, m);
  const double k1 = catheter.rod.sections[0].precurvature_per_m.x();
  const double EI1 = catheter.rod.sections[0].stiffness_Nm2.x();
  catheter.rod.sections[0].precurvature_per_m.setZero();
  const auto residual_with = [&](TendonModel tendon) {
    catheter.tendon = {.present = true, .model = tendon};
    ShapeModel model(catheter, MeasurementKind::kPoses, {}, Accuracy::kReference);
    model.set_tendon_moment({EI1 * k1, 0.0});
    model.select(m, kAll);
    Linearization at;
    EXPECT_TRUE(model.linearize(force, at));
    return at.residual.head<3>().norm();
  };
  EXPECT_LT(residual_with(TendonModel::kCouple), 1e-9);
  EXPECT_GT(residual_with(TendonModel::kEndMoment), 1e-3);
}

}  // namespace
}  // namespace palpate
