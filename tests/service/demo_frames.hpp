// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/service/settings.hpp>
#include <palpate/simulation/virtual_tracker.hpp>

namespace palpate::test {

/// The catheter of `palpate serve --demo`.
inline const service::CatheterSettings& demo_catheter() {
  static const service::Settings settings = service::demo_settings();
  return settings.catheters.front();
}

/// What a tracker sees of it before a beating wall.
inline std::vector<TrackerFrame> demo_frames(double duration_s = 2.0, double rate_hz = 40.0) {
  VirtualTrackerOptions options;
  options.duration_s = duration_s;
  options.rate_hz = rate_hz;
  return simulate_tracker(demo_catheter().settings.catheter, beating_wall_force, options).frames;
}

inline constexpr std::int64_t kMillisecond_ns = 1'000'000;

}  // namespace palpate::test
