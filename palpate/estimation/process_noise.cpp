// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
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
    for (std::size_t g = 0; g < kGrid; ++g) restart(i, g, axis);
  }
}

/// Before the first frame, and again where a filter has been blind for so long that its variance means nothing.
void ProcessNoise::restart(int axis, std::size_t g, Axis& out) const {
  const double rate = has_rate_ ? motion_.rate_sigma_N_per_s : 0.0, disturbance = motion_.disturbance_rms_N(axis);
  out.x[g] = out.v[g] = out.d[g] = out.xv[g] = out.xd[g] = out.vd[g] = 0.0;
  out.xx[g] = motion_.force_sigma_N * motion_.force_sigma_N;
  out.vv[g] = rate * rate;
  out.dd[g] = disturbance * disturbance;
}

/// x' = x + t v, v' = k v, d' = e d, and P' = A P A^T + q^2 Q.
void ProcessNoise::predict(double dt_s) {
  const FadingRate fading(dt_s, motion_.rate_memory_s);
  const double e = std::exp(-dt_s / motion_.disturbance_memory_s), lost = 1.0 - e * e;
  const double t = has_rate_ ? fading.travel_s : 0.0, k = has_rate_ ? fading.keep : 1.0;
  const Vector3d Q = has_rate_ ? fading.variance : Vector3d(dt_s, 0.0, 0.0);
  for (int i = 0; i < 3; ++i) {
    Axis& a = axes_[static_cast<std::size_t>(i)];
    const double refilled = lost * motion_.disturbance_rms_N(i) * motion_.disturbance_rms_N(i);
    for (std::size_t g = 0; g < kGrid; ++g) {
      const double q2 = grid_[g] * grid_[g];
      a.x[g] += t * a.v[g];
      a.v[g] *= k;
      a.d[g] *= e;
      a.xx[g] += t * (2.0 * a.xv[g] + t * a.vv[g]) + q2 * Q(0);
      a.xv[g] = k * (a.xv[g] + t * a.vv[g]) + q2 * Q(1);
      a.vv[g] = k * k * a.vv[g] + q2 * Q(2);
      a.xd[g] = e * (a.xd[g] + t * a.vd[g]);
      a.vd[g] *= k * e;
      a.dd[g] = e * e * a.dd[g] + refilled;
    }
    for (std::size_t g = 0; g < kGrid; ++g)
      if (a.xx[g] > kUnseen_N * kUnseen_N) restart(i, g, a);
    mix_weights(dt_s, a.weight);
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
  for (Axis& a : axes_)
    for (std::size_t g = 0; g < kGrid; ++g) {
      a.xx[g] += motion_.force_sigma_N * motion_.force_sigma_N;
      if (has_rate_) a.vv[g] += motion_.rate_sigma_N_per_s * motion_.rate_sigma_N_per_s;
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

/// Level and disturbance are seen: nu = z - x - d, S = P_x + P_d + R with P_x = P_xx + P_xd and so on.
void ProcessNoise::observe_axis(double z_N, double variance_N2, Axis& a) const {
  Weights S{}, distance{};
  for (std::size_t g = 0; g < kGrid; ++g) {
    const double Px = a.xx[g] + a.xd[g], Pv = a.xv[g] + a.vd[g], Pd = a.xd[g] + a.dd[g];
    S[g] = Px + Pd + variance_N2;
    const double nu = z_N - a.x[g] - a.d[g], gain = nu / S[g];
    distance[g] = nu * gain;
    a.x[g] += Px * gain;
    a.v[g] += Pv * gain;
    a.d[g] += Pd * gain;
    a.xx[g] -= Px * Px / S[g];
    a.xv[g] -= Px * Pv / S[g];
    a.vv[g] -= Pv * Pv / S[g];
    a.xd[g] -= Px * Pd / S[g];
    a.vd[g] -= Pv * Pd / S[g];
    a.dd[g] -= Pd * Pd / S[g];
  }
  // Likelihoods over that of the best: exp((least - (distance + ln S)) / 2), the logarithm left out of the exponent.
  const double least = *std::min_element(distance.begin(), distance.end());
  for (std::size_t g = 0; g < kGrid; ++g)
    a.weight[g] *= std::exp(0.5 * (least - distance[g])) * std::sqrt(variance_N2 / S[g]);
  normalise(a.weight);
  // The chain keeps every weight above rounding, but not without time passing between frames.
  for (double& w : a.weight) w = std::max(w, 1e-12);
  normalise(a.weight);
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
