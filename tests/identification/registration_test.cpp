// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <palpate/identification/registration.hpp>
#include <palpate/identification/registration_checks.hpp>
#include <palpate/identification/registration_model.hpp>
#include <palpate/identification/registration_noise.hpp>
#include <palpate/math/errors.hpp>
#include <tests/identification/unloaded_arcs.hpp>

namespace palpate {
namespace {

using test::ArcSetup;
using test::Draws;
using ::testing::Contains;
using ::testing::HasSubstr;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr int kFrames = 200;

/// Position [m] and rotation [rad] of the true clamp in the axes of the one found.
Vector6d base_error(const Registration& found, const Pose& truth) {
  const Pose T = found.T_reference_base.inverse() * truth;
  Vector6d error;
  error << T.p, log_so3(T.R);
  return error;
}

double share_within_95(const std::vector<double>& errors_in_sigmas) {
  const auto inside =
      std::count_if(errors_in_sigmas.begin(), errors_in_sigmas.end(), [](double e) { return std::abs(e) <= 1.959964; });
  return static_cast<double>(inside) / static_cast<double>(errors_in_sigmas.size());
}

void add_in_sigmas(const Vector6d& error, const Eigen::Matrix<double, 6, 6>& covariance, std::vector<double>& all) {
  for (int k = 0; k < 6; ++k) all.push_back(error(k) / std::sqrt(covariance(k, k)));
}

void report(const char* what, std::vector<double> errors, const char* unit) {
  std::sort(errors.begin(), errors.end());
  std::cout << "  " << what << ": median " << errors[errors.size() / 2] << ", 95 % " << errors[errors.size() * 95 / 100]
            << ", largest " << errors.back() << " " << unit << "\n";
}

TEST(Registration, ExactPosesGiveTheExactBaseWhereverItIs) {
  Draws draws(1);
  for (int trial = 0; trial < 20; ++trial) {
    const ArcSetup setup = test::arc_setup(test::unregistered(), 4, draws);
    const Registration found = identify_registration(setup.catheter, mean_poses_of(setup, kFrames, nullptr));
    EXPECT_TRUE(found.converged);
    const Vector6d error = base_error(found, setup.T_reference_base);
    // the twist's prior pulls by what noise would allow it; 0.2 1/m of it is 14 mrad at the tip
    EXPECT_LT(error.head<3>().norm(), 10e-6);
    EXPECT_LT(error.tail<3>().norm(), 1e-3);
    for (std::size_t j = 0; j < 4; ++j)
      EXPECT_LT((found.positions[j].precurvature_per_m - setup.bends_per_m[j]).head<2>().norm(), 0.05);
    EXPECT_LT((found.catheter.base.T_tracker_base.p - setup.T_reference_base.p).norm(), 10e-6);
  }
}

/// The target: within 0.1 mm and 0.1 deg. Of 1200 numbers 95 +- 0.9 % (one sigma, for the six of a base go together)
/// are to lie in their interval.
TEST(Registration, AuroraNoiseWithinATenthOfAMillimetreAndOfADegree) {
  constexpr int kSeeds = 200;
  Draws draws(2);
  std::vector<double> shift_mm, turn_deg, in_sigmas;
  double chi_square = 0.0;
  int degrees = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const ArcSetup setup = test::arc_setup(test::unregistered(), 5, draws);
    const Registration found = identify_registration(setup.catheter, mean_poses_of(setup, kFrames, &draws));
    const Vector6d error = base_error(found, setup.T_reference_base);
    shift_mm.push_back(error.head<3>().norm() * 1e3);
    turn_deg.push_back(error.tail<3>().norm() / kRadiansPerDegree);
    add_in_sigmas(error, found.base_covariance, in_sigmas);
    chi_square += found.chi_square / kSeeds;
    degrees = found.degrees_of_freedom;
    EXPECT_TRUE(found.warnings.empty()) << found.warnings.front();
  }
  report("base position off by", shift_mm, "mm");
  report("base rotation off by", turn_deg, "deg");
  std::cout << "  in the 95 % interval: " << 100.0 * share_within_95(in_sigmas) << " %\n";
  EXPECT_LT(*std::max_element(shift_mm.begin(), shift_mm.end()), 0.1);
  const auto within = std::count_if(turn_deg.begin(), turn_deg.end(), [](double turn) { return turn <= 0.1; });
  EXPECT_GE(within, 0.98 * kSeeds) << "0.03 deg is the sigma about e1: four of them happen";
  EXPECT_GE(share_within_95(in_sigmas), 0.92);
  EXPECT_LE(share_within_95(in_sigmas), 0.98);
  EXPECT_EQ(degrees, 5 * 12 + 1 - 6 - 1 - 10);
  EXPECT_NEAR(chi_square, degrees, 4.0 * std::sqrt(2.0 * degrees / kSeeds));
}

/// Three to eight positions, bends to all sides up to 60 1/m: always the global minimum.
TEST(Registration, NeverStopsInAWrongMinimum) {
  Draws draws(3);
  for (int trial = 0; trial < 60; ++trial) {
    ArcSetup setup = test::arc_setup(test::unregistered(), 3 + trial % 6, draws);
    for (Vector3d& bend : setup.bends_per_m) {
      const double k = draws.uniform(0.0, 60.0), angle = draws.uniform(0.0, 6.283);
      bend.head<2>() << k * std::cos(angle), k * std::sin(angle);
    }
    const Registration found = identify_registration(setup.catheter, mean_poses_of(setup, kFrames, &draws));
    const Vector6d error = base_error(found, setup.T_reference_base);
    EXPECT_LT(error.head<3>().norm(), 0.5e-3) << trial;
    EXPECT_LT(error.tail<3>().norm(), 0.5 * kRadiansPerDegree) << trial;
  }
}

/// Mountings drawn from their prior; bends to two sides, so that a shift along either axis is told.
TEST(Registration, MountingsComeOutWithTheirSigmas) {
  constexpr int kSeeds = 60;
  Draws draws(4);
  RegistrationOptions options{.mounting = true, .mount_sigma_m = 1e-3, .mount_sigma_rad = 2.0 * kRadiansPerDegree};
  std::vector<double> in_sigmas, of_base;
  double largest_sigma_m = 0.0, largest_sigma_rad = 0.0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    ArcSetup setup = test::arc_setup(test::unregistered(), 9, draws);
    for (std::size_t j = 0; j < 9; ++j)
      if (j % 2 == 1) std::swap(setup.bends_per_m[j].x(), setup.bends_per_m[j].y());
    for (std::size_t i = 0; i < 2; ++i) {
      Vector3d turn = options.mount_sigma_rad * draws.normal3();
      if (i == 0) turn.z() = 0.0;  // the first sensor's roll is the convention
      setup.T_local_sensor[i] = {Draws::turn(turn), options.mount_sigma_m * draws.normal3()};
    }
    const Registration found = identify_registration(setup.catheter, mean_poses_of(setup, kFrames, &draws), options);
    add_in_sigmas(base_error(found, setup.T_reference_base), found.base_covariance, of_base);
    for (std::size_t i = 0; i < 2; ++i) {
      const auto& mounting = found.mountings[i];
      const Pose& truth = setup.T_local_sensor[i];
      const Vector3d shift = mounting.T_local_sensor.p - truth.p;
      const Vector3d turn = log_so3(mounting.T_local_sensor.R * truth.R.transpose());
      for (int k = 0; k < 3; ++k) in_sigmas.push_back(shift(k) / mounting.sigma_m(k));
      for (int k = 0; k < (i == 0 ? 2 : 3); ++k) in_sigmas.push_back(turn(k) / mounting.sigma_rad(k));
      largest_sigma_m = std::max(largest_sigma_m, mounting.sigma_m.maxCoeff());
      largest_sigma_rad = std::max(largest_sigma_rad, mounting.sigma_rad.maxCoeff());
      EXPECT_EQ(found.catheter.sensors[i].mount_sigma_m, mounting.sigma_m.maxCoeff());
    }
    EXPECT_THAT(found.warnings, Contains(HasSubstr("sensor \"tip\" keeps its roll about d3")));
  }
  std::cout << "  largest sigma of a mounting: " << largest_sigma_m * 1e3 << " mm, "
            << largest_sigma_rad / kRadiansPerDegree << " deg; in the 95 % interval: mountings "
            << 100.0 * share_within_95(in_sigmas) << " %, base " << 100.0 * share_within_95(of_base) << " %\n";
  EXPECT_LT(largest_sigma_m, 0.15e-3);
  EXPECT_LT(largest_sigma_rad, 0.3 * kRadiansPerDegree);
  EXPECT_GE(share_within_95(in_sigmas), 0.92);
  EXPECT_LE(share_within_95(in_sigmas), 0.98);
  EXPECT_GE(share_within_95(of_base), 0.92);
  EXPECT_LE(share_within_95(of_base), 0.98);
}

