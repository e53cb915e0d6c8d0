// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <palpate/estimation/process_noise.hpp>
#include <palpate/math/errors.hpp>
#include <string>

namespace palpate {
namespace {

/// A direction that a frame does not see is taken as known to this much, ten times any force here: as good as nothing.
constexpr double kUnseen_N = 10.0;
/// An axis known no better than this is passed over: more than a percent of it would be made of the line above.
constexpr double kUseless_N = 1.0;

void require(bool good, const char* field, double value, const char* range) {
  if (good) return;
  throw InputError("process noise options: " + std::string(field) + " = " + std::to_string(value) + ": expected " +
                   range);
}

template <std::size_t n>
void normalise(std::array<double, n>& weight) {
  double sum = 0.0;
  for (const double w : weight) sum += w;
  for (double& w : weight) w /= sum;
}

}  // namespace

/// Velocity: a rate that wanders by 0.5 mN/s in a second is below what a resting tissue or hand does; 50 N/s^1.5 moves
/// the force by 0.1 N in a frame at 40 Hz. Walk: 0.5 mN and 10 N in a second.
ProcessNoiseOptions ProcessNoiseOptions::of(ForceMotion motion) {
  ProcessNoiseOptions out;
  if (motion == ForceMotion::kConstantVelocity || motion == ForceMotion::kRhythm) return out;
  out.largest_drive = 10.0;
  out.prior_drive = 0.1;
  return out;
}

void ProcessNoiseOptions::validate() const {
  require(least_drive > 0.0 && least_drive < largest_drive, "least_drive", least_drive,
          "more than 0, less than largest_drive");
  require(std::isfinite(largest_drive), "largest_drive", largest_drive, "a number");
  require(prior_drive >= least_drive && prior_drive <= largest_drive, "prior_drive", prior_drive,
          "least_drive..largest_drive");
  require(prior_spread >= 0.1 && prior_spread <= 100.0, "prior_spread", prior_spread, "0.1..100");
  require(drift_per_s >= 0.0 && drift_per_s <= 1e3, "drift_per_s", drift_per_s, "0..1000");
  require(change_per_s >= 0.0 && change_per_s <= 1e3, "change_per_s", change_per_s, "0..1000");
}

ProcessNoise::ProcessNoise(const MotionModel& model, const ProcessNoiseOptions& options)
    : motion_(model.options()), options_(options), has_rate_(model.has_rate()) {
  options_.validate();
  const double ratio = std::pow(options.largest_drive / options.least_drive, 1.0 / (kGrid - 1));
  for (std::size_t g = 0; g < kGrid; ++g) {
    grid_[g] = options.least_drive * std::pow(ratio, static_cast<double>(g));
    const double off = std::log(grid_[g] / options.prior_drive) / options.prior_spread;
    prior_weight_[g] = std::exp(-0.5 * off * off);
  }
  normalise(prior_weight_);
  for (int i = 0; i < 3; ++i) {
    Axis& axis = axes_[static_cast<std::size_t>(i)];
    axis.weight = prior_weight_;
    axis.followers.fill(start(i));
  }
}

/// Before the first frame, and again where a filter has been blind for so long that its variance means nothing.
ProcessNoise::Follower ProcessNoise::start(int axis) const {
  Follower out;
  const double rate = has_rate_ ? motion_.rate_sigma_N_per_s : 0.0, disturbance = motion_.disturbance_rms_N(axis);
  out.covariance.diagonal() << motion_.force_sigma_N * motion_.force_sigma_N, rate * rate, disturbance * disturbance;
  return out;
}

void ProcessNoise::predict(double dt_s) {
  const FadingRate fading(dt_s, motion_.rate_memory_s);
  const double keep = std::exp(-dt_s / motion_.disturbance_memory_s), lost = 1.0 - keep * keep;
  Matrix3d A = Matrix3d::Identity(), unit_noise = Matrix3d::Zero();
  A(2, 2) = keep;
  unit_noise(0, 0) = dt_s;
  if (has_rate_) {
    A(0, 1) = fading.travel_s;
    A(1, 1) = fading.keep;
    unit_noise(0, 0) = fading.variance(0);
    unit_noise(0, 1) = unit_noise(1, 0) = fading.variance(1);
    unit_noise(1, 1) = fading.variance(2);
  }
  for (int i = 0; i < 3; ++i) {
    Axis& axis = axes_[static_cast<std::size_t>(i)];
    const double disturbance = motion_.disturbance_rms_N(i);
    for (std::size_t g = 0; g < kGrid; ++g) {
      Follower& f = axis.followers[g];
      f.mean = A * f.mean;
      f.covariance = A * f.covariance * A.transpose() + grid_[g] * grid_[g] * unit_noise;
      f.covariance(2, 2) += lost * disturbance * disturbance;
      if (f.covariance(0, 0) > kUnseen_N * kUnseen_N) f = start(i);
    }
    mix_weights(dt_s, axis.weight);
  }
}

/// The chain's transition over dt: to either neighbour with half of the drift, less often where the prior thinks less
/// of it (Metropolis), so that without data the weights stay the prior; a change draws anew from the prior, which also
/// bounds what a long rest can say against a movement to come.
void ProcessNoise::mix_weights(double dt_s, Weights& weight) const {
  const double drift = -std::expm1(-dt_s * options_.drift_per_s), change = -std::expm1(-dt_s * options_.change_per_s);
  Weights drifted = weight;
  for (std::size_t g = 0; g + 1 < kGrid; ++g) {
    const double up = std::min(1.0, prior_weight_[g + 1] / prior_weight_[g]);
    const double down = std::min(1.0, prior_weight_[g] / prior_weight_[g + 1]);
    const double flow = 0.5 * drift * (up * weight[g] - down * weight[g + 1]);
    drifted[g] -= flow;
    drifted[g + 1] += flow;
  }
  for (std::size_t g = 0; g < kGrid; ++g) weight[g] = (1.0 - change) * drifted[g] + change * prior_weight_[g];
}

void ProcessNoise::jump() {
  for (Axis& axis : axes_)
    for (Follower& f : axis.followers) {
      f.covariance(0, 0) += motion_.force_sigma_N * motion_.force_sigma_N;
      if (has_rate_) f.covariance(1, 1) += motion_.rate_sigma_N_per_s * motion_.rate_sigma_N_per_s;
    }
}

void ProcessNoise::observe(const ForceLikelihood& likelihood, const ForceGaussian& explained) {
  Matrix3d information = likelihood.information_per_N2;
  information.diagonal().array() += 1.0 / (kUnseen_N * kUnseen_N);
  const Eigen::LLT<Matrix3d> factor(information);
  if (factor.info() != Eigen::Success) return;
  const Vector3d z = factor.solve(likelihood.information_mean_per_N) - explained.mean_N;
  const Matrix3d R = factor.solve(Matrix3d::Identity()) + explained.covariance_N2;
  if (!z.allFinite() || !R.allFinite()) return;
  for (int i = 0; i < 3; ++i)
    if (R(i, i) < kUseless_N * kUseless_N) observe_axis(z(i), R(i, i), axes_[static_cast<std::size_t>(i)]);
}

void ProcessNoise::observe_axis(double z_N, double variance_N2, Axis& axis) const {
  std::array<double, kGrid> log_likelihood{};
  double best = -std::numeric_limits<double>::infinity();
  for (std::size_t g = 0; g < kGrid; ++g) {
    Follower& f = axis.followers[g];
    const Vector3d PH = f.covariance.col(0) + f.covariance.col(2);  // h = (1, 0, 1): level and disturbance are seen
    const double S = PH(0) + PH(2) + variance_N2, nu = z_N - f.mean(0) - f.mean(2);
    log_likelihood[g] = -0.5 * (std::log(S) + nu * nu / S);
    best = std::max(best, log_likelihood[g]);
    f.mean += PH * (nu / S);
    f.covariance -= PH * PH.transpose() / S;
  }
  for (std::size_t g = 0; g < kGrid; ++g) axis.weight[g] *= std::exp(log_likelihood[g] - best);
  // The chain keeps every weight above rounding, but not without time passing between frames.
  for (double& w : axis.weight) w = std::max(w, 1e-12);
  normalise(axis.weight);
}

Vector3d ProcessNoise::drive_ahead(double ahead_s) const {
  Vector3d out = Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    Weights weight = axes_[static_cast<std::size_t>(i)].weight;
    if (ahead_s > 0.0) mix_weights(ahead_s, weight);
    for (std::size_t g = 0; g < kGrid; ++g) out(i) += weight[g] * grid_[g] * grid_[g];
  }
  return out.cwiseSqrt();
}

}  // namespace palpate
