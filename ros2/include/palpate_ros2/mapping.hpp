// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstdint>
#include <limits>
#include <palpate/observer/estimate.hpp>
#include <palpate/sensing/tracker_frame.hpp>
#include <string>

/// Between ROS 2 messages and Palpate's types. The messages are named by their fields alone, so all of this is tested
/// without ROS.
namespace palpate_ros2 {

/// geometry_msgs/msg/PoseStamped: metres; `orientation` turns the sensor's axes into those of header.frame_id.
template <class Message>
concept PoseStamped = requires(const Message& m) {
  { m.header.stamp.sec } -> std::convertible_to<std::int64_t>;
  { m.header.stamp.nanosec } -> std::convertible_to<std::int64_t>;
  { m.pose.position.x } -> std::convertible_to<double>;
  { m.pose.orientation.w } -> std::convertible_to<double>;
};

template <class Stamp>
std::int64_t nanoseconds(const Stamp& stamp) {
  return std::int64_t{stamp.sec} * 1'000'000'000 + std::int64_t{stamp.nanosec};
}

/// A stamp of whole nanoseconds, 1970 or not, never negative.
template <class Stamp>
Stamp to_stamp(std::int64_t time_ns) {
  Stamp stamp;
  stamp.sec = static_cast<decltype(stamp.sec)>(time_ns / 1'000'000'000);
  stamp.nanosec = static_cast<decltype(stamp.nanosec)>(time_ns % 1'000'000'000);
  return stamp;
}

/// Unchecked, as readings are: the observer screens them.
template <PoseStamped Message>
palpate::SensorReading to_reading(const Message& message) {
  const auto& position = message.pose.position;
  const auto& orientation = message.pose.orientation;
  palpate::SensorReading reading;
  reading.status = palpate::SensorReading::Status::kOk;
  reading.has_orientation = true;
  reading.quaternion_wxyz = {orientation.w, orientation.x, orientation.y, orientation.z};
  reading.position_m = {position.x, position.y, position.z};
  return reading;
}

/// The frame told of this force: it was neither held nor predicted.
inline bool is_measured(const palpate::Estimate& estimate) {
  using enum palpate::EstimateStatus;
  const bool used = estimate.status == kUpdated || estimate.status == kReseeded || estimate.status == kAmbiguous;
  return used && estimate.force_tip_N.allFinite() && estimate.covariance_tip_N2.allFinite();
}

template <class Vector>
void set_vector(const palpate::Vector3d& v, Vector& out) {
  out.x = v.x();
  out.y = v.y();
  out.z = v.z();
}

inline palpate::Vector3d unknown_force() {
  return palpate::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
}

/// geometry_msgs/msg/WrenchStamped, without its header. A force that was not measured is NaN: whoever does not read the
/// diagnostics cannot take an old force for a new one. The torque is zero, as the model takes it to be, or NaN as well.
template <class Wrench>
void set_wrench(const palpate::Estimate& estimate, Wrench& out) {
  const bool measured = is_measured(estimate);
  set_vector(measured ? estimate.force_tip_N : unknown_force(), out.force);
  set_vector(measured ? palpate::Vector3d::Zero().eval() : unknown_force(), out.torque);
}

/// palpate_ros2/msg/ForceWithCovarianceStamped, without its header; NaN as set_wrench().
template <class Message>
void set_force(const palpate::Estimate& estimate, Message& out) {
  const bool measured = is_measured(estimate);
  set_vector(measured ? estimate.force_tip_N : unknown_force(), out.force);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      out.covariance[static_cast<std::size_t>(3 * i + j)] =
          measured ? estimate.covariance_tip_N2(i, j) : std::numeric_limits<double>::quiet_NaN();
}

/// diagnostic_msgs/msg/DiagnosticStatus: OK, WARN, ERROR, STALE.
enum class Level : std::uint8_t { kOk = 0, kWarn = 1, kError = 2, kStale = 3 };

inline Level level_of(const palpate::Estimate& estimate) {
  using enum palpate::EstimateStatus;
  if (estimate.status == kStale) return Level::kStale;
  if (!is_measured(estimate)) return Level::kError;
  return estimate.status == kAmbiguous ? Level::kWarn : Level::kOk;
}

/// What is published while nothing comes.
inline palpate::Estimate stale_estimate() {
  palpate::Estimate estimate;
  estimate.status = palpate::EstimateStatus::kStale;
  return estimate;
}

template <class Status>
void add_value(const std::string& key, const std::string& value, Status& out) {
  auto& entry = out.values.emplace_back();
  entry.key = key;
  entry.value = value;
}

/// `late_readings`: FrameAssembler::late().
template <class Status>
void set_diagnostics(const palpate::Estimate& estimate, const std::string& catheter, std::int64_t late_readings,
                     Status& out) {
  out.level = static_cast<decltype(out.level)>(level_of(estimate));
  out.name = "palpate: force on the tip";
  out.hardware_id = catheter;
  out.message = std::string(palpate::describe(estimate.status));
  out.values.clear();
  add_value("sensors used", std::to_string(estimate.sensors_used), out);
  add_value("NIS", std::to_string(estimate.nis), out);
  add_value("degrees of freedom", std::to_string(estimate.dof), out);
  add_value("late readings dropped", std::to_string(late_readings), out);
}

}  // namespace palpate_ros2