/// All bends about d1: a shift of base and sensors along d1 changes no pose.
TEST(Registration, BendsInOnePlaneDoNotTellAShiftAcrossIt) {
  Draws draws(5);
  ArcSetup setup = test::arc_setup(test::unregistered(), 5, draws);
  for (Vector3d& bend : setup.bends_per_m) bend.y() = 0.0;
  const Registration found =
      identify_registration(setup.catheter, mean_poses_of(setup, kFrames, &draws), {.mounting = true});
  EXPECT_THAT(found.warnings, Contains(HasSubstr("a shift along the axis about which all of them bend not at all")));
  EXPECT_GT(found.mountings[0].sigma_m.x(), 0.6e-3) << "the prior's 1 mm, which both sensors share";
  EXPECT_LT(found.mountings[0].sigma_m.z(), 0.2e-3);
}

/// A bias that all readings share moves the base by as much, however many frames there are.
TEST(Registration, TheTrackersBiasDoesNotAverageOut) {
  constexpr int kSeeds = 40;
  Catheter catheter = test::unregistered();
  for (Sensor& sensor : catheter.sensors) sensor.bias_m = 0.48e-3, sensor.bias_rad = 0.3 * kRadiansPerDegree;
  catheter.bias_length_m = 10.0;
  Draws draws(6);
  std::vector<double> in_sigmas;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const ArcSetup setup = test::arc_setup(catheter, 5, draws);
    std::vector<KnobPosition> positions = mean_poses_of(setup, 20000, &draws);
    const Vector3d shift = 0.48e-3 / std::sqrt(3.0) * draws.normal3();
    const Matrix3d turn = draws.small_turn(0.3 * kRadiansPerDegree / std::sqrt(3.0));
    for (KnobPosition& position : positions)
      for (MeanPose& mean : position.poses)
        mean.T_base_sensor = {turn * mean.T_base_sensor.R, mean.T_base_sensor.p + shift};
    const Registration found = identify_registration(catheter, positions);
    add_in_sigmas(base_error(found, setup.T_reference_base), found.base_covariance, in_sigmas);
    EXPECT_GT(found.catheter.base.position_sigma_m, 0.27e-3);
  }
  EXPECT_GE(share_within_95(in_sigmas), 0.90);
  catheter.bias_length_m = 0.01;  // no two places alike: now it averages over the knob positions
  const ArcSetup setup = test::arc_setup(catheter, 5, draws);
  const Registration found = identify_registration(catheter, mean_poses_of(setup, 20000, &draws));
  EXPECT_GT(found.catheter.base.position_sigma_m, 0.05e-3);
}

