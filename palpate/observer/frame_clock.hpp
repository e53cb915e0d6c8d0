// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace palpate {

/// What the time of a frame is good for.
enum class FrameTime : std::uint8_t {
  kFirst,
  kAdvanced,
  kResynchronised,  ///< the source's clock was set back and has run on since; accepted as a new start
  kStandsStill,     ///< rejected
  kStepsBack,       ///< rejected
  kNotFinite,       ///< rejected
};

/// The frame counts: time has passed with it.
constexpr bool moves_the_clock(FrameTime verdict) { return verdict <= FrameTime::kResynchronised; }

/// Turns time stamps into time steps. It owns no clock: time is what the frames say.
class FrameClock {
 public:
  static constexpr double kLongestStep_s = 3600.0;  ///< a longer gap counts as this much
  static constexpr int kFramesToResynchronise = 5;

  struct Step {
    FrameTime verdict = FrameTime::kFirst;
    double dt_s = 0.0;
    bool accepted() const { return moves_the_clock(verdict); }
  };

  Step advance(double time_s);

 private:
  bool started_ = false;
  double last_s_ = 0.0;
  double first_rejected_s_ = 0.0, last_rejected_s_ = 0.0;  ///< of the run of frames that lie in the past
  int in_the_past_ = 0;
};

}  // namespace palpate
