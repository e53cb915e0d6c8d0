// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/evaluation/force_size.hpp>
#include <palpate/math/units.hpp>
#include <string>

namespace palpate {

/// When the tip touches. A contact begins with a measured frame of |F| >= on_N and |F| >= 1.96 of its own sigma. It
/// ends before the first measured frame of |F| < off_share * on_N or |F| < its sigma, or where nothing was measured for
/// longer than bridge_s. A single frame is no contact.
struct ContactRule {
  double on_N = 5.0 / kGramsForcePerNewton;  ///< range (0, 100]
  double off_share = 0.7;                    ///< range (0, 1]
  double bridge_s = 0.25;                    ///< range [0, 10]

  /// Throws InputError naming the field, its value and the range.
  void validate() const;
};

/// The rule for a person, in grams-force and newtons.
std::string in_words(const ContactRule& rule);

/// From the first to the last measured frame of one contact.
struct Contact {
  double from_s = 0.0, to_s = 0.0;
  std::size_t frames = 0;  ///< measured ones
  double largest_N = 0.0, largest_at_s = 0.0;
  double integral_Ns = 0.0;        ///< of |F| over time: trapezia between measured frames
  double integral_sigma_Ns = 0.0;  ///< of the sigma, as if one error lasted through the contact: the wide end
  double bridged_s = 0.0;          ///< of the duration: between measured frames that are not neighbours

  double duration_s() const { return to_s - from_s; }
  double mean_N() const { return integral_Ns / duration_s(); }
};

/// Contacts in time order. A clock that stands still or steps back ends a contact.
std::vector<Contact> find_contacts(std::span<const ForceSize> frames, const ContactRule& rule = {});

/// For how long |F| was in which band.
struct TimeInBands {
  std::vector<double> seconds;  ///< one more than there are edges; a force on an edge is in the upper band
  double not_measured_s = 0.0;  ///< frames not measured, and where no frame came for `most_s`
  double total_s = 0.0;         ///< all of the above: from the first to the last frame
};

/// Each measured frame stands for the time to the next frame, at most for `most_s`. Throws InputError where `edges_N`
/// are not positive and rising.
TimeInBands time_in_bands(std::span<const ForceSize> frames, std::span<const double> edges_N, double most_s = 0.25);

}  // namespace palpate