/// Frames of a tracker, the base sensor among them, which is carried about between the knob positions.
std::vector<KnobPosition> carried_about(const Catheter& stated, const ArcSetup& setup, Draws& draws) {
  std::vector<KnobPosition> positions;
  for (std::size_t j = 0; j < setup.bends_per_m.size(); ++j) {
    const Pose T_tracker_base_sensor = draws.pose(0.5);
    std::vector<TrackerFrame> frames;
    for (int k = 0; k < 50; ++k) {
      TrackerFrame frame{.time_s = 0.02 * k};
      for (std::size_t i = 0; i < stated.sensors.size(); ++i)
        frame.readings.push_back(test::reading_of(T_tracker_base_sensor * setup.pose(j, i)));
      frame.readings.push_back(test::reading_of(T_tracker_base_sensor));
      frames.push_back(test::with_noise(stated, frame, draws));
    }
    positions.push_back({"knob", mean_reference_poses(stated, frames, 0.0, 1e9)});
    EXPECT_EQ(positions.back().poses[0].count, 50);
  }
  return positions;
}

/// What is found is how the base sensor sits on the clamp. Its sigmas are those of the sensor's place, not of the
/// clamp's: 60 squares of errors in sigmas have mean 1 +- 0.2, one sigma.
TEST(Registration, ATrackedBaseGetsTheMountingOfItsSensor) {
  constexpr int kSeeds = 20;
  Draws draws(7);
  Catheter stated = test::with_tracked_base(test::unregistered());
  stated.base.sensor.noise_rad = 0.5 * kRadiansPerDegree;  // turns all that is seen against it, together
  stated.base.sensor.noise_m.setConstant(0.1e-3);
  const Pose mounting{Draws::turn({2.0, -1.0, 0.5}), {-25e-3, 18e-3, -42e-3}};
  double squares = 0.0, chi_square = 0.0;
  int degrees = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    ArcSetup setup = test::arc_setup(stated, 5, draws);
    setup.T_reference_base = mounting.inverse();
    const Registration found = identify_registration(stated, carried_about(stated, setup, draws));
    const BaseRegistration& base = found.catheter.base;
    const Vector3d error_m = base.sensor.T_local_sensor.p - mounting.p;
    squares += error_m.dot(base.covariance->topLeftCorner<3, 3>().llt().solve(error_m)) / (3.0 * kSeeds);
    chi_square += found.chi_square / kSeeds;
    degrees = found.degrees_of_freedom;
    EXPECT_LT(error_m.norm(), 4.0 * base.position_sigma_m);
    EXPECT_LT(log_so3(mounting.R.transpose() * base.sensor.T_local_sensor.R).norm(), 4.0 * base.rotation_sigma_rad);
    EXPECT_NO_THROW(found.catheter.validate());
  }
  EXPECT_NEAR(squares, 1.0, 0.6);
  EXPECT_NEAR(chi_square, degrees, 4.0 * std::sqrt(2.0 * degrees / kSeeds));
}

