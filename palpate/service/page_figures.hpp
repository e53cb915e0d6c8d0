// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <palpate/evaluation/beat_finder.hpp>
#include <palpate/evaluation/contact_finder.hpp>
#include <palpate/service/page_schema.hpp>
#include <palpate/session/live_record.hpp>
#include <vector>

namespace palpate::service {

/// What a person reads of one force, with sigmas to second order where it is a size.
struct ForceParts {
  bool measured = false;  ///< otherwise every number is NaN
  double size_N, sigma_size_N;
  double axial_N, sigma_axial_N;  ///< along d3
  double lateral_N, sigma_lateral_N;
  double angle_rad, sigma_angle_rad;  ///< atan2(lateral, -axial); NaN where the force is within 1.96 of its sigma

  ForceParts();
  explicit ForceParts(const Estimate& estimate);
};

/// What is said of the force over time: every record counts, whatever a page gets to see of them.
class LiveFigures {
 public:
  void take(const session::LiveRecord& record);

  const ForceParts& latest() const { return latest_; }
  bool in_contact() const { return finder_.current().frames > 1; }  ///< a single frame is none
  /// The contact that lasts, or the latest one; without frames: none yet.
  const Contact& contact() const { return in_contact() ? finder_.current() : last_contact_; }
  const ForceIntegral& integral() const { return integral_; }
  /// Looked for again once a second.
  const std::optional<BeatFinder::Beat>& beat() const { return beat_; }

 private:
  ForceParts latest_;
  ContactFinder finder_;
  Contact last_contact_;
  ForceIntegral integral_;
  BeatFinder beats_;
  std::optional<BeatFinder::Beat> beat_;
  double beat_due_s_ = 0.0;
};

/// The past of one catheter, as a page that connects gets it: of every kPageHistoryStep_s the record of the largest
/// force, or one without force where none was measured.
class PageHistory {
 public:
  using Row = std::array<double, kPageHistory.size()>;

  PageHistory() { rows_.reserve(kMostRows); }
  void take(const Row& row);
  std::size_t rows() const { return rows_.size(); }
  /// All rows, oldest first, one after the other.
  void append_to(std::vector<double>& out) const;

 private:
  static constexpr auto kMostRows = static_cast<std::size_t>(kPageHistory_s / kPageHistoryStep_s);
  std::vector<Row> rows_;  // a ring once it is full
  std::size_t oldest_ = 0;
  double step_ = -1.0;  // number of the step that the newest row is of
};

}  // namespace palpate::service
