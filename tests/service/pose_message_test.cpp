// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <palpate/math/rotation.hpp>
#include <palpate/sensing/screening.hpp>
#include <palpate/service/pose_message.hpp>

namespace palpate::service {
namespace {

link::Matrix matrix_of(const Matrix3d& R, const Vector3d& p_mm) {
  link::Matrix out;
  for (int i = 0; i < 9; ++i) out.columns[static_cast<std::size_t>(i)] = static_cast<float>(R(i % 3, i / 3));
  for (int i = 0; i < 3; ++i) out.columns[static_cast<std::size_t>(9 + i)] = static_cast<float>(p_mm(i));
  return out;
}

std::vector<std::pair<std::string, SensorReading>> poses(const link::Message& message) {
  std::vector<std::pair<std::string, SensorReading>> out;
  for_each_pose(message,
                [&](std::string_view device, const SensorReading& reading) { out.emplace_back(device, reading); });
  return out;
}

TEST(PoseMessage, AMatrixBecomesThePoseItWas) {
  const Matrix3d R = exp_so3({0.4, -0.9, 1.3});
  const SensorReading reading = reading_of(matrix_of(R, {10.0, -20.0, 30.5}));
  EXPECT_EQ(screen(reading, SensorKind::kPose), Rejection::kNone);
  EXPECT_LT((reading.position_m - Vector3d(0.01, -0.02, 0.0305)).norm(), 1e-9);
  const auto& q = reading.quaternion_wxyz;
  const Matrix3d back = Eigen::Quaterniond(q(0), q(1), q(2), q(3)).toRotationMatrix();
  EXPECT_LT((back - R).norm(), 2e-7);  // single precision
  EXPECT_NEAR(q.norm(), 1.0, 1e-15);   // but a rotation to the last bit
}

TEST(PoseMessage, WhatIsNoRotationIsRefusedByScreening) {
  Matrix3d stretched = Matrix3d::Identity();
  stretched(0, 0) = 1.05;
  Matrix3d mirrored = Matrix3d::Identity();
  mirrored(2, 2) = -1.0;
  Matrix3d broken = Matrix3d::Identity();
  broken(1, 2) = std::numeric_limits<double>::quiet_NaN();
  for (const Matrix3d& R : {stretched, mirrored, broken, Matrix3d(Matrix3d::Zero())})
    EXPECT_EQ(screen(reading_of(matrix_of(R, {1.0, 2.0, 3.0})), SensorKind::kPose), Rejection::kZeroQuaternion);
}

TEST(PoseMessage, TheExactIdentityIsKeptAndRefused) {
  EXPECT_EQ(screen(reading_of(link::Matrix{}), SensorKind::kPose), Rejection::kIdentityPose);
}

TEST(PoseMessage, WhatIsNotFiniteIsRefused) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(screen(reading_of(matrix_of(exp_so3({0.1, 0.2, 0.3}), {infinity, 0.0, 0.0})), SensorKind::kPose),
            Rejection::kNotFinite);
}

TEST(PoseMessage, EveryToolOfATrackingMessage) {
  link::TrackingData data;
  data.tools.push_back({.name = "tip", .matrix = matrix_of(exp_so3({0.1, 0.0, 0.0}), {1.0, 2.0, 3.0})});
  data.tools.push_back({.name = "shaft", .matrix = matrix_of(exp_so3({0.2, 0.0, 0.0}), {4.0, 5.0, 6.0})});
  const auto found = poses({.device = "Tracker", .body = data});
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[1].first, "shaft");
  EXPECT_NEAR(found[1].second.position_m.z(), 6e-3, 1e-12);
}

TEST(PoseMessage, QuaternionsAreScalarLastOnTheWire) {
  link::QuaternionTrackingData data;
  data.tools.push_back({.name = "tip", .position_mm = {1, 2, 3}, .quaternion_xyzw = {0.1F, 0.2F, 0.3F, 0.9F}});
  const auto found = poses({.body = data});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_FLOAT_EQ(static_cast<float>(found[0].second.quaternion_wxyz(0)), 0.9F);
  EXPECT_FLOAT_EQ(static_cast<float>(found[0].second.quaternion_wxyz(1)), 0.1F);
}

TEST(PoseMessage, APositionWithoutQuaternionIsAPoint) {
  const auto found = poses({.device = "tip", .body = link::Position{.position_mm = {1, 2, 3}, .quaternion_xyzw = {}}});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_FALSE(found[0].second.has_orientation);
}

TEST(PoseMessage, WhatPlusMarksAsNotValidIsMissing) {
  const link::Transform transform{matrix_of(exp_so3({0.1, 0.2, 0.3}), {1.0, 2.0, 3.0})};
  using Metadata = std::vector<std::pair<std::string, std::string>>;
  const auto status = [&](const Metadata& metadata) {
    return poses({.version = 2, .device = "TipToTracker", .body = transform, .metadata = metadata})[0].second.status;
  };
  EXPECT_EQ(status({{"TransformValid", "false"}}), SensorReading::Status::kMissing);
  EXPECT_EQ(status({{"TransformStatus", "INVALID"}}), SensorReading::Status::kMissing);
  EXPECT_EQ(status({{"TransformValid", "true"}, {"TransformStatus", "OK"}}), SensorReading::Status::kOk);
  EXPECT_EQ(status({}), SensorReading::Status::kOk);
}

}  // namespace
}  // namespace palpate::service