/// Drawn: 4000 frames as the tracker sees them, each brought into the base sensor's frame. An entry of the covariance,
/// in units of the sigmas of its two rows, scatters by 1 / sqrt(4000) = 0.016.
TEST(Registration, NoiseAgainstATrackedBaseIsThatOfItsSensorToo) {
  constexpr int kDraws = 4000;
  Draws draws(15);
  Catheter catheter = test::with_tracked_base(test::unregistered());
  catheter.base.sensor.noise_m.setConstant(0.1e-3);
  const ArcSetup setup = test::arc_setup(catheter, 1, draws);
  const std::vector<KnobPosition> positions = mean_poses_of(setup, 1, nullptr);
  const Eigen::MatrixXd stated = registration_noise(RegistrationModel(catheter, positions, false));
  const auto noisy = [&](const Pose& T, const Sensor& sensor) {
    return Pose{T.R * draws.small_turn(sensor.noise_rad), T.p + T.R * sensor.noise_m.cwiseProduct(draws.normal3())};
  };
  Eigen::MatrixXd drawn = Eigen::MatrixXd::Zero(12, 12);
  for (int k = 0; k < kDraws; ++k) {
    const Pose T_sensor_reference = noisy(Pose{}, catheter.base.sensor).inverse();
    Eigen::Matrix<double, 12, 1> error;
    for (std::size_t i = 0; i < 2; ++i) {
      const Pose& truth = positions[0].poses[i].T_base_sensor;
      const Pose seen = T_sensor_reference * noisy(truth, catheter.sensors[i]);
      error.segment<6>(6 * static_cast<Eigen::Index>(i)) << seen.p - truth.p, log_so3(truth.R.transpose() * seen.R);
    }
    drawn += error * error.transpose() / kDraws;
  }
  const Eigen::VectorXd scale = stated.diagonal().cwiseSqrt().cwiseInverse();
  EXPECT_LT((scale.asDiagonal() * (drawn - stated) * scale.asDiagonal()).cwiseAbs().maxCoeff(), 0.1);
}

/// Own weight bends the shaft as the clamp is held: its direction in the clamp's frame is known, wherever that is.
TEST(Registration, OwnWeightIsPartOfTheShape) {
  Draws draws(8);
  Catheter catheter = test::with_own_weight(test::unregistered());
  catheter.base.T_tracker_base = test::some_pose();  // stated, and wrong
  catheter.precurvature_sigma_per_m.z() = 0.0;
  const Pose truth = test::far_away(draws);
  std::vector<KnobPosition> positions;
  for (const double k1 : {5.0, 20.0, 35.0, 50.0}) {
    Catheter real = catheter;
    real.rod.sections[0].precurvature_per_m = {k1, 0.3, 0.0};
    real.base.T_tracker_base = truth;
    const std::vector<TrackerFrame> frames(10, test::exact_frame(real, Vector3d::Zero()));
    positions.push_back({"knob", mean_reference_poses(catheter, frames, 0.0, 1e9)});
  }
  const Registration found = identify_registration(catheter, positions);
  EXPECT_LT(base_error(found, truth).head<3>().norm(), 1e-8);
  EXPECT_LT(base_error(found, truth).tail<3>().norm(), 1e-7);
  catheter.rod.distributed_load_base_N_per_m.setZero();
  const Registration blind = identify_registration(catheter, positions);
  EXPECT_GT(base_error(blind, truth).tail<3>().norm(), 0.5 * kRadiansPerDegree);
}

