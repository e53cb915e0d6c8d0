// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <palpate/evaluation/contacts.hpp>

namespace palpate {

/// Contacts while they happen: the force frame by frame, times rising. Constant memory.
class ContactFinder {
 public:
  /// Throws InputError on a rule that is none.
  explicit ContactFinder(const ContactRule& rule = {});

  /// The contact that this frame ended, if it did.
  std::optional<Contact> add(const ForceSize& frame);
  /// The contact that nothing more is to come of.
  std::optional<Contact> finish() { return close(); }

  /// The one that lasts, up to the latest measured frame; without frames: none.
  const Contact& current() const { return contact_; }

 private:
  bool touches(const ForceSize& frame) const;
  bool let_go(const ForceSize& frame) const;
  void extend(const ForceSize& frame);
  std::optional<Contact> close();

  ContactRule rule_;
  ForceSize last_{.time_s = -std::numeric_limits<double>::infinity()};  ///< measured
  bool neighbour_ = false;                                              ///< it is the frame before
  Contact contact_;
};

/// The integral of |F| over time, trapezia between measured frames at most `bridge_s` apart.
class ForceIntegral {
 public:
  explicit ForceIntegral(double bridge_s = ContactRule{}.bridge_s) : bridge_s_(bridge_s) {}

  void add(const ForceSize& frame);

  double integral_Ns = 0.0;
  double sigma_Ns = 0.0;  ///< of one error that lasts throughout: the wide end
  double measured_s = 0.0, unmeasured_s = 0.0;

 private:
  double bridge_s_;
  double time_s_ = std::numeric_limits<double>::quiet_NaN();  ///< of the frame before, measured or not
  std::optional<ForceSize> last_;                             ///< measured
  double open_s_ = 0.0;                                       ///< since it, not yet counted as either
};

}  // namespace palpate
