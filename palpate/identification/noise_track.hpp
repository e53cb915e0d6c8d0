// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

/// The Kalman filter behind identify_moving_noise.
namespace palpate {

/// One scalar over time.
struct TimedValues {
  const std::vector<double>& times_s;
  const std::vector<double>& values;
  double period_s;
};

/// Position and its first derivatives, the last of which is driven by white noise: order 2 is constant velocity, order
/// 3 constant acceleration.
template <int Order>
struct SmoothTrack {
  using State = Eigen::Matrix<double, Order, 1>;
  using Square = Eigen::Matrix<double, Order, Order>;
  State x = State::Zero();
  Square P = Square::Zero();

  /// At the first reading; the derivatives are as good as unknown.
  void start(double value, double period_s, double r) {
    x.setZero();
    P.setZero();
    x(0) = value;
    for (int i = 0; i < Order; ++i) P(i, i) = std::pow((i == 0 ? 1.0 : kUnknown) * r / std::pow(period_s, i), 2);
  }
  /// P <- A P A^T + Q;  A_ij = dt^(j-i) / (j-i)!,  Q_ij = q^2 dt^(n-i+n-j-1) / ((n-1-i)! (n-1-j)! (n-i+n-j-1)).
  void predict(double dt, double q) {
    Square A = Square::Identity(), Q;
    for (int i = 0; i < Order; ++i)
      for (int j = i + 1; j < Order; ++j) A(i, j) = j - i == 1 ? dt : 0.5 * dt * dt;
    std::array<double, 2 * Order> powers{q * q};
    for (std::size_t k = 1; k < powers.size(); ++k) powers[k] = dt * powers[k - 1];
    const auto factorial = [](int n) { return n < 2 ? 1.0 : 2.0; };
    for (int i = 0; i < Order; ++i) {
      for (int j = 0; j < Order; ++j) {
        const int power = 2 * Order - 1 - i - j;
        Q(i, j) =
            powers[static_cast<std::size_t>(power)] / (factorial(Order - 1 - i) * factorial(Order - 1 - j) * power);
      }
    }
    x = A * x;
    P = A * P * A.transpose() + Q;
  }
  /// Joseph's form, for an unknown start and a small r stand far apart.
  void update(double innovation, double S, double r) {
    const State gain = P.col(0) / S;
    x += gain * innovation;
    Square rest = Square::Identity();
    rest.col(0) -= gain;
    P = rest * P * rest.transpose() + r * r * gain * gain.transpose();
  }

  static constexpr double kUnknown = 1e4;
  static constexpr int kSettling = 5;            ///< readings that only start the filter
  static constexpr double kGate = 25.0;          ///< squared sigmas: what lies beyond is an outlier
  static constexpr int kMostRejectedInARow = 5;  ///< then the motion has jumped and the filter starts anew
};

/// Runs the filter; `take(normalised innovation squared, S, innovation, i)` sees every reading once it has settled.
template <int Order, class Take>
void run_smooth_track(const TimedValues& z, double q, double r, const Take& take) {
  SmoothTrack<Order> track;
  int rejected = 0, settling = 0;
  for (std::size_t i = 0; i < z.values.size(); ++i) {
    if (settling == 0) {
      track.start(z.values[i], z.period_s, r);
      settling = SmoothTrack<Order>::kSettling;
      continue;
    }
    track.predict(z.times_s[i] - z.times_s[i - 1], q);
    const double innovation = z.values[i] - track.x(0), S = track.P(0, 0) + r * r;
    const double squared = innovation * innovation / S;
    const bool settled = settling == 1;
    if (settled) take(squared, S, innovation, i);
    if (!settled) --settling;
    if (!settled || squared <= SmoothTrack<Order>::kGate) {
      track.update(innovation, S, r);
      rejected = 0;
    } else if (++rejected >= SmoothTrack<Order>::kMostRejectedInARow) {
      settling = rejected = 0;
    }
  }
}

}  // namespace palpate
