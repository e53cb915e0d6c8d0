// SPDX-License-Identifier: Apache-2.0
#include "reference_tare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <palpate/math/units.hpp>

namespace palpate::app {

namespace {

void warn_of_doubtful_tare(const Catheter& catheter, const Tare& found, std::vector<std::string>& warnings) {
  const BaseRegistration& base = catheter.base;
  if (base.position_sigma_m == 0.0 && base.rotation_sigma_rad == 0.0 && catheter.precurvature_sigma_per_m.isZero(0.0))
    warnings.emplace_back(
        "reference: corrects nothing, for the catheter file states no position_sigma_mm, "
        "rotation_sigma_deg or precurvature_sigma_per_m");
  if (found.largest_change_sigmas > 4.0)
    warnings.push_back(
        fmt::format("reference: a correction is {:.1f} times the sigma stated for it: is the tip free of force in this "
                    "interval?",
                    found.largest_change_sigmas));
  double noise_m = 0.0;
  for (const Sensor& sensor : catheter.sensors) noise_m = std::max(noise_m, sensor.noise_m.maxCoeff());
  if (found.residual_after_m > 5.0 * noise_m)
    warnings.push_back(
        fmt::format("reference: the sensors stay {:.2f} mm off: is the tip free of force in this interval?",
                    found.residual_after_m * kMillimetresPerMetre));
}

}  // namespace

CorrectedCatheter correct_by_reference(const CatheterFile& file, const TrackerRecording& recording,
                                       std::vector<std::string>& warnings) {
  const ReferenceInterval& reference = file.reference;
  if (!reference.given) return {file.catheter, std::nullopt};
  const Tare found = tare(file.catheter, recording.frames, {reference.from_s, reference.to_s, reference.straight});
  warn_of_doubtful_tare(file.catheter, found, warnings);
  const bool driven = std::any_of(recording.frames.begin(), recording.frames.end(),
                                  [](const TrackerFrame& frame) { return frame.bend.present; });
  // A tare in one position says little of the others.
  return {driven ? driven_by_map(found.catheter) : found.catheter, found};
}

}  // namespace palpate::app