/// A force at the tip bends the shaft most at the clamp, which no precurvature does.
TEST(Registration, AShaftThatTouchesSomethingIsTold) {
  Draws draws(9);
  Catheter catheter = test::unregistered();
  std::vector<KnobPosition> positions;
  for (const double k1 : {5.0, 20.0, 35.0, 50.0}) {
    Catheter real = catheter;
    real.rod.sections[0].precurvature_per_m = {k1, 0.3, 0.0};
    real.base.T_tracker_base = test::some_pose();
    const Vector3d force_N = k1 == 35.0 ? Vector3d(0.0, 0.05, 0.0) : Vector3d::Zero();
    std::vector<TrackerFrame> frames;
    for (int k = 0; k < kFrames; ++k) frames.push_back(test::with_noise(real, test::exact_frame(real, force_N), draws));
    positions.push_back(
        {"k1 = " + std::to_string(static_cast<int>(k1)), mean_reference_poses(catheter, frames, 0.0, 1e9)});
  }
  const Registration found = identify_registration(catheter, positions);
  EXPECT_GT(found.sigma_inflation, 2.0);
  EXPECT_THAT(found.warnings, Contains(HasSubstr("did the shaft touch something")));
}

/// Points and needles do not feel the shaft's roll: that it bends about d1, to the stated side, must tell.
TEST(Registration, WithoutAWholePoseTheBendTellsTheRoll) {
  for (const SensorKind kind : {SensorKind::kPose5, SensorKind::kPosition}) {
    for (const double side : {1.0, -1.0}) {
      Draws draws(10);
      Catheter catheter = test::unregistered();
      catheter.rod.sections[0].precurvature_per_m.x() = 40.0 * side;
      catheter.precurvature_sigma_per_m = {0.5, 0.1, 0.0};
      catheter.sensors = {test::sensor_at("tip", 0.07, kind), test::sensor_at("middle", 0.045, kind),
                          test::sensor_at("low", 0.02, kind)};
      ArcSetup setup = test::arc_setup(catheter, 5, draws);
      for (Vector3d& bend : setup.bends_per_m) bend.head<2>() << side * bend.x(), 0.1 * draws.normal();
      const Registration found = identify_registration(catheter, mean_poses_of(setup, kFrames, &draws));
      EXPECT_EQ(found.warnings.size(), 1u) << found.warnings.back();
      EXPECT_THAT(found.warnings, Contains(HasSubstr("the base's roll is not told by these sensors")));
      const Vector6d error = base_error(found, setup.T_reference_base);
      for (int k = 0; k < 6; ++k) EXPECT_LT(std::abs(error(k)), 4.0 * std::sqrt(found.base_covariance(k, k))) << k;
      EXPECT_LT(error.head<3>().norm(), 0.3e-3);
      EXPECT_LT(error.tail<3>().norm(), 1.0 * kRadiansPerDegree);
    }
  }
}

TEST(Registration, LikeBendsAreTold) {
  Draws draws(11);
  ArcSetup setup = test::arc_setup(test::unregistered(), 4, draws);
  for (Vector3d& bend : setup.bends_per_m) bend.x() = 30.0;
  const Registration found = identify_registration(setup.catheter, mean_poses_of(setup, kFrames, &draws));
  EXPECT_THAT(found.warnings, Contains(HasSubstr("the base rests on the angle between the sensors alone")));
}

TEST(Registration, AnotherBaseThatIsAsGoodIsTold) {
  Draws draws(16);
  const ArcSetup setup = test::arc_setup(test::unregistered(), 4, draws);
  const std::vector<KnobPosition> positions = mean_poses_of(setup, kFrames, &draws);
  const Registration found = identify_registration(setup.catheter, positions);
  const RegistrationModel model(setup.catheter, positions, false);
  RegistrationFit rival{.converged = true, .state = model.stated(), .chi_square = found.chi_square + 1.0};
  rival.state.T_reference_base = found.T_reference_base * Pose{Draws::turn({0.0, 0.0, 0.5}), {0.0, 0.01, 0.0}};
  const auto warnings = [&] {
    return registration_warnings(model, weights_of(model, {}), std::span(&rival, 1), found);
  };
  EXPECT_THAT(warnings(), Contains(HasSubstr("another base explains the poses as well, 10.0 mm and 28.6 deg away")));
  rival.chi_square = found.chi_square + 20.0;
  EXPECT_TRUE(warnings().empty());
}

