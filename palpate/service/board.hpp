// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <nlohmann/json_fwd.hpp>
#include <palpate/service/live_catheter.hpp>
#include <palpate/service/settings.hpp>
#include <palpate/session/live_record.hpp>
#include <string>
#include <vector>

namespace palpate::service {

/// What may be said of a live force, best first.
enum class LiveState : std::uint8_t {
  kWaiting,   ///< no frame has come yet
  kLive,      ///< what is shown is now
  kDegraded,  ///< it is now, but doubtful: frames contradict the model, or estimates come late
  kStale,     ///< nothing comes: no force is shown
};
std::string_view describe(LiveState state);

/// One catheter as those see it who look at it: the network's thread keeps it up to date.
struct CatheterView {
  const CatheterSettings* settings = nullptr;
  Catheter catheter;  ///< as it is now: tared, registered anew
  const LiveCatheter* live = nullptr;
  bool any = false;
  session::LiveRecord latest;       ///< frame or silence
  std::deque<TrackerFrame> recent;  ///< the latest kRecent_s, for a tare
  double first_time_s = 0.0;        ///< of the first frame
  bool reference_done = false;      ///< the [reference] of its file has been used, or there is none

  static constexpr double kRecent_s = 10.0;
  static constexpr std::size_t kMostRecent = 20000;
  /// False: it says nothing that is to be shown.
  bool take(const session::LiveRecord& record);
};

LiveState state_of(const CatheterView& view, std::int64_t now_ns);

/// State now, and why, in words that a person at the table understands.
struct Health {
  LiveState state = LiveState::kWaiting;
  std::vector<std::string> words;
};
Health health_of(const CatheterView& view, std::int64_t now_ns);

/// True where the latest record's force may be shown as what it is now.
bool shows_force(const CatheterView& view, std::int64_t now_ns);

/// One catheter, for the STRING message and the control interface (docs/reference/serve.md).
nlohmann::json catheter_json(const CatheterView& view, std::int64_t now_ns);

/// As it goes out: a name from the network that is no UTF-8 is made so.
std::string text_of(const nlohmann::json& data);

}  // namespace palpate::service
