// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <palpate/observer/frame_clock.hpp>

namespace palpate {

FrameClock::Step FrameClock::advance(double time_s) {
  if (!std::isfinite(time_s)) return {FrameTime::kNotFinite, 0.0};
  if (!started_) {
    started_ = true;
    last_s_ = time_s;
    return {FrameTime::kFirst, 0.0};
  }
  if (time_s > last_s_) {
    const double dt = std::min(time_s - last_s_, kLongestStep_s);
    last_s_ = time_s;
    in_the_past_ = 0;
    return {FrameTime::kAdvanced, dt};
  }
  if (time_s == last_s_) return {FrameTime::kStandsStill, 0.0};

  const bool runs_on = in_the_past_ > 0 && time_s > last_rejected_s_;
  in_the_past_ = runs_on ? in_the_past_ + 1 : 1;
  if (!runs_on) first_rejected_s_ = time_s;
  const double dt = std::min(time_s - first_rejected_s_, kLongestStep_s);  // at least this long
  last_rejected_s_ = time_s;
  if (in_the_past_ <= kFramesToResynchronise) return {FrameTime::kStepsBack, 0.0};
  last_s_ = time_s;
  in_the_past_ = 0;
  return {FrameTime::kResynchronised, dt};
}

}  // namespace palpate
