// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <palpate/estimation/rhythm.hpp>

namespace palpate {
namespace {

/// Bands: 40-180 beats and 6-40 breaths a minute with one bin to spare on either side, so that a peak at the very end
/// of the band is still an inner one.
constexpr double kHeartFrom_Hz = 0.64, kHeartTo_Hz = 3.04;
constexpr double kBreathingFrom_Hz = 0.0875, kBreathingTo_Hz = 0.6875;
/// The levels that are taken off before: 0.3 Hz and 0.05 Hz.
constexpr double kHeartLevel_s = 0.5, kBreathingLevel_s = 3.0;
/// Contact: the force is not zero, chi-square of three at 99.9 %.
constexpr double kContact = 16.3;

/// Where to look for a fundamental, and what else is heard there.
struct Search {
  double from_Hz, to_Hz;
  double least_N2;        ///< a weaker peak is none
  double other_Hz = 0.0;  ///< another rhythm already found; within kOtherWidth_Hz of its harmonics nothing counts
};
constexpr double kOtherWidth_Hz =
    0.06;  ///< the breathing resonators' answer to the heart has fallen to a fiftieth there

bool belongs_to_other(const Search& search, double frequency_Hz) {
  if (search.other_Hz <= 0.0) return false;
  const double harmonic = std::max(1.0, std::round(frequency_Hz / search.other_Hz));
  return std::abs(frequency_Hz - harmonic * search.other_Hz) < kOtherWidth_Hz;
}

/// Power of the fundamental at `bin` and, at half weight, of its second harmonic: half the frequency, which finds the
/// same tone as its second harmonic, must not win.
template <int n>
double power(const Resonators<n>& resonators, const Search& search, int bin) {
  const double first_Hz = resonators.frequency_Hz(bin), second_Hz = 2.0 * first_Hz;
  const double first = belongs_to_other(search, first_Hz) ? 0.0 : resonators.power_N2(bin);
  const double second = belongs_to_other(search, second_Hz) ? 0.0 : resonators.power_N2(resonators.bin_of(second_Hz));
  return first + 0.5 * second;
}

/// A parabola through the logarithms: a resonator's line is nearly Gaussian at its top. Offset from the middle, in
/// bins.
double parabola_top(double left, double middle, double right) {
  const double bend = std::log(left) - 2.0 * std::log(middle) + std::log(right);
  return bend < 0.0 ? std::clamp(0.5 * std::log(left / right) / bend, -0.5, 0.5) : 0.0;
}

/// The strongest peak in the band, or 0 where nothing stands out. A peak rises above both neighbours; the flank of
/// another rhythm does not.
template <int n>
double fundamental_Hz(const Resonators<n>& resonators, const Search& search, double prominence) {
  const int from = resonators.bin_of(search.from_Hz), to = resonators.bin_of(search.to_Hz);
  double sum = 0.0, best = 0.0, best_Hz = 0.0;
  double left = 0.0, middle = power(resonators, search, from);
  for (int bin = from; bin <= to; ++bin) {
    const double right = bin == to ? 0.0 : power(resonators, search, bin + 1);
    sum += middle;
    if (middle > best && left > 0.0 && right > 0.0 && middle > left && middle > right) {
      best = middle;
      best_Hz = resonators.frequency_Hz(bin) + parabola_top(left, middle, right) * resonators.spacing_Hz();
    }
    left = middle;
    middle = right;
  }
  return best * (to - from + 1) > prominence * sum && best > search.least_N2 ? best_Hz : 0.0;
}

/// Spread of either quadrature of a harmonic: amplitude / sqrt(2).
template <int n, std::size_t harmonics>
void read_sigmas(const Resonators<n>& resonators, double fundamental_Hz, std::array<Vector3d, harmonics>& sigma_N) {
  for (std::size_t h = 0; h < harmonics; ++h)
    sigma_N[h] =
        resonators.amplitude_N(resonators.bin_of(static_cast<double>(h + 1) * fundamental_Hz)) / std::numbers::sqrt2;
}

}  // namespace

template <int kCount>
void Resonators<kCount>::advance(double dt_s, const Vector3d& force_N, bool heard) {
  const double keep = std::exp(-dt_s / memory_s_);
  const double fill = heard ? -std::expm1(-std::min(dt_s, kLongestHold_s) / memory_s_) : 0.0;
  const double pass = 1.0 - keep;
  heard_second_ = keep * heard_second_ + pass * heard_first_;
  heard_first_ = keep * heard_first_ + fill;
  const double step_rad = 2.0 * std::numbers::pi * spacing_Hz_ * dt_s;
  std::complex<double> turn = std::polar(keep, first_ * step_rad);
  const std::complex<double> next = std::polar(1.0, step_rad);
  for (Resonator& r : resonators_) {
    r.second = turn * r.second + (pass / keep) * turn * r.first;
    r.first = turn * r.first + fill * force_N.cast<std::complex<double>>();
    turn *= next;
  }
}

template <int kCount>
bool Resonators<kCount>::knows(int bin) const {
  return bin >= 0 && bin < kCount && heard_second_ >= kLeastHeard;
}

template <int kCount>
double Resonators<kCount>::power_N2(int bin) const {
  if (!knows(bin)) return 0.0;
  return 4.0 / (heard_second_ * heard_second_) * resonators_[static_cast<std::size_t>(bin)].second.squaredNorm();
}

template <int kCount>
Vector3d Resonators<kCount>::amplitude_N(int bin) const {
  if (!knows(bin)) return Vector3d::Zero();
  return 2.0 / heard_second_ * resonators_[static_cast<std::size_t>(bin)].second.cwiseAbs();
}

template class Resonators<141>;
template class Resonators<106>;

RhythmTracker::RhythmTracker() : heart_(0.04, 15, 2.5), breathing_(0.0125, 7, 7.0) {}

void RhythmTracker::observe(double dt_s, const ForceGaussian& force) {
  const Eigen::LLT<Matrix3d> factor(force.covariance_N2);
  const bool usable = factor.info() == Eigen::Success && force.mean_N.allFinite();
  const bool contact = usable && force.mean_N.dot(factor.solve(force.mean_N)) > kContact;
  if (contact) {
    if (!started_) level_N_ = slow_level_N_ = force.mean_N;
    started_ = true;
    level_N_ -= std::expm1(-dt_s / kHeartLevel_s) * (force.mean_N - level_N_);
    slow_level_N_ -= std::expm1(-dt_s / kBreathingLevel_s) * (force.mean_N - slow_level_N_);
  }
  heart_.advance(dt_s, force.mean_N - level_N_, contact);
  breathing_.advance(dt_s, force.mean_N - slow_level_N_, contact);

  const double least_N2 = force.covariance_N2.trace();
  const double heart_Hz = fundamental_Hz(heart_, {kHeartFrom_Hz, kHeartTo_Hz, least_N2}, kProminence);
  heart_locked_ = heart_Hz > 0.0;
  if (heart_locked_) rhythm_.heart_Hz = heart_Hz;
  if (heart_locked_) read_sigmas(heart_, heart_Hz, rhythm_.heart_sigma_N);
  if (!heart_locked_) rhythm_.heart_sigma_N.fill(Vector3d::Zero());

  const double breathing_Hz = fundamental_Hz(
      breathing_, {kBreathingFrom_Hz, kBreathingTo_Hz, least_N2, heart_locked_ ? rhythm_.heart_Hz : 0.0}, kProminence);
  breathing_locked_ = breathing_Hz > 0.0;
  if (breathing_locked_) rhythm_.breathing_Hz = breathing_Hz;
  if (breathing_locked_) read_sigmas(breathing_, breathing_Hz, rhythm_.breathing_sigma_N);
  if (!breathing_locked_) rhythm_.breathing_sigma_N.fill(Vector3d::Zero());
}

}  // namespace palpate
