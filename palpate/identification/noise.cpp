// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <palpate/identification/noise.hpp>
#include <palpate/identification/noise_statistics.hpp>
#include <palpate/math/units.hpp>

namespace palpate {

namespace {

constexpr std::size_t kFewestDistinct = 10;
constexpr double kFloor_m = 1e-7, kFloor_rad = 2e-6;
constexpr double kOutlierSpreads = 8.0;
constexpr double kMoves_m = 2e-3, kMoves_rad = 2.0 * kRadiansPerDegree;  // no tracker at rest scatters so
constexpr double kMovesOverWhite = 3.0;

using Channels6 = std::array<std::vector<double>, 6>;

/// Mean of the positions and main axis of the sum of q q^T.
Pose mean_pose(const SensorSamples& samples) {
  Pose mean;
  Eigen::Matrix4d moment = Eigen::Matrix4d::Zero();
  for (const Pose& T : samples.poses) {
    mean.p += T.p / static_cast<double>(samples.size());
    const Eigen::Vector4d q = Eigen::Quaterniond(T.R).coeffs();
    moment += q * q.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> axes(moment);
  mean.R = Eigen::Quaterniond(Eigen::Vector4d(axes.eigenvectors().col(3))).normalized().toRotationMatrix();
  return mean;
}

Vector6d deviation(const Pose& mean, const Pose& T) {
  Vector6d d;
  d << T.p - mean.p, log_so3(mean.R.transpose() * T.R);
  return d;
}

/// Which readings lie within eight spreads of `middle`; the spread from the nearest four fifths of them, 2.15 sigma of
/// a normal distribution in 3-D. Most readings may be exactly equal, so a median would not do.
void keep_near(const std::vector<double>& distances, double step, std::vector<bool>& keep) {
  const double spread = std::max(quantile(distances, 0.8) / 2.154, step);
  for (std::size_t i = 0; i < keep.size(); ++i) keep[i] = keep[i] && distances[i] <= kOutlierSpreads * spread;
}

/// The place half of the readings are below of, axis by axis.
Vector3d median_position(const SensorSamples& samples) {
  Vector3d median;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> along;
    for (const Pose& T : samples.poses) along.push_back(T.p(axis));
    median(axis) = quantile(std::move(along), 0.5);
  }
  return median;
}

Vector6d steps_of(const SensorSamples& samples) {
  Vector6d step = Vector6d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> along;
    for (const Pose& T : samples.poses) along.push_back(T.p(axis));
    step(axis) = smallest_step(std::move(along));
  }
  // An axis that never changes is rounded like the others.
  const double coarsest = step.head<3>().maxCoeff();
  for (int axis = 0; axis < 3; ++axis)
    if (step(axis) == 0.0) step(axis) = coarsest;
  if (!samples.has_orientation) return step;
  double largest = 0.0;
  for (int entry = 0; entry < 4; ++entry) {
    std::vector<double> values;
    for (const Eigen::Vector4d& q : samples.quaternions_wxyz) values.push_back(q(entry));
    largest = std::max(largest, smallest_step(std::move(values)));
  }
  step.tail<3>().setConstant(2.0 * largest);  // dq = dphi / 2
  return step;
}

SensorSamples without_outliers(const SensorSamples& samples, const Vector6d& step) {
  std::vector<bool> keep(samples.size(), true);
  const Vector3d middle = median_position(samples);
  const Pose mean = mean_pose(samples);
  std::vector<double> far_m, turned_rad;
  for (const Pose& T : samples.poses) {
    far_m.push_back((T.p - middle).norm());
    turned_rad.push_back(deviation(mean, T).tail<3>().norm());
  }
  keep_near(far_m, std::max(kFloor_m, step.head<3>().maxCoeff()), keep);
  if (samples.has_orientation) keep_near(turned_rad, std::max(kFloor_rad, step(3)), keep);
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < keep.size(); ++i)
    if (keep[i]) kept.push_back(i);
  return samples.pick(kept);
}

Channels6 deviations_of(const SensorSamples& samples, RestNoise& noise) {
  noise.mean = mean_pose(samples);
  noise.times_s = samples.times_s;
  Channels6 channels;
  for (const Pose& T : samples.poses) {
    noise.deviations.push_back(deviation(noise.mean, T));
    for (int k = 0; k < 6; ++k) channels[static_cast<std::size_t>(k)].push_back(noise.deviations.back()(k));
  }
  return channels;
}

/// First lag at which readings no longer repeat each other.
std::size_t lag_without_repeats(const SensorSamples& samples) {
  const std::size_t most = std::clamp<std::size_t>(samples.size() / 10, 1, 20);
  std::size_t best = 1;
  double fewest = 2.0;
  for (std::size_t lag = 1; lag <= most; ++lag) {
    std::size_t same = 0;
    for (std::size_t i = lag; i < samples.size(); ++i) same += samples.same(i, i - lag) ? 1 : 0;
    const double share = static_cast<double>(same) / static_cast<double>(samples.size() - lag);
    if (share < fewest) {
      fewest = share;
      best = lag;
    }
    if (share <= 0.05) return lag;
  }
  return best;
}

