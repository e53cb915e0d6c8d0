// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <complex>
#include <palpate/estimation/motion_model.hpp>

namespace palpate {

/// A row of resonators at frequencies k spacing, each listening to three axes: two leaky integrators behind each other,
///
///   r1' = (i w - 1/T) r1 + F / T,   r2' = (i w - 1/T) r2 + r1 / T
///
/// so that |r2| is half the amplitude of F's oscillation at w over the last 2 T or so; sideways it falls with the
/// square of the distance, (1 + (dw T)^2)^-1. Frames in which nothing is heard let it fade; amplitudes are relative to
/// what was heard. No allocation; about 25 ns a resonator and frame.
template <int kCount>
class Resonators {
 public:
  Resonators(double spacing_Hz, int first, double memory_s)
      : spacing_Hz_(spacing_Hz), first_(first), memory_s_(memory_s) {}

  /// dt_s later; `force_N` held over at most the last `kLongestHold_s`, or nothing where `heard` is false.
  void advance(double dt_s, const Vector3d& force_N, bool heard);

  double frequency_Hz(int bin) const { return (first_ + bin) * spacing_Hz_; }
  double spacing_Hz() const { return spacing_Hz_; }
  /// Bin whose frequency is nearest; may lie outside [0, kCount).
  int bin_of(double frequency_Hz) const { return static_cast<int>(std::lround(frequency_Hz / spacing_Hz_)) - first_; }
  /// Squared amplitudes, summed over the axes; zero for bins outside and while too little was heard.
  double power_N2(int bin) const;
  /// Amplitude a tip axis; zero for bins outside and while too little was heard.
  Vector3d amplitude_N(int bin) const;

 private:
  bool knows(int bin) const;

  static constexpr double kLongestHold_s = 0.1;
  static constexpr double kLeastHeard = 0.1;  ///< share of the memory that must have been filled

  struct Resonator {
    Eigen::Vector3cd first = Eigen::Vector3cd::Zero(), second = Eigen::Vector3cd::Zero();
  };
  double spacing_Hz_;
  int first_;
  double memory_s_;
  std::array<Resonator, kCount> resonators_;
  double heard_first_ = 0.0, heard_second_ = 0.0;  ///< the same filters, of 1 where heard
};

/// Finds heart rate (40-180 beats/min) and breathing rate (6-40 breaths/min) in the force by itself, and how strong
/// each harmonic is on each axis. The fundamental is where it and its second harmonic together hold the most power, by
/// a parabola through the peak. A peak at the edge of the band is none, nor is one that stands out less than
/// kProminence times from the band's mean, or one of less than a sigma of the force. While the force is not
/// distinguishable from zero (contact lost) nothing is heard. Locks in about 5 s (heart) and 15 s (breathing). No
/// allocation; about 10 us a frame.
class RhythmTracker {
 public:
  RhythmTracker();

  /// dt_s after the frame before; `force`: the latest estimate of the seen force. Call it for held frames, too.
  void observe(double dt_s, const ForceGaussian& force);

  /// Last frequencies found; the sigmas are zero while there is no lock.
  const Rhythm& rhythm() const { return rhythm_; }
  bool heart_locked() const { return heart_locked_; }
  bool breathing_locked() const { return breathing_locked_; }

 private:
  static constexpr double kProminence = 4.0;
  static constexpr int kHeartBins = 141, kBreathingBins = 106;  ///< 0.6-6.2 Hz, 0.0875-1.4 Hz

  Resonators<kHeartBins> heart_;
  Resonators<kBreathingBins> breathing_;
  bool started_ = false;
  Vector3d level_N_ = Vector3d::Zero(), slow_level_N_ = Vector3d::Zero();
  Rhythm rhythm_;
  bool heart_locked_ = false, breathing_locked_ = false;
};

}  // namespace palpate
