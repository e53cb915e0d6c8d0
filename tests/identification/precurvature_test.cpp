// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <palpate/identification/precurvature.hpp>
#include <palpate/math/errors.hpp>
#include <tests/sensing/virtual_setups.hpp>

/// The arc of an unloaded shaft, against closed forms and against the noise it claims.
namespace palpate {
namespace {

using test::Draws;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

/// A shaft of constant u = (k1, k2, tau) without load: R = exp(s u), p = s J_l(s u) e3.
Pose helix(const Vector3d& u, double s) { return {exp_so3(s * u), s * right_jacobian(-s * u) * Vector3d::UnitZ()}; }

Catheter shaft() {
  Catheter catheter = test::bare_catheter();
  for (Section& section : catheter.rod.sections) section.precurvature_per_m.setZero();
  catheter.sensors = {test::sensor_at("tip", 0.07), test::sensor_at("shaft", 0.0653)};
  return catheter;
}

/// Markers 1 cm apart from the clamp on.
ArcData markers(const Vector3d& u, double spacing_m = 0.01) {
  ArcData data;
  for (int i = 0; i * spacing_m < 0.0701; ++i) data.points.push_back({i * spacing_m, helix(u, i * spacing_m).p});
  return data;
}

ArcData with_noise(ArcData data, double sigma_m, Draws& draws) {
  for (ShaftPoint& point : data.points) point.position_m += sigma_m * draws.normal3();
  return data;
}

ArcData poses(const Catheter& catheter, const Vector3d& u, const Pose& T_frame_base = {}) {
  ArcData data;
  for (const Sensor& sensor : catheter.sensors)
    data.poses.push_back({T_frame_base * helix(u, sensor.arc_length_m) * sensor.T_local_sensor, 200, 0});
  return data;
}

std::string refusal(const Catheter& catheter, const ArcData& data, ClampKnowledge clamp = ClampKnowledge::kExact) {
  try {
    fit_arc(catheter, data, clamp);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Precurvature, FindsTheCircleInEitherPlane) {
  // k1 > 0 turns the tangent from d3 towards -d2.
  const double k = 39.99;
  ArcData data;
  for (int i = 0; i <= 7; ++i) {
    const double s = 0.01 * i;
    data.points.push_back({s, {0.0, -(1.0 - std::cos(k * s)) / k, std::sin(k * s) / k}});
  }
  const ArcFit fit = fit_arc(shaft(), data);
  EXPECT_TRUE(fit.converged);
  EXPECT_NEAR(fit.precurvature_per_m.x() / k, 1.0, 1e-9);
  EXPECT_NEAR(fit.precurvature_per_m.y() / k, 0.0, 1e-9);
  EXPECT_LT(fit.rms_m, 1e-11);
  for (const Vector3d& u : {Vector3d(0.0, 25.0, 0.0), Vector3d(-30.0, 12.0, 0.0), Vector3d(5.0, -60.0, 0.0)})
    EXPECT_LT((fit_arc(shaft(), markers(u)).precurvature_per_m - u).norm() / u.norm(), 1e-9) << u.transpose();
}

TEST(Precurvature, PosesTellTheTwistAsWell) {
  const Vector3d u(33.0, -8.0, 4.0);
  const Catheter catheter = test::mounted(shaft());
  const ArcFit fit = fit_arc(catheter, poses(catheter, u));
  EXPECT_LT((fit.precurvature_per_m - u).norm() / u.norm(), 1e-9);
  EXPECT_TRUE(fit.told[0] && fit.told[1] && fit.told[2]);
  EXPECT_FALSE(fit_arc(shaft(), markers({33.0, -8.0, 0.0})).told[2]);
  EXPECT_THAT(fit_arc(shaft(), markers({33.0, -8.0, 0.0})).warnings,
              Contains(HasSubstr("tau0 is not told without orientations: it was kept at 0 1/m")));
}

TEST(Precurvature, FreeClampMayStandAnywhere) {
  const Pose elsewhere = test::some_pose();
  for (const double k : {38.0, -22.0, 70.0}) {
    ArcData data = markers({k, 0.0, 0.0});
    for (ShaftPoint& point : data.points) point.position_m = elsewhere * point.position_m;
    const ArcFit fit = fit_arc(shaft(), data, ClampKnowledge::kFree);
    EXPECT_TRUE(fit.converged);
    EXPECT_NEAR(fit.precurvature_per_m.head<2>().norm() / std::abs(k), 1.0, 1e-9);
    EXPECT_LT((fit.T_frame_base.p - elsewhere.p).norm(), 1e-9);
    EXPECT_THAT(fit.warnings, Contains(HasSubstr("do not tell the bending plane")));
  }
  for (const Vector3d& kept : {Vector3d(5.0, 0.0, 0.0), Vector3d(-3.0, 4.0, 0.0)}) {
    Catheter catheter = shaft();
    catheter.rod.sections[0].precurvature_per_m = kept;
    const Vector3d found = fit_arc(catheter, markers({38.0, 0.0, 0.0}), ClampKnowledge::kFree).precurvature_per_m;
    EXPECT_LT((found - 38.0 * kept.normalized()).norm(), 1e-6);  // plane and sense are the file's
  }
  const Vector3d u(33.0, -8.0, 4.0);
  const ArcFit fit = fit_arc(shaft(), poses(shaft(), u, elsewhere), ClampKnowledge::kFree);
  EXPECT_LT((fit.precurvature_per_m - u).norm(), 1e-6);
  EXPECT_LT((fit.T_frame_base.R - elsewhere.R).norm(), 1e-8);
}

TEST(Precurvature, PictureFromOneSideTellsOneBend) {
  for (const ClampKnowledge clamp : {ClampKnowledge::kExact, ClampKnowledge::kFree}) {
    ArcData data = markers({28.0, 0.0, 0.0});
    for (ShaftPoint& point : data.points) point.position_m.x() = std::nan("");
    const ArcFit fit = fit_arc(shaft(), data, clamp);
    EXPECT_NEAR(fit.precurvature_per_m.x() / 28.0, 1.0, 1e-9);
    EXPECT_TRUE(fit.told[0]);
    EXPECT_FALSE(fit.told[1]);
  }
}

/// A stated clamp error is one more reason for the sigma.
TEST(Precurvature, IntervalsCoverAndFalseAlarmsAreRare) {
  constexpr double kNoise_m = 0.28e-3;
  constexpr int kSeeds = 200;
  const Vector3d u(39.99, 3.0, 0.0);
  struct Case {
    const char* name;
    bool stated;
    ClampKnowledge clamp;
  };
  for (const Case& c : {Case{"sigma stated", true, ClampKnowledge::kExact},
                        Case{"sigma told by the residuals", false, ClampKnowledge::kExact},
                        Case{"clamp stated", true, ClampKnowledge::kStated}}) {
    Catheter catheter = shaft();
    catheter.base.position_sigma_m = 0.3e-3;
    catheter.base.rotation_sigma_rad = 0.3 * kRadiansPerDegree;
    Draws draws(71);
    int inside = 0, alarms = 0;
    for (int seed = 0; seed < kSeeds; ++seed) {
      ArcData data = with_noise(markers(u), kNoise_m, draws);
      if (c.clamp == ClampKnowledge::kStated) {
        const Pose error{draws.small_turn(catheter.base.rotation_sigma_rad), 0.3e-3 * draws.normal3()};
        for (ShaftPoint& point : data.points) point.position_m = error * point.position_m;
      }
      if (c.stated) data.point_sigma_m = kNoise_m;
      const ArcFit fit = fit_arc(catheter, data, c.clamp);
      for (int axis = 0; axis < 2; ++axis)
        inside += std::abs(fit.precurvature_per_m(axis) - u(axis)) <=
                  fit.interval_factor * std::sqrt(fit.covariance(axis, axis));
      alarms += fit.warnings.size() > 1;  // that tau0 is not told is always one
    }
    std::printf("%s: 95 %% intervals cover %.1f %%, %d false alarms in %d\n", c.name, 50.0 * inside / kSeeds, alarms,
                kSeeds);
    EXPECT_GE(inside, 2 * kSeeds * 0.92) << c.name;
    EXPECT_LE(inside, 2 * kSeeds * 0.98) << c.name;
    EXPECT_LE(alarms, 3) << c.name;  // of 400 tests at 1e-3
  }
}

/// From a file that says straight: two sensors near the tip see a turn by more than half as one the other way round.
TEST(Precurvature, FindsABendByMoreThanHalfATurn) {
  Catheter catheter = shaft();
  catheter.base.position_sigma_m = 0.3e-3;
  catheter.base.rotation_sigma_rad = 0.3 * kRadiansPerDegree;
  for (const Vector3d& u : {Vector3d(55.0, 0.0, 0.0), Vector3d(0.0, -62.0, 0.0), Vector3d(-40.0, 40.0, 0.0)}) {
    const ArcFit fit = fit_arc(catheter, poses(catheter, u), ClampKnowledge::kStated);
    EXPECT_FALSE(fit.doubtful) << u.transpose();
    EXPECT_LT((fit.precurvature_per_m - u).norm(), 1e-3) << u.transpose();
  }
}

TEST(Precurvature, IntervalsOfPosesCover) {
  Catheter catheter = shaft();
  catheter.base.position_sigma_m = 0.3e-3;
  catheter.base.rotation_sigma_rad = 0.3 * kRadiansPerDegree;
  const Vector3d u(39.99, 3.0, 1.0);
  Draws draws(5);
  int inside = 0;
  constexpr int kSeeds = 200, kFrames = 4;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const Pose error{draws.small_turn(catheter.base.rotation_sigma_rad), 0.3e-3 * draws.normal3()};
    ArcData data = poses(catheter, u, error);
    for (std::size_t i = 0; i < data.poses.size(); ++i) {
      const Sensor& sensor = catheter.sensors[i];
      MeanPose& pose = data.poses[i];
      pose.count = kFrames;
      pose.T_base_sensor.p += sensor.noise_m.cwiseProduct(draws.normal3()) / std::sqrt(kFrames);
      pose.T_base_sensor.R = pose.T_base_sensor.R * draws.small_turn(sensor.noise_rad / std::sqrt(kFrames));
    }
    const ArcFit fit = fit_arc(catheter, data, ClampKnowledge::kStated);
    for (int axis = 0; axis < 3; ++axis)
      inside += std::abs(fit.precurvature_per_m(axis) - u(axis)) <= 1.959964 * std::sqrt(fit.covariance(axis, axis));
  }
  std::printf("poses: 95 %% intervals cover %.1f %%\n", 100.0 * inside / (3 * kSeeds));
  EXPECT_GE(inside, 3 * kSeeds * 0.92);
  EXPECT_LE(inside, 3 * kSeeds * 0.98);
}

/// Curvature 30 1/m at the clamp, 50 1/m at the end: points by small steps of the rotation.
TEST(Precurvature, BendThatIsNoArcIsSaidToBeNone) {
  const auto grow = [](double noise_m, double sigma_m) {
    Draws draws(3);
    ArcData data;
    data.point_sigma_m = sigma_m;
    Pose T;
    constexpr int kSteps = 7000;
    for (int i = 0; i <= kSteps; ++i) {
      const double s = 0.07 * i / kSteps, ds = 0.07 / kSteps;
      if (i % 1000 == 0) data.points.push_back({s, T.p + noise_m * draws.normal3()});
      const Vector3d u(30.0 + 20.0 * (s + 0.5 * ds) / 0.07, 0.0, 0.0);
      T = T * helix(u, ds);
    }
    return data;
  };
  for (const double sigma_m : {0.0, 0.1e-3}) {
    const ArcFit fit = fit_arc(shaft(), grow(0.1e-3, sigma_m));
    EXPECT_THAT(fit.warnings, Contains(HasSubstr("no constant arc"))) << sigma_m;
    EXPECT_NEAR(fit.change_along_per_m.x(), 20.0, 2.0);
  }
  const ArcFit fit = fit_arc(shaft(), with_noise(markers({40.0, 0.0, 0.0}), 0.1e-3, *std::make_unique<Draws>(3)));
  EXPECT_THAT(fit.warnings, Not(Contains(HasSubstr("no constant arc"))));
}

/// The rod under its own weight is the oracle's; that weight matters is told by leaving it out.
TEST(Precurvature, OwnWeightIsNotTakenForBend) {
  Catheter heavy = test::with_own_weight(shaft());
  const Vector3d u(35.0, -4.0, 0.0);
  Catheter bent = heavy;
  bent.rod.sections[0].precurvature_per_m = u;
  bent.sensors.clear();
  for (int i = 0; i < 8; ++i) bent.sensors.push_back(test::sensor_at("m" + std::to_string(i), 0.01 * i));
  bent.base.T_tracker_base = {};
  ArcData data;
  const TrackerFrame frame = test::exact_frame(bent, Vector3d::Zero());
  for (int i = 0; i < 8; ++i) data.points.push_back({0.01 * i, frame.readings[static_cast<std::size_t>(i)].position_m});
  EXPECT_LT((fit_arc(heavy, data).precurvature_per_m - u).norm(), 1e-6);
  EXPECT_GT((fit_arc(shaft(), data).precurvature_per_m - u).norm(), 0.3);
}

TEST(Precurvature, StraightShaftHasNoPlane) {
  Draws draws(8);
  ArcData data = with_noise(markers(Vector3d::Zero()), 0.1e-3, draws);
  data.point_sigma_m = 0.1e-3;
  const ArcFit fit = fit_arc(shaft(), data);
  EXPECT_LT(fit.precurvature_per_m.norm(), 0.5);
  EXPECT_THAT(fit.warnings, Contains(HasSubstr("straight within its sigma")));
  const ArcFit exact = fit_arc(shaft(), markers(Vector3d::Zero()), ClampKnowledge::kFree);
  EXPECT_LT(exact.precurvature_per_m.norm(), 1e-5);
}

TEST(Precurvature, RefusesWhatCannotBe) {
  const Vector3d u(39.99, 0.0, 0.0);
  ArcData metres = markers(u), outside = markers(u), few = markers(u), swapped = markers(u), holes = markers(u);
  for (ShaftPoint& point : metres.points) point.position_m *= 1e-3;
  EXPECT_THAT(refusal(shaft(), metres),
              HasSubstr("expected distances that fit the arc lengths (are the positions in metres?)"));
  for (ShaftPoint& point : outside.points) point.arc_length_m *= 1000.0;
  EXPECT_THAT(refusal(shaft(), outside), HasSubstr("point 2: arc length = 10000 mm: expected 0..70 mm"));
  few.points.resize(1);
  EXPECT_THAT(refusal(shaft(), few), HasSubstr("expected more points or sensors"));
  EXPECT_THAT(refusal(shaft(), ArcData{}), HasSubstr("expected more points or sensors"));
  few = markers(u);
  few.points.resize(2);
  EXPECT_THAT(refusal(shaft(), few, ClampKnowledge::kFree), HasSubstr("6 numbers were measured for 7 unknowns"));
  std::swap(swapped.points[1].arc_length_m, swapped.points[5].arc_length_m);
  EXPECT_THAT(refusal(shaft(), swapped), HasSubstr("expected at most the arc between them"));
  holes.points[3].position_m.y() = std::nan("");
  EXPECT_THAT(refusal(shaft(), holes), HasSubstr("point 4: expected the same components"));
  Catheter two = shaft();
  two.rod.sections = {two.rod.sections[0], two.rod.sections[0]};
  two.rod.sections[0].to_m = two.rod.sections[1].from_m = 0.03;
  two.rod.sections[1].precurvature_per_m = {10.0, 0.0, 0.0};
  EXPECT_THAT(refusal(two, markers(u)), HasSubstr("section 2: precurvature_per_m differs"));
}

}  // namespace
}  // namespace palpate