/// One standard deviation of the root of mean(values^2), relative: squares have a variance and hang together, too.
double fraction_of_sigma(std::vector<double> values) {
  for (double& value : values) value *= value;
  const double n = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  if (!(mean > 0.0)) return 0.0;
  double variance = 0.0;
  for (const double value : values) variance += (value - mean) * (value - mean) / n;
  return 0.5 * std::sqrt(variance * samples_per_independent(values) / n) / mean;
}

void set_covariance(const Channels6& channels, int count, RestNoise& noise) {
  const double n = static_cast<double>(noise.used);
  double slowest = 1.0;
  for (int k = 0; k < count; ++k) {
    const std::vector<double>& values = channels[static_cast<std::size_t>(k)];
    slowest = std::max(slowest, samples_per_independent(values));
    noise.sigma_fraction = std::max(noise.sigma_fraction, fraction_of_sigma(values));
  }
  noise.effective_samples = std::max(2.0, std::min(n / slowest, static_cast<double>(noise.distinct)));
  noise.correlation_time_s = noise.timing.duration_s / noise.effective_samples;
  Matrix6d scatter = Matrix6d::Zero();
  for (const Vector6d& d : noise.deviations) scatter += d * d.transpose() / n;
  scatter *= 1.0 / (1.0 - 1.0 / noise.effective_samples);
  noise.covariance.topLeftCorner(count, count) = scatter.topLeftCorner(count, count);
  for (int k = 0; k < 6; ++k) {
    const double floor = k < 3 ? kFloor_m : kFloor_rad;
    noise.covariance(k, k) += floor * floor + hidden_quantisation_variance(noise.step(k), noise.covariance(k, k));
  }
}

/// Root mean square over three channels from `first` on.
template <class Variance>
double rms_of(const Channels6& channels, std::size_t first, const Variance& variance) {
  return std::sqrt((variance(channels[first]) + variance(channels[first + 1]) + variance(channels[first + 2])) / 3.0);
}

void set_speeds(const Channels6& channels, std::size_t lag, RestNoise& noise) {
  const auto split = [&](std::size_t first, double& white, double& slow) {
    const auto along = static_cast<Eigen::Index>(first);
    const double total = noise.covariance.diagonal().segment<3>(along).mean();
    const double unseen = noise.step.segment<3>(along).squaredNorm() / 36.0;  // q^2/12, mean of three
    const double fast =
        std::pow(rms_of(channels, first, [&](const auto& values) { return difference_variance(values, lag); }), 2);
    const double white_variance = std::min(total, std::max(fast, unseen));
    white = std::sqrt(white_variance);
    slow = std::sqrt(total - white_variance);
  };
  split(0, noise.white_m, noise.slow_m);
  if (noise.has_orientation) split(3, noise.white_rad, noise.slow_rad);
}

Rest judge(const RestNoise& noise) {
  const auto moves = [](double white, double slow, double limit) {
    return std::hypot(white, slow) > std::min(limit, std::max(kMovesOverWhite * white, 0.02 * limit));
  };
  if (moves(noise.white_m, noise.slow_m, kMoves_m)) return Rest::kMoves;
  if (moves(noise.white_rad, noise.slow_rad, kMoves_rad)) return Rest::kMoves;
  return noise.slow_m > noise.white_m || noise.slow_rad > noise.white_rad ? Rest::kDrifts : Rest::kStill;
}

AllanDeviation allan_of(const Channels6& channels, const RestNoise& noise) {
  AllanDeviation allan;
  for (double count = 1.0; 4.0 * count <= static_cast<double>(noise.used); count = std::ceil(1.4 * count)) {
    const auto variance = [&](const auto& values) { return allan_variance(values, static_cast<std::size_t>(count)); };
    allan.tau_s.push_back(count / noise.timing.mean_rate_Hz);
    allan.position_m.push_back(rms_of(channels, 0, variance));
    if (noise.has_orientation) allan.rotation_rad.push_back(rms_of(channels, 3, variance));
  }
  return allan;
}

double worst_sigma(const Matrix3d& covariance) {
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Matrix3d>(covariance).eigenvalues()(2));
}

}  // namespace

double RestNoise::worst_position_sigma_m() const { return worst_sigma(covariance.topLeftCorner<3, 3>()); }
double RestNoise::worst_rotation_sigma_rad() const { return worst_sigma(covariance.bottomRightCorner<3, 3>()); }

RestNoise identify_rest_noise(const SensorSamples& all) {
  RestNoise noise;
  static_cast<SensorRecord&>(noise) = all;
  noise.distinct = all.count_distinct();
  if (noise.distinct < kFewestDistinct) {
    noise.untold = fmt::format("{} usable readings, {} of them distinct: expected at least {} distinct ones",
                               all.size(), noise.distinct, kFewestDistinct);
    return noise;
  }
  noise.step = steps_of(all);
  const SensorSamples samples = without_outliers(all, noise.step);
  noise.outliers = all.size() - samples.size();
  noise.used = samples.size();
  noise.distinct = samples.count_distinct();
  const Channels6 channels = deviations_of(samples, noise);
  set_covariance(channels, noise.has_orientation ? 6 : 3, noise);
  set_speeds(channels, lag_without_repeats(samples), noise);
  noise.rest = judge(noise);
  noise.allan = allan_of(channels, noise);
  return noise;
}

}  // namespace palpate
