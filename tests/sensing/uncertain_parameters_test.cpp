// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <palpate/sensing/uncertain_parameters.hpp>
#include <tests/sensing/virtual_setups.hpp>
#include <tuple>

/// From the catheter file's sigmas to one vector of uncertain parameters.
namespace palpate {
namespace {

using Kind = ParameterKind;
using Label = std::tuple<Kind, int, int>;  // kind, axis, sensor

constexpr double kForever = std::numeric_limits<double>::infinity();
constexpr double kPerAxis = 0.57735026918962576;  // 1 / sqrt(3)

/// A pose, a pose5 and a position sensor, every number uncertain.
Catheter stated() {
  Catheter catheter = test::mixed_sensors();
  catheter.stiffness_sigma_fraction = 0.05;
  catheter.precurvature_sigma_per_m = {0.6, 0.5, 0.4};
  catheter.tendon = {.present = true, .model = TendonModel::kCouple, .offset_m = 1e-3, .moment_sigma_fraction = 0.1};
  catheter.base.position_sigma_m = 0.3e-3;
  catheter.base.rotation_sigma_rad = 5e-3;
  for (Sensor& sensor : catheter.sensors) {
    sensor.mount_sigma_m = 0.2e-3;
    sensor.bias_m = 0.48e-3;
    sensor.bias_rad = 8e-3;
  }
  return catheter;
}

std::vector<Label> labels(const UncertainParameters& parameters) {
  std::vector<Label> out;
  for (const UncertainParameter& p : parameters.all) out.emplace_back(p.kind, p.axis, p.sensor);
  return out;
}

double sigma_of(const UncertainParameters& parameters, Kind kind, int axis, int sensor = -1) {
  const int i = parameters.find(kind, axis, sensor);
  return i < 0 ? 0.0 : std::sqrt(parameters.covariance(i, i));
}

Eigen::MatrixXd correlations(const UncertainParameters& parameters) {
  const Eigen::VectorXd scale = parameters.covariance.diagonal().cwiseSqrt().cwiseInverse();
  return scale.asDiagonal() * parameters.covariance * scale.asDiagonal();
}

double correlation(const UncertainParameters& parameters, const Label& a, const Label& b) {
  const auto index = [&](const Label& l) { return parameters.find(std::get<0>(l), std::get<1>(l), std::get<2>(l)); };
  EXPECT_GE(std::min(index(a), index(b)), 0);
  return correlations(parameters)(index(a), index(b));
}

double least_eigenvalue(const UncertainParameters& parameters) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(correlations(parameters)).eigenvalues()(0);
}

void expect_kind(const UncertainParameters& parameters, Kind kind, double memory_s, bool estimated, double drive) {
  for (const UncertainParameter& p : parameters.all) {
    if (p.kind != kind) continue;
    EXPECT_EQ(p.memory_s, memory_s);
    EXPECT_EQ(p.estimated, estimated);
    EXPECT_EQ(p.drive, drive);
  }
}

TEST(UncertainParameters, WhatBendsTheRodComesFirstThenThePosesThenTheRate) {
  const UncertainParameters p =
      uncertain_parameters(stated(), {.consider = true, .estimate_stiffness = true, .free_torsion = true});
  std::vector<Label> expected = {
      {Kind::kLogStiffness, 0, -1}, {Kind::kLogStiffness, 1, -1}, {Kind::kLogStiffness, 2, -1},
      {Kind::kPrecurvature, 0, -1}, {Kind::kPrecurvature, 1, -1}, {Kind::kPrecurvature, 2, -1},
      {Kind::kTendonScale, 0, -1},  {Kind::kTendonMoment, 0, -1}, {Kind::kTendonMoment, 1, -1}};
  EXPECT_EQ(p.rod_count, UncertainParameters::kMaxRod);
  for (const Kind kind : {Kind::kBasePosition, Kind::kBaseRotation})
    for (int axis = 0; axis < 3; ++axis) expected.emplace_back(kind, axis, -1);
  for (int sensor = 0; sensor < 3; ++sensor)
    for (const Kind kind : {Kind::kMountPosition, Kind::kSensorPosition, Kind::kSensorRotation})
      for (int axis = 0; axis < 3 && !(sensor == 2 && kind == Kind::kSensorRotation); ++axis)
        expected.emplace_back(kind, axis, sensor);  // a point has no orientation to be wrong
  expected.emplace_back(Kind::kStiffnessRate, 0, -1);
  EXPECT_EQ(labels(p), expected);
  EXPECT_EQ(p.size(), 9 + 6 + 9 + 9 + 6 + 1);
  EXPECT_EQ(p.pose_count(), p.size() - 9);
  EXPECT_FALSE(p.torsion_tied);
  EXPECT_EQ(p.covariance.rows(), p.size());
}

TEST(UncertainParameters, SigmasAreThoseOfTheFileAxisByAxis) {
  const UncertainParameters p = uncertain_parameters(stated(), {.consider = true});
  EXPECT_TRUE(p.torsion_tied);
  EXPECT_EQ(p.find(Kind::kLogStiffness, 2), -1);
  const Vector3d precurvature(0.6, 0.5, 0.4);
  for (int axis = 0; axis < 3; ++axis) {
    if (axis < 2) {
      EXPECT_DOUBLE_EQ(sigma_of(p, Kind::kLogStiffness, axis), 0.05);
      EXPECT_DOUBLE_EQ(sigma_of(p, Kind::kTendonMoment, axis), kLeastTendonNoise_Nm);
    }
    EXPECT_DOUBLE_EQ(sigma_of(p, Kind::kPrecurvature, axis), precurvature(axis));
    EXPECT_DOUBLE_EQ(sigma_of(p, Kind::kBasePosition, axis), 0.3e-3);
    EXPECT_DOUBLE_EQ(sigma_of(p, Kind::kBaseRotation, axis), 5e-3);
    for (int sensor = 0; sensor < 3; ++sensor) {
      EXPECT_DOUBLE_EQ(sigma_of(p, Kind::kMountPosition, axis, sensor), 0.2e-3);
      EXPECT_DOUBLE_EQ(sigma_of(p, Kind::kSensorPosition, axis, sensor), kPerAxis * 0.48e-3);
      if (sensor < 2) {
        EXPECT_DOUBLE_EQ(sigma_of(p, Kind::kSensorRotation, axis, sensor), kPerAxis * 8e-3);
      }
    }
  }
  EXPECT_DOUBLE_EQ(sigma_of(p, Kind::kTendonScale, 0), 0.1);
  EXPECT_EQ(p.find(Kind::kStiffnessRate, 0), -1);
}

TEST(UncertainParameters, MemoriesAndDrives) {
  Catheter catheter = stated();
  catheter.bias_memory_s = 45.0;
  const ParameterChoice estimate{.consider = true,
                                 .estimate_stiffness = true,
                                 .estimate_precurvature = true,
                                 .stiffness_rate_per_s = 0.007,
                                 .stiffness_drift_per_sqrt_s = 0.002,
                                 .precurvature_drift_per_m_sqrt_s = 0.03};
  const UncertainParameters p = uncertain_parameters(catheter, estimate);
  expect_kind(p, Kind::kLogStiffness, kForever, true, 0.002);
  for (int axis = 0; axis < 3; ++axis) {  // torsion is never estimated
    const UncertainParameter& k = p.all[static_cast<std::size_t>(p.find(Kind::kPrecurvature, axis))];
    EXPECT_EQ(std::tuple(k.memory_s, k.estimated, k.drive), std::tuple(kForever, axis < 2, axis < 2 ? 0.03 : 0.0));
  }
  for (const Kind kind : {Kind::kTendonScale, Kind::kBasePosition, Kind::kBaseRotation, Kind::kMountPosition})
    expect_kind(p, kind, kForever, false, 0.0);
  for (const Kind kind : {Kind::kSensorPosition, Kind::kSensorRotation}) expect_kind(p, kind, 45.0, false, 0.0);
  expect_kind(p, Kind::kTendonMoment, 0.0, false, 0.0);
  expect_kind(p, Kind::kStiffnessRate, 60.0, true, 0.0);
  EXPECT_DOUBLE_EQ(sigma_of(p, Kind::kStiffnessRate, 0), 0.007);
  for (const Kind kind : {Kind::kLogStiffness, Kind::kPrecurvature})
    expect_kind(uncertain_parameters(catheter, {.consider = true}), kind, kForever, false, 0.0);
}

TEST(UncertainParameters, WithoutConsideringOnlyTheEstimatedAndTheTendonNoiseStay) {
  const std::vector<Label> noise = {{Kind::kTendonMoment, 0, -1}, {Kind::kTendonMoment, 1, -1}};
  EXPECT_EQ(labels(uncertain_parameters(stated(), {})), noise);
  Catheter without_tendon = stated();
  without_tendon.tendon.present = false;
  EXPECT_EQ(uncertain_parameters(without_tendon, {}).size(), 0);
  EXPECT_EQ(
      labels(uncertain_parameters(without_tendon, {.estimate_stiffness = true})),
      (std::vector<Label>{{Kind::kLogStiffness, 0, -1}, {Kind::kLogStiffness, 1, -1}, {Kind::kStiffnessRate, 0, -1}}));
  EXPECT_EQ(labels(uncertain_parameters(without_tendon, {.estimate_precurvature = true})),
            (std::vector<Label>{{Kind::kPrecurvature, 0, -1}, {Kind::kPrecurvature, 1, -1}}));
}

TEST(UncertainParameters, AFileWithoutSigmasLeavesNothingButWhatIsToBeEstimated) {
  const Catheter silent = test::mixed_sensors();
  EXPECT_EQ(uncertain_parameters(silent, {.consider = true}).size(), 0);
  const UncertainParameters p = uncertain_parameters(
      silent, {.consider = true, .estimate_stiffness = true, .free_torsion = true, .estimate_precurvature = true});
  EXPECT_EQ(p.rod_count, 5);
  for (int axis = 0; axis < 3; ++axis) EXPECT_DOUBLE_EQ(sigma_of(p, Kind::kLogStiffness, axis), 0.2);
  for (int axis = 0; axis < 2; ++axis) EXPECT_DOUBLE_EQ(sigma_of(p, Kind::kPrecurvature, axis), 5.0);
}

/// Once a file states one precurvature sigma, its zeros mean exact.
TEST(UncertainParameters, APlaneCurveStaysPlane) {
  Catheter catheter = test::two_sensors();
  catheter.precurvature_sigma_per_m = {0.6, 0.0, 0.0};
  const UncertainParameters p = uncertain_parameters(catheter, {.estimate_precurvature = true});
  EXPECT_EQ(labels(p), (std::vector<Label>{{Kind::kPrecurvature, 0, -1}}));
  EXPECT_DOUBLE_EQ(sigma_of(p, Kind::kPrecurvature, 0), 0.6);
}

TEST(UncertainParameters, ATrackedBaseAddsItsBiasToTheClamps) {
  Catheter catheter = test::with_tracked_base(stated());
  catheter.base.sensor.bias_m = 0.6e-3;
  catheter.base.sensor.bias_rad = 9e-3;
  const UncertainParameters p = uncertain_parameters(catheter, {.consider = true});
  EXPECT_NEAR(sigma_of(p, Kind::kBasePosition, 1), std::sqrt(0.09e-6 + 0.12e-6), 1e-12);
  EXPECT_NEAR(sigma_of(p, Kind::kBaseRotation, 2), std::sqrt(25e-6 + 27e-6), 1e-12);
  catheter.base.tracked = false;  // what the file says of a sensor that is not there
  EXPECT_DOUBLE_EQ(sigma_of(uncertain_parameters(catheter, {.consider = true}), Kind::kBasePosition, 1), 0.3e-3);
}

TEST(UncertainParameters, NoSensorMeasuredFromTheClampMeansNoClampError) {
  Catheter catheter = stated();
  for (Sensor& sensor : catheter.sensors) sensor.T_tracker_base = test::some_pose();
  const UncertainParameters p = uncertain_parameters(catheter, {.consider = true});
  EXPECT_EQ(p.find(Kind::kBasePosition, 0), -1);
  EXPECT_EQ(p.find(Kind::kBaseRotation, 0), -1);
  EXPECT_GE(p.find(Kind::kMountPosition, 0, 0), 0);
}

TEST(UncertainParameters, StiffnessesShareTheirErrorAndNeighboursTheirBias) {
  Catheter catheter = stated();
  const ParameterChoice all{.consider = true, .free_torsion = true};
  const UncertainParameters p = uncertain_parameters(catheter, all);
  for (const auto& [i, j] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2)})
    EXPECT_NEAR(correlation(p, {Kind::kLogStiffness, i, -1}, {Kind::kLogStiffness, j, -1}), 0.9, 1e-14);
  // l = 50 mm: over 4.7 mm exp(-0.0047^2 / (2 0.05^2)) = 0.99559, over 35 mm 0.78270; 1e-4 less for definiteness.
  const Label tip{Kind::kSensorPosition, 1, 0}, needle{Kind::kSensorPosition, 1, 1},
      marker{Kind::kSensorPosition, 1, 2};
  EXPECT_NEAR(correlation(p, tip, needle), 0.99559, 1.1e-4);
  EXPECT_NEAR(correlation(p, tip, marker), 0.78270, 1.1e-4);
  EXPECT_NEAR(correlation(p, {Kind::kSensorRotation, 2, 0}, {Kind::kSensorRotation, 2, 1}), 0.99559, 1.1e-4);
  EXPECT_EQ(correlation(p, tip, {Kind::kSensorPosition, 0, 1}), 0.0);
  EXPECT_EQ(correlation(p, tip, {Kind::kSensorRotation, 1, 1}), 0.0);
  EXPECT_EQ(correlation(p, {Kind::kMountPosition, 0, 0}, {Kind::kMountPosition, 0, 1}), 0.0);
  EXPECT_EQ(correlation(p, {Kind::kPrecurvature, 0, -1}, {Kind::kPrecurvature, 1, -1}), 0.0);
  const UncertainParameters two = uncertain_parameters(test::with_second_tracker(catheter), all);
  EXPECT_EQ(correlation(two, tip, marker), 0.0);
  EXPECT_NEAR(correlation(two, tip, needle), 0.99559, 1.1e-4);
}

