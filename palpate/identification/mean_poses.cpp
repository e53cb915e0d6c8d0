// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <palpate/identification/mean_poses.hpp>
#include <palpate/sensing/measurement.hpp>

namespace palpate {

namespace {

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Vector3d median_position(const std::vector<Pose>& poses) {
  Vector3d m;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> along;
    along.reserve(poses.size());
    for (const Pose& T : poses) along.push_back(T.p(axis));
    m(axis) = median(std::move(along));
  }
  return m;
}

/// Main axis of the sum of q q^T.
Matrix3d mean_rotation(const std::vector<Pose>& poses) {
  Eigen::Matrix4d moment = Eigen::Matrix4d::Zero();
  for (const Pose& T : poses) {
    const Eigen::Vector4d q = Eigen::Quaterniond(T.R).coeffs();
    moment += q * q.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> axes(moment);
  return Eigen::Quaterniond(Eigen::Vector4d(axes.eigenvectors().col(3))).toRotationMatrix();
}

/// Drops the poses whose `distance` exceeds eight spreads, 1.4826 median(distance) or `noise`.
template <class Distance>
void drop_outliers(std::vector<Pose>& poses, double noise, const Distance& distance) {
  std::vector<double> distances;
  distances.reserve(poses.size());
  for (const Pose& T : poses) distances.push_back(distance(T));
  const double largest = 8.0 * std::max(noise, 1.4826 * median(distances));
  std::erase_if(poses, [&](const Pose& T) { return !(distance(T) <= largest); });
}

MeanPose mean_of(std::vector<Pose> poses, const Sensor& sensor) {
  MeanPose mean;
  if (poses.empty()) return mean;
  const auto seen = static_cast<int>(poses.size());
  const Vector3d middle = median_position(poses);
  drop_outliers(poses, sensor.noise_m.maxCoeff(), [&](const Pose& T) { return (T.p - middle).norm(); });
  const Matrix3d R = mean_rotation(poses);
  drop_outliers(poses, sensor.noise_rad, [&](const Pose& T) { return log_so3(R.transpose() * T.R).norm(); });
  mean.T_base_sensor.R = mean_rotation(poses);
  for (const Pose& T : poses) mean.T_base_sensor.p += T.p / static_cast<double>(poses.size());
  mean.count = static_cast<int>(poses.size());
  mean.outliers = seen - mean.count;
  return mean;
}

}  // namespace

std::vector<MeanPose> mean_poses(const Catheter& catheter, std::span<const TrackerFrame> frames, double from_s,
                                 double to_s) {
  std::vector<std::vector<Pose>> poses(catheter.sensors.size());
  Measurement measurement;
  for (const TrackerFrame& frame : frames) {
    if (!(frame.time_s >= from_s && frame.time_s <= to_s)) continue;
    register_frame(catheter, frame, measurement);
    for (int k = 0; k < measurement.count; ++k)
      poses[static_cast<std::size_t>(measurement.poses[k].sensor)].push_back(measurement.poses[k].T_base_sensor);
  }
  std::vector<MeanPose> means;
  for (std::size_t i = 0; i < poses.size(); ++i) means.push_back(mean_of(std::move(poses[i]), catheter.sensors[i]));
  return means;
}

}  // namespace palpate
