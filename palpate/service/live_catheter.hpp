// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <palpate/observer/force_observer.hpp>
#include <palpate/service/consistency_alarm.hpp>
#include <palpate/service/counters.hpp>
#include <palpate/service/lateness.hpp>
#include <palpate/service/output_clock.hpp>
#include <palpate/service/staleness.hpp>
#include <palpate/session/live_record.hpp>
#include <span>

namespace palpate::service {

/// One catheter on the observer's thread: its observer, and what is said besides of frames that come or do not come.
/// take() and look() allocate nothing once `out` has held a frame.
class LiveCatheter {
 public:
  struct Watch {
    std::int64_t stale_ns = 100'000'000;  ///< least silence that counts as one
    bool tracker = false;  ///< frames come from a device with a clock of its own, not from a file at any speed
  };
  /// `index`: of LiveRecord::catheter.
  LiveCatheter(int index, const Catheter& catheter, const ObserverOptions& options, const Watch& watch);

  /// A frame that came: its record.
  void take(const TrackerFrame& frame, std::int64_t received_ns, session::LiveRecord& out);
  /// Is it silent for too long? True once a silence: `out` is then the forecast, marked as stale.
  bool look(std::int64_t now_ns, session::LiveRecord& out);
  /// When look() has something to say at the earliest, should nothing come.
  std::int64_t next_look_ns() const;
  /// An estimate that is older is none of what is now.
  std::int64_t stale_after_ns() const { return staleness_.limit_ns(); }

  /// "live", "inconsistent", "consistent": what changed with the latest frame.
  std::span<const char* const> changes() const { return {changes_.data(), changed_}; }

  /// A catheter that was tared or registered anew; gives back the observer before it.
  std::unique_ptr<ForceObserver> exchange(std::unique_ptr<ForceObserver> observer);
  /// What the tendon pulls from now on, in every frame that does not say so itself.
  void set_tendon(const TendonReading& tendon) { tendon_ = tendon; }

  CatheterCounters& counters() { return counters_; }
  const CatheterCounters& counters() const { return counters_; }

 private:
  void judge_age(session::LiveRecord& out);
  void count(const TrackerFrame& frame, const Estimate& estimate);
  void note(const char* change) { changes_[changed_++] = change; }

  int index_;
  std::unique_ptr<ForceObserver> observer_;
  Staleness staleness_;
  OutputClock clock_;
  std::optional<Lateness> lateness_;
  ConsistencyAlarm alarm_;
  TendonReading tendon_;
  Estimate last_;
  std::array<const char*, 2> changes_{};
  std::size_t changed_ = 0;
  CatheterCounters counters_;
};

}  // namespace palpate::service
