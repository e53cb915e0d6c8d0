// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/link/message.hpp>
#include <palpate/observer/force_observer.hpp>
#include <palpate/recording/catheter_file.hpp>
#include <palpate/simulation/virtual_tracker.hpp>
#include <string>
#include <utility>
#include <vector>

/// What a tracker sends, as the wire rounds it, and what an observer offline makes of the same.
namespace palpate::serve_test {

inline constexpr const char* kTip = "TipToTracker";
inline constexpr const char* kShaft = "ShaftToTracker";

/// A 70 mm shaft, bent, with the sensors Tip and Shaft; `straight`: without its bend.
std::string catheter_text(bool straight = false);
CatheterFile catheter_file(bool straight = false);

/// The poses of one instant; a sensor that is not there is not sent.
struct WireFrame {
  double time_s = 0.0;  ///< as the wire has it: a multiple of 2^-32 s
  std::vector<std::pair<std::string, link::Matrix>> poses;

  link::Matrix& of(const std::string& device);
};
using WireFrames = std::vector<WireFrame>;

/// A virtual run against a beating wall, and its truth.
struct VirtualWire {
  WireFrames frames;
  std::vector<Vector3d> force_tip_N;
};
VirtualWire virtual_wire(const Catheter& catheter, double rate_hz, double duration_s,
                         const ForceSchedule& force = beating_wall_force);

/// Seconds since 1970, UTC; wire_time: as the wire has them.
double utc_s();
double wire_time(double time_s);
/// The same frames, the first at that time.
WireFrames moved_to(WireFrames frames, double start_s);

/// What the observer's frames are once they have come over the wire.
std::vector<TrackerFrame> tracker_frames(const WireFrames& frames);
std::vector<Estimate> offline(const CatheterFile& file, const WireFrames& frames);

/// Root mean square of |estimate - truth| over the frames that both have; [from, ...).
double rmse_N(const std::vector<Vector3d>& forces, const std::vector<Vector3d>& truth, std::size_t from = 0);

}  // namespace palpate::serve_test
