// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <palpate/math/errors.hpp>
#include <palpate/sensing/catheter.hpp>
#include <string>

namespace palpate {
namespace {

Catheter good_catheter() {
  Catheter catheter;
  catheter.rod = uniform_rod(0.07, {2.612e-4, 1.6664e-4, 1.645e-4}, {39.99, 0.0, 0.0});
  for (const auto& [name, arc_m] : {std::pair{"tip", 0.07}, std::pair{"shaft", 0.0653}}) {
    Sensor& sensor = catheter.sensors.emplace_back();
    sensor.name = name;
    sensor.arc_length_m = arc_m;
  }
  return catheter;
}

std::string error_of(const Catheter& catheter) {
  try {
    catheter.validate();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Catheter, GoodOnePasses) { EXPECT_EQ(error_of(good_catheter()), "no error"); }

TEST(Catheter, SensorFaultsAreNamed) {
  Catheter catheter = good_catheter();
  catheter.sensors[1].arc_length_m = 0.08;
  EXPECT_EQ(error_of(catheter),
            "catheter: sensor 'shaft' arc_length_m = 0.08: expected 0..0.07, the shaft with its rigid tip");
  catheter.rod.rigid_tip_m = 0.01;
  EXPECT_EQ(error_of(catheter), "no error");
  catheter.sensors[0].noise_m.x() = std::nan("");
  EXPECT_EQ(error_of(catheter), "catheter: sensor 'tip' noise_m = nan: expected more than 0");
  catheter = good_catheter();
  catheter.sensors[0].noise_rad = 0.0;
  EXPECT_EQ(error_of(catheter), "catheter: sensor 'tip' noise_rad = 0: expected more than 0");
  catheter.sensors[0].kind = SensorKind::kPosition;
  EXPECT_EQ(error_of(catheter), "no error");
  catheter.sensors[0].T_local_sensor.R *= 2.0;
  EXPECT_EQ(error_of(catheter),
            "catheter: sensor 'tip' mounting rotation: largest entry of R^T R - I = 3: expected a rotation matrix");
}

TEST(Catheter, RegistrationAndDelayOfASensor) {
  Catheter catheter = good_catheter();
  EXPECT_EQ(&catheter.T_tracker_base(catheter.sensors[1]), &catheter.base.T_tracker_base);
  catheter.sensors[1].T_tracker_base = Pose{Matrix3d::Identity(), {0.1, 0.2, 0.3}};
  EXPECT_EQ(error_of(catheter), "no error");
  EXPECT_EQ(&catheter.T_tracker_base(catheter.sensors[1]), &*catheter.sensors[1].T_tracker_base);
  catheter.base.tracked = true;
  catheter.base.sensor = catheter.sensors[1];
  catheter.sensors.pop_back();
  EXPECT_EQ(error_of(catheter), "catheter: base sensor 'shaft': base pose: expected none, for it measures the base");
  catheter = good_catheter();
  catheter.sensors[1].T_tracker_base = Pose{-Matrix3d::Identity(), Vector3d::Zero()};
  EXPECT_EQ(error_of(catheter),
            "catheter: sensor 'shaft' base rotation: largest entry of R^T R - I = 0: expected a rotation matrix");
  catheter = good_catheter();
  catheter.sensors[0].delay_s = std::nan("");
  EXPECT_EQ(error_of(catheter), "catheter: sensor 'tip' delay_s = nan: expected a finite number");
}

TEST(Catheter, NamesAndNumberOfSensors) {
  Catheter catheter = good_catheter();
  catheter.sensors[1].name = "tip";
  EXPECT_EQ(error_of(catheter), "catheter: sensor name = 'tip': expected each name once");
  catheter.sensors[1].name = "";
  EXPECT_EQ(error_of(catheter), "catheter: sensor 2: name = '': expected a name");
  catheter.sensors.assign(static_cast<std::size_t>(kMaxSensors) + 1, catheter.sensors[0]);
  EXPECT_EQ(error_of(catheter), "catheter: number of sensors = 9: expected 1..8");
  catheter.sensors.clear();
  EXPECT_EQ(error_of(catheter), "catheter: number of sensors = 0: expected 1..8");
}

TEST(Catheter, BaseAndSigmas) {
  Catheter catheter = good_catheter();
  catheter.base.position_sigma_m = -1.0;
  EXPECT_EQ(error_of(catheter), "catheter: base position_sigma_m = -1: expected 0 or more");
  catheter = good_catheter();
  catheter.base.tracked = true;
  catheter.base.sensor.name = "clamp";
  EXPECT_EQ(error_of(catheter), "no error");
  catheter.base.sensor.kind = SensorKind::kPose5;
  EXPECT_EQ(error_of(catheter), "catheter: base sensor 'clamp': kind: expected pose, six degrees of freedom");
  catheter = good_catheter();
  catheter.precurvature_sigma_per_m.y() = std::nan("");
  EXPECT_EQ(error_of(catheter), "catheter: precurvature_sigma_per_m[1] = nan: expected 0 or more");
  catheter = good_catheter();
  catheter.stiffness_correlation = 1.0;
  EXPECT_EQ(error_of(catheter), "catheter: stiffness_correlation = 1: expected 0..0.999");
  catheter = good_catheter();
  catheter.bias_length_m = 0.0;
  EXPECT_EQ(error_of(catheter), "catheter: bias_length_m = 0: expected more than 0");
  catheter = good_catheter();
  catheter.bias_memory_s = std::nan("");
  EXPECT_EQ(error_of(catheter), "catheter: bias_memory_s = nan: expected more than 0, at most 1e9");
  catheter = good_catheter();
  catheter.rod.sections.clear();
  EXPECT_EQ(error_of(catheter), "rod: sections = []: expected at least one section");
}

}  // namespace
}  // namespace palpate