/// As correlations: the variances themselves span eighteen orders of magnitude.
TEST(UncertainParameters, CovarianceIsDefiniteEvenWithSensorsInOnePlace) {
  const ParameterChoice all{.consider = true, .estimate_stiffness = true, .free_torsion = true};
  Catheter catheter = stated();
  EXPECT_GT(least_eigenvalue(uncertain_parameters(catheter, all)), 1e-5);
  catheter.stiffness_correlation = 0.999;
  for (Sensor& sensor : catheter.sensors) sensor.arc_length_m = 0.07;
  const UncertainParameters together = uncertain_parameters(catheter, all);
  EXPECT_GT(correlation(together, {Kind::kSensorPosition, 0, 0}, {Kind::kSensorPosition, 0, 2}), 0.999);
  EXPECT_GT(least_eigenvalue(together), 1e-5);
  EXPECT_EQ(together.covariance.llt().info(), Eigen::Success);
  EXPECT_EQ(together.covariance, together.covariance.transpose());
}

TEST(UncertainParameters, FindGivesTheIndexOrNothing) {
  const UncertainParameters p = uncertain_parameters(stated(), {.consider = true});
  for (int i = 0; i < p.size(); ++i) {
    const UncertainParameter& one = p.all[static_cast<std::size_t>(i)];
    EXPECT_EQ(p.find(one.kind, one.axis, one.sensor), i);
  }
  EXPECT_EQ(p.find(Kind::kMountPosition, 0), -1);
  EXPECT_EQ(p.find(Kind::kSensorPosition, 0, 3), -1);
  EXPECT_EQ(p.find(Kind::kTendonScale, 1), -1);
}

/// A force along d1 bends about d2, so EI2 scales it; one along d2 or d3 bends about d1.
TEST(ForceExponent, EachBendingStiffnessScalesTheForcesThatBendAboutItsAxis) {
  EXPECT_EQ(force_exponent({Kind::kLogStiffness, 0}), Vector3d(0.0, 1.0, 1.0));
  EXPECT_EQ(force_exponent({Kind::kLogStiffness, 1}), Vector3d(1.0, 0.0, 0.0));
  EXPECT_EQ(force_exponent({Kind::kLogStiffness, 2}), Vector3d::Zero());
  for (const Kind kind : {Kind::kPrecurvature, Kind::kTendonScale, Kind::kTendonMoment, Kind::kBasePosition,
                          Kind::kSensorRotation, Kind::kStiffnessRate})
    EXPECT_EQ(force_exponent({kind, 0}), Vector3d::Zero());
}

}  // namespace
}  // namespace palpate
