// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlopt.hpp>
#include <palpate/identification/noise_moving.hpp>
#include <palpate/identification/noise_statistics.hpp>
#include <palpate/identification/noise_track.hpp>

namespace palpate {

namespace {

constexpr std::size_t kFewest = 30;
constexpr double kFloor = 1e-7;  // m or rad
constexpr std::size_t kWhitenessLags = 10;

/// -log L = 1/2 sum (log S + nu^2 / S), what lies beyond the gate held at the gate.
template <int Order>
double cost(const TimedValues& z, double log_q, double log_r) {
  double sum = 0.0;
  run_smooth_track<Order>(z, std::exp(log_q), std::exp(log_r), [&](double squared, double S, double, std::size_t) {
    sum += std::log(S) + std::min(squared, SmoothTrack<Order>::kGate);
  });
  return 0.5 * sum;
}

struct LogPair {
  double q = 0.0, r = 0.0;
};

/// Scan over q^2 T^(2n-1) / r^2: the filter's gain depends on this ratio alone, and r follows from the median
/// innovation.
template <int Order>
LogPair scan(const TimedValues& z, double least_r) {
  LogPair best{std::log(least_r), std::log(least_r)};
  double least = std::numeric_limits<double>::infinity();
  for (int decade = -10; decade <= 6; ++decade) {
    const double q = std::sqrt(std::pow(10.0, decade) / std::pow(z.period_s, 2 * Order - 1));
    std::vector<double> ratios;
    // The scale is not known yet: with a huge one nothing lies beyond the gate, and the gain is the same.
    run_smooth_track<Order>(z, 1e6 * q, 1e6,
                            [&](double squared, double, double, std::size_t) { ratios.push_back(1e12 * squared); });
    if (ratios.empty()) continue;
    // The median of chi-square with one degree of freedom is 0.4549.
    const double r = std::max(least_r, std::sqrt(quantile(std::move(ratios), 0.5) / 0.4549));
    const LogPair at{std::log(q * r), std::log(r)};
    const double here = cost<Order>(z, at.q, at.r);
    if (here < least) {
      least = here;
      best = at;
    }
  }
  return best;
}

template <int Order>
LogPair minimise(const TimedValues& z, const LogPair& start, double least_r) {
  nlopt::opt search(nlopt::LN_NELDERMEAD, 2);
  const nlopt::vfunc objective = [](const std::vector<double>& x, std::vector<double>&, void* channel) {
    return cost<Order>(*static_cast<const TimedValues*>(channel), x[0], x[1]);
  };
  TimedValues channel = z;
  search.set_min_objective(objective, &channel);
  search.set_lower_bounds({start.q - 40.0, std::log(least_r)});
  search.set_initial_step(0.7);
  search.set_xtol_abs(1e-4);
  search.set_maxeval(400);
  std::vector<double> x{start.q, start.r};
  double least = 0.0;
  try {
    search.optimize(x, least);
  } catch (const nlopt::roundoff_limited&) {  // no better value can be told; x holds the best
  }
  return {x[0], x[1]};
}

/// Of log r, from the curvature of -log L; where the motion is too slow for q to be told, q has no say.
template <int Order>
double log_sigma_of_r(const TimedValues& z, const LogPair& at) {
  constexpr double kStep = 0.05;
  const auto f = [&](double dq, double dr) { return cost<Order>(z, at.q + dq * kStep, at.r + dr * kStep); };
  const double middle = f(0, 0), area = kStep * kStep;
  const double qq = (f(1, 0) - 2.0 * middle + f(-1, 0)) / area, rr = (f(0, 1) - 2.0 * middle + f(0, -1)) / area;
  const double qr = 0.25 * (f(1, 1) - f(1, -1) - f(-1, 1) + f(-1, -1)) / area;
  const double information = qq > 0.0 && qq * rr > qr * qr ? rr - qr * qr / qq : rr;
  return information > 0.0 ? 1.0 / std::sqrt(information) : std::numeric_limits<double>::infinity();
}

void judge_whiteness(MovingChannel& channel) {
  const std::vector<double>& e = channel.innovations;
  double power = 0.0, squares = 0.0;
  for (const double x : e) power += x * x;
  for (std::size_t lag = 1; lag <= kWhitenessLags && power > 0.0; ++lag) {
    double product = 0.0;
    for (std::size_t i = lag; i < e.size(); ++i) product += e[i] * e[i - lag];
    if (lag == 1) channel.lag_one = product / power;
    squares += std::pow(product / power, 2);
  }
  channel.correlation = std::sqrt(squares / kWhitenessLags);
  channel.correlation_if_white = 1.0 / std::sqrt(std::max<double>(1.0, static_cast<double>(e.size())));
}

template <int Order>
MovingChannel fit_order(const TimedValues& z) {
  // A channel that hardly moves within its quantisation would else be told to be exact.
  const double least_r = std::max(kFloor, smallest_step(z.values) / std::sqrt(12.0));
  const LogPair best = minimise<Order>(z, scan<Order>(z, least_r), least_r);
  MovingChannel channel;
  channel.order = Order;
  channel.sigma = std::exp(best.r);
  channel.drive = std::exp(best.q);
  channel.log_likelihood = -cost<Order>(z, best.q, best.r);
  channel.sigma_fraction = log_sigma_of_r<Order>(z, best);
  std::size_t outside = 0;
  run_smooth_track<Order>(z, channel.drive, channel.sigma,
                          [&](double squared, double S, double innovation, std::size_t i) {
                            channel.outliers += squared > SmoothTrack<Order>::kGate ? 1 : 0;
                            outside += squared > 1.959964 * 1.959964 ? 1 : 0;
                            if (squared > SmoothTrack<Order>::kGate) return;
                            channel.innovations.push_back(innovation / std::sqrt(S));
                            channel.times_s.push_back(z.times_s[i]);
                            channel.nis += squared;
                          });
  const auto seen = static_cast<double>(channel.innovations.size());
  channel.outside_95 = static_cast<double>(outside) / (seen + static_cast<double>(channel.outliers));
  channel.nis /= std::max(1.0, seen);
  judge_whiteness(channel);
  return channel;
}

MovingChannel fit(const TimedValues& z) {
  MovingChannel velocity = fit_order<2>(z), acceleration = fit_order<3>(z);
  return acceleration.log_likelihood > velocity.log_likelihood ? acceleration : velocity;
}

/// Positions, and the turn so far about the sensor's axes.
std::array<std::vector<double>, 6> channels_of(const SensorSamples& samples) {
  std::array<std::vector<double>, 6> values;
  Vector3d turned = Vector3d::Zero();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i > 0) turned += log_so3(samples.poses[i - 1].R.transpose() * samples.poses[i].R);
    for (int axis = 0; axis < 3; ++axis) {
      values[static_cast<std::size_t>(axis)].push_back(samples.poses[i].p(axis));
      values[static_cast<std::size_t>(axis) + 3].push_back(turned(axis));
    }
  }
  return values;
}

}  // namespace

bool MovingNoise::holds() const {
  return std::all_of(channels.begin(), channels.begin() + (has_orientation ? 6 : 3),
                     [](const MovingChannel& channel) { return channel.holds(); });
}

MovingNoise identify_moving_noise(const SensorSamples& all) {
  MovingNoise noise;
  static_cast<SensorRecord&>(noise) = all;
  std::vector<std::size_t> distinct;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (i == 0 || !all.same(i, i - 1)) distinct.push_back(i);
  const SensorSamples samples = all.pick(distinct);
  noise.used = samples.size();
  noise.repeated = all.size() - noise.used;
  if (noise.used < kFewest) {
    noise.untold = fmt::format("{} usable readings, {} of them distinct: expected at least {} distinct ones",
                               all.size(), noise.used, kFewest);
    return noise;
  }
  const std::array<std::vector<double>, 6> values = channels_of(samples);
  for (std::size_t k = 0; k < (noise.has_orientation ? 6u : 3u); ++k)
    noise.channels[k] = fit({samples.times_s, values[k], samples.timing.period_s});
  return noise;
}

}  // namespace palpate
