// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/sensing/catheter.hpp>
#include <palpate/sensing/tracker_frame.hpp>
#include <span>

/// Zero-force tare: what a stretch of recording without tip force says about base and precurvature.
namespace palpate {

struct TareInterval {
  double from_s = 0.0, to_s = 0.0;
  bool straight =
      false;  ///< held straight by hand: no bend at all; otherwise unloaded: precurvature and own weight act
};

struct Tare {
  Catheter catheter;                              ///< the corrected one, with the sigmas that remain
  int frames = 0;                                 ///< that were averaged, of the sensor seen most often
  int outliers = 0;                               ///< readings left out of the averages
  Vector3d base_shift_m = Vector3d::Zero();       ///< of the clamp, in the old base frame
  Vector3d base_rotation_rad = Vector3d::Zero();  ///< rotation vector, in the old base frame
  Vector3d precurvature_change_per_m = Vector3d::Zero();
  double largest_change_sigmas =
      0.0;  ///< of all corrections, in sigmas as stated before; above 4 the interval is doubtful
  double residual_before_m = 0.0, residual_after_m = 0.0;  ///< rms over the sensors' positions
};

/// Most probable base pose and precurvature given the sensors' mean poses in the interval and what the catheter file
/// states (values and sigmas): a MAP estimate by iterated updates. What has sigma 0 stays as it is; so does the base
/// where it is tracked, and the precurvature where the shaft is held straight. A sensor with a registration of its own
/// (Sensor::T_tracker_base) keeps it, for how [base] is off in one tracker says nothing of another: it helps to find
/// the precurvature. A tendon's mean moment acts as stated. `frames`: readings in the order of Catheter::sensors.
/// Throws InputError where the interval holds no usable frame or the fit does not converge.
Tare tare(const Catheter& catheter, std::span<const TrackerFrame> frames, const TareInterval& interval);

}  // namespace palpate
