// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <palpate/sensing/sensor_model.hpp>
#include <tests/random_draws.hpp>

namespace palpate {
namespace {

using test::Draws;
using Parameters = Eigen::Matrix<double, 6, 1>;  ///< turn (body side) and shift of the rod's local frame at the sensor

constexpr SensorKind kKinds[] = {SensorKind::kPose, SensorKind::kPose5, SensorKind::kPosition};

/// A sensor on a frame that the six parameters move directly: R exp(x_R), p + x_p.
struct Scene {
  Sensor sensor;
  Pose T_base_local, measured;

  Linearization at(const Parameters& x) const {
    RodPoint point;
    point.T_base_local = {T_base_local.R * Draws::turn(x.head<3>()), T_base_local.p + x.tail<3>()};
    RodPointTangent<6> tangent;
    tangent.rotation << Matrix3d::Identity(), Matrix3d::Zero();
    tangent.position_m << Matrix3d::Zero(), Matrix3d::Identity();
    Linearization out;
    out.residual.setZero(rows_of(sensor.kind));
    out.jacobian.setZero(rows_of(sensor.kind), 6);
    append_sensor_rows(sensor.kind, predict_sensor(sensor, point, tangent), measured, 0, out);
    return out;
  }
};

/// Residual turn of `angle_rad` about `axis` between prediction and measurement.
Scene scene_with(SensorKind kind, double angle_rad, const Vector3d& axis, Draws& draws) {
  Scene s;
  s.sensor.kind = kind;
  s.sensor.T_local_sensor = draws.pose(2e-3);
  s.T_base_local = draws.pose(0.07);
  const Pose predicted = s.T_base_local * s.sensor.T_local_sensor;
  s.measured = {predicted.R * Draws::turn(angle_rad * axis.normalized()), predicted.p + draws.in_ball(5e-3)};
  return s;
}

/// r(x + dx) = r(x) - J dx, central differences with step h: error h^2 r''' / 6, about 1e-8 for h = 1e-4 where the
/// third derivative is of order one to ten (it grows towards |r| = pi), rounding 1e-16 / h = 1e-12.
double jacobian_error(const Scene& s) {
  constexpr double h = 1e-4;
  const Linearization at = s.at(Parameters::Zero());
  double largest = 0.0;
  for (int j = 0; j < 6; ++j) {
    const Parameters dx = h * Parameters::Unit(j);
    const ResidualVector slope = (s.at(dx).residual - s.at(-dx).residual) / (2.0 * h);
    largest = std::max(largest, (slope + at.jacobian.col(j)).cwiseAbs().maxCoeff());
  }
  return largest;
}

TEST(SensorModel, RowsOfEachKind) {
  EXPECT_EQ(rows_of(SensorKind::kPose), 6);
  EXPECT_EQ(rows_of(SensorKind::kPose5), 5);
  EXPECT_EQ(rows_of(SensorKind::kPosition), 3);
}

TEST(SensorModel, JacobianEqualsCentralDifferencesUpToLargeResiduals) {
  Draws draws(11);
  for (const SensorKind kind : kKinds)
    for (const double angle_rad : {0.0, 1e-6, 1e-3, 0.1, 1.0, 2.0, 2.5})
      for (int i = 0; i < 20; ++i) {
        const Scene s = scene_with(kind, angle_rad, draws.normal3(), draws);
        EXPECT_LT(jacobian_error(s), 2e-6) << "kind " << static_cast<int>(kind) << ", " << angle_rad << " rad";
      }
}

/// Around the switch between series and closed form of acos(c) / sin(acos(c)), s^2 = 1e-8: sin = 1e-4.
TEST(SensorModel, Pose5HasNoJumpNearZeroAngle) {
  Draws draws(12);
  for (const double angle_rad : {1e-9, 0.9e-4, 0.999e-4, 1.001e-4, 1.1e-4, 2e-4}) {
    const Scene s = scene_with(SensorKind::kPose5, angle_rad, {0.6, -0.8, 0.0}, draws);
    const ResidualVector r = s.at(Parameters::Zero()).residual;
    EXPECT_NEAR(r(3), 0.6 * angle_rad, 1e-12);
    EXPECT_NEAR(r(4), -0.8 * angle_rad, 1e-12);
    EXPECT_LT(jacobian_error(s), 2e-6) << angle_rad;
  }
}

TEST(SensorModel, PoseResidualIsTheRotationVectorFromPredictedToMeasured) {
  Draws draws(13);
  for (int i = 0; i < 50; ++i) {
    const Vector3d vector = draws.in_ball(3.0);
    const Scene s = scene_with(SensorKind::kPose, vector.norm(), vector, draws);
    const ResidualVector r = s.at(Parameters::Zero()).residual;
    EXPECT_LT((r.segment<3>(3) - vector).norm(), 1e-11);
    EXPECT_LT((r.head<3>() - (s.measured.p - (s.T_base_local * s.sensor.T_local_sensor).p)).norm(), 1e-15);
  }
}

TEST(SensorModel, Pose5ResidualIsTheAngleBetweenTheAxesAndBlindToRoll) {
  Draws draws(14);
  for (int i = 0; i < 50; ++i) {
    Scene s = scene_with(SensorKind::kPose5, draws.uniform(0.0, 3.0), draws.normal3(), draws);
    const ResidualVector r = s.at(Parameters::Zero()).residual;
    const Matrix3d R_predicted = s.T_base_local.R * s.sensor.T_local_sensor.R;
    const double angle = std::acos(std::clamp(R_predicted.col(2).dot(s.measured.R.col(2)), -1.0, 1.0));
    EXPECT_NEAR(r.segment<2>(3).norm(), angle, 1e-9);
    s.measured.R = s.measured.R * Draws::turn({0.0, 0.0, draws.uniform(-3.0, 3.0)});
    EXPECT_LT((s.at(Parameters::Zero()).residual - r).norm(), 1e-12);
  }
}

TEST(SensorModel, Pose5StaysFiniteWhereTheAxesAreOpposite) {
  Draws draws(15);
  const Scene s = scene_with(SensorKind::kPose5, std::numbers::pi, Vector3d::UnitX(), draws);
  const Linearization at = s.at(Parameters::Zero());
  EXPECT_TRUE(at.residual.allFinite());
  EXPECT_TRUE(at.jacobian.allFinite());
}

TEST(SensorModel, PositionSensorIsBlindToItsOwnOrientation) {
  Draws draws(16);
  Scene s = scene_with(SensorKind::kPosition, 0.5, Vector3d::UnitY(), draws);
  const ResidualVector r = s.at(Parameters::Zero()).residual;
  s.measured.R = draws.rotation();
  EXPECT_EQ(s.at(Parameters::Zero()).residual, r);
}

}  // namespace
}  // namespace palpate
