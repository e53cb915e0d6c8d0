// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <palpate/simulation/error_tracker.hpp>

namespace palpate {

namespace {

enum class Draw : std::uint64_t { kPositionBias = 1, kRotationBias, kNoise, kFaults, kDrops, kStamps, kRoll };

/// A seed of its own for each use: the finaliser of splitmix64 (Steele, Lea and Flood 2014).
std::uint64_t seed_of(std::uint64_t seed, Draw draw) {
  std::uint64_t z = seed + 0x9e3779b97f4a7c15ULL * static_cast<std::uint64_t>(draw);
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31U);
}

double uniform(std::mt19937_64& engine) { return std::uniform_real_distribution<double>()(engine); }

/// All that is known of a 5-DOF sensor is its z axis.
Eigen::Quaterniond without_roll(const Matrix3d& R, double roll_rad) {
  return Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), Vector3d(R.col(2))) *
         Eigen::AngleAxisd(roll_rad, Vector3d::UnitZ());
}

/// Without a negative zero, which a file would tell.
double rounded(double value, double step) { return step > 0.0 ? step * std::round(value / step) + 0.0 : value; }

}  // namespace

ErrorTracker::ErrorTracker(const Catheter& catheter, const TrackerErrors& errors, std::uint64_t seed)
    : sensors_(catheter.sensors),
      base_tracked_(catheter.base.tracked),
      T_tracker_base_at_rest_(catheter.base.T_tracker_base),
      errors_(errors),
      bias_m_(errors.bias_m, errors.bias_length_m, seed_of(seed, Draw::kPositionBias)),
      bias_rad_(errors.bias_rad, errors.bias_length_m, seed_of(seed, Draw::kRotationBias)),
      noise_engine_(seed_of(seed, Draw::kNoise)),
      fault_engine_(seed_of(seed, Draw::kFaults)),
      drop_engine_(seed_of(seed, Draw::kDrops)),
      stamp_engine_(seed_of(seed, Draw::kStamps)),
      last_stamp_s_(-std::numeric_limits<double>::infinity()) {
  if (base_tracked_) sensors_.push_back(catheter.base.sensor);
  std::mt19937_64 rolls(seed_of(seed, Draw::kRoll));
  for (std::size_t i = 0; i < sensors_.size(); ++i)
    roll_rad_.push_back(std::numbers::pi * (2.0 * uniform(rolls) - 1.0));
}

std::vector<SensorReading> ErrorTracker::read(std::span<const Pose> T_base_local, const Pose& T_tracker_base) {
  const std::size_t on_shaft = sensors_.size() - (base_tracked_ ? 1 : 0);
  assert(T_base_local.size() >= on_shaft);
  const Pose moved = T_tracker_base_at_rest_.inverse() * T_tracker_base;
  std::vector<SensorReading> readings;
  readings.reserve(sensors_.size());
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    const Sensor& sensor = sensors_[i];
    const bool shaft = i < on_shaft;
    const Pose T_own_base = shaft && sensor.T_tracker_base ? *sensor.T_tracker_base * moved : T_tracker_base;
    const Pose T_own_local = shaft ? T_own_base * T_base_local[i] : T_own_base;
    readings.push_back(read_sensor(sensor, T_own_local * sensor.T_local_sensor, T_own_base.R, roll_rad_[i]));
  }
  return readings;
}

SensorReading ErrorTracker::read_sensor(const Sensor& sensor, const Pose& T_tracker_sensor,
                                        const Matrix3d& R_tracker_base, double roll_rad) {
  SensorReading reading;
  reading.status = SensorReading::Status::kOk;
  reading.has_orientation = sensor.kind != SensorKind::kPosition;
  reading.position_m =
      T_tracker_sensor.p + bias_m_.at(T_tracker_sensor.p) + R_tracker_base * sensor.noise_m.cwiseProduct(noise(1.0));
  const Matrix3d R = exp_so3(bias_rad_.at(T_tracker_sensor.p)) * T_tracker_sensor.R * exp_so3(noise(sensor.noise_rad));
  if (reading.has_orientation) {
    const Eigen::Quaterniond q = sensor.kind == SensorKind::kPose5 ? without_roll(R, roll_rad) : Eigen::Quaterniond(R);
    reading.quaternion_wxyz << q.w(), q.x(), q.y(), q.z();
  }
  quantise(reading);
  strike(reading);
  return reading;
}

void ErrorTracker::quantise(SensorReading& reading) const {
  for (double& p : reading.position_m) p = rounded(p, errors_.position_step_m);
  for (double& q : reading.quaternion_wxyz) q = rounded(q, errors_.quaternion_step);
}

/// Outliers and missing readings. Every reading draws alike, so that one share does not move the other's faults.
void ErrorTracker::strike(SensorReading& reading) {
  std::normal_distribution<double> normal;
  const double x = normal(fault_engine_), y = normal(fault_engine_), z = normal(fault_engine_);
  const bool astray = uniform(fault_engine_) < errors_.outlier_share;
  const bool missing = uniform(fault_engine_) < errors_.missing_share;
  if (astray) reading.position_m += errors_.outlier_m * Vector3d(x, y, z).normalized();
  if (missing) reading = SensorReading{};
}

Vector3d ErrorTracker::noise(double sigma) {
  const double x = noise_normal_(noise_engine_), y = noise_normal_(noise_engine_), z = noise_normal_(noise_engine_);
  return sigma * Vector3d(x, y, z);
}

bool ErrorTracker::drops_frame() { return uniform(drop_engine_) < errors_.dropped_share; }

double ErrorTracker::stamp(double time_s) {
  constexpr double kLeastStep_s = 1e-5;  // ten of the last digit that a tracker CSV writes
  const double drawn_s = time_s + errors_.latency_s + errors_.jitter_s * stamp_normal_(stamp_engine_);
  last_stamp_s_ = std::max(drawn_s, last_stamp_s_ + kLeastStep_s);
  return last_stamp_s_;
}

}  // namespace palpate