/// Central differences of the predicted poses; the orientation's residual through its own derivative, -D.
TEST(Registration, SensitivitiesAgreeWithDifferences) {
  Draws draws(12);
  Catheter catheter = test::with_own_weight(test::mixed_sensors());
  catheter.base = BaseRegistration{};
  ArcSetup setup = test::arc_setup(catheter, 2, draws);
  const std::vector<KnobPosition> positions = mean_poses_of(setup, 1, &draws);
  RegistrationModel model(catheter, positions, true);
  RegistrationState from = model.stated();
  from.T_reference_base = setup.T_reference_base;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(model.unknowns());
  for (int k = 0; k < x.size(); ++k) x(k) = 0.05 * draws.normal();
  RegistrationModel::Evaluation at, before, after;
  ASSERT_TRUE(model.evaluate(from, x, at));
  for (int k = 0; k < x.size(); ++k) {
    const double h = 1e-5;
    Eigen::VectorXd y = x;
    y(k) = x(k) - h;
    ASSERT_TRUE(model.evaluate(from, y, before));
    y(k) = x(k) + h;
    ASSERT_TRUE(model.evaluate(from, y, after));
    const Eigen::VectorXd difference = (before.residual - after.residual) / (2.0 * h);
    EXPECT_LT((at.jacobian.col(k) - difference).norm(), 1e-7 * (1.0 + difference.norm())) << "unknown " << k;
  }
}

std::string refusal(const Catheter& catheter, const std::vector<KnobPosition>& positions,
                    const RegistrationOptions& options = {}) {
  try {
    identify_registration(catheter, positions, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Registration, WhatCannotBeToldIsRefused) {
  Draws draws(13);
  const ArcSetup one = test::arc_setup(test::unregistered(), 1, draws);
  EXPECT_EQ(refusal(one.catheter, mean_poses_of(one, kFrames, &draws), {.mounting = true}),
            "1 knob position gives 12 numbers for 19 unknowns (6 of the base, 2 of bends, 11 of mountings): expected "
            "more knob positions");
  EXPECT_EQ(refusal(one.catheter, {}), "registration: expected at least one knob position");
  ArcSetup single = test::arc_setup(test::unregistered(), 1, draws);
  single.catheter.sensors.pop_back();
  EXPECT_EQ(refusal(single.catheter, mean_poses_of(single, kFrames, &draws)),
            "1 knob position gives 6 numbers for 8 unknowns (6 of the base, 2 of bends): expected more knob positions");
  ArcSetup two = test::arc_setup(test::unregistered(), 3, draws);
  std::vector<KnobPosition> unseen = mean_poses_of(two, kFrames, &draws);
  for (MeanPose& mean : unseen[1].poses) mean.count = 0;
  EXPECT_THAT(refusal(two.catheter, unseen), HasSubstr("knob 2: no usable reading of any sensor"));
  for (Vector3d& bend : two.bends_per_m) bend.setZero();
  two.catheter.sensors.pop_back();
  EXPECT_THAT(refusal(two.catheter, mean_poses_of(two, kFrames, nullptr)), HasSubstr("is not told by these poses"))
      << "one sensor, always the same bend";
  EXPECT_EQ(refusal(one.catheter, mean_poses_of(one, 1, nullptr), {.mounting = true, .mount_sigma_m = -1.0}),
            "registration: mount_sigma_m = -1: expected more than 0, at most 0.1");
}

TEST(Registration, ASensorThatMovesMeanwhileIsFound) {
  Draws draws(14);
  const Catheter catheter = test::two_sensors();
  std::vector<TrackerFrame> frames;
  for (int k = 0; k < 200; ++k)
    frames.push_back(test::with_noise(catheter, test::exact_frame(catheter, Vector3d::Zero(), 0.02 * k), draws));
  EXPECT_TRUE(find_drift(catheter, frames, 0.0, 1e9).empty());
  for (int k = 0; k < 200; ++k) frames[static_cast<std::size_t>(k)].readings[0].position_m.x() += 1e-5 * k;
  const std::vector<SensorDrift> drift = find_drift(catheter, frames, 0.0, 1e9);
  ASSERT_EQ(drift.size(), 1u);
  EXPECT_EQ(drift[0].sensor, 0);
  EXPECT_NEAR(drift[0].moved_m, 1e-3, 0.2e-3);
}

}  // namespace
}  // namespace palpate
