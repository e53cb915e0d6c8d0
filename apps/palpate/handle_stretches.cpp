// SPDX-License-Identifier: Apache-2.0
#include "handle_stretches.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <palpate/math/errors.hpp>

namespace palpate::app {

namespace {

constexpr double kRestShare = 0.01;  // of the handle's range

/// Samples [first, last] of the trace.
struct Rest {
  std::size_t first = 0, last = 0;
};

std::vector<Rest> rests_of(const HandleTrace& handle, double tolerance, double rest_s) {
  std::vector<Rest> rests;
  const std::size_t n = handle.position.size();
  for (std::size_t first = 0; first < n;) {
    double low = handle.position[first], high = low;
    std::size_t last = first;
    while (last + 1 < n) {
      low = std::min(low, handle.position[last + 1]);
      high = std::max(high, handle.position[last + 1]);
      if (high - low > tolerance) break;
      ++last;
    }
    const bool rests_here = handle.times_s[last] - handle.times_s[first] >= rest_s;
    if (rests_here) rests.push_back({first, last});
    first = rests_here ? last + 1 : first + 1;
  }
  return rests;
}

double mean_position(const HandleTrace& handle, const Rest& rest) {
  double sum = 0.0;
  for (std::size_t i = rest.first; i <= rest.last; ++i) sum += handle.position[i];
  return sum / static_cast<double>(rest.last - rest.first + 1);
}

/// Did the handle come from above? Empty where it had not moved before.
std::optional<bool> came_from_above(const HandleTrace& handle, const Rest& rest, double position, double tolerance) {
  for (std::size_t i = rest.first; i-- > 0;)
    if (std::abs(handle.position[i] - position) > 2.0 * tolerance) return handle.position[i] > position;
  return std::nullopt;
}

}  // namespace

std::vector<HandleStretch> find_stretches(const Catheter& catheter, const TrackerRecording& recording,
                                          const HandleTrace& handle, double rest_s, ClampKnowledge clamp) {
  const auto [least, most] = std::minmax_element(handle.position.begin(), handle.position.end());
  const double tolerance = kRestShare * (*most - *least);
  std::vector<HandleStretch> stretches;
  std::vector<std::optional<bool>> releases;
  for (const Rest& rest : rests_of(handle, tolerance, rest_s)) {
    HandleStretch stretch;
    const double begin_s = handle.times_s[rest.first];
    stretch.to_s = handle.times_s[rest.last];
    stretch.from_s = begin_s + std::min(0.2 * (stretch.to_s - begin_s), 0.3);
    stretch.position = mean_position(handle, rest);
    ArcData data{.points = {}, .poses = mean_poses(catheter, recording.frames, stretch.from_s, stretch.to_s)};
    for (const MeanPose& pose : data.poses) stretch.frames = std::max(stretch.frames, pose.count);
    if (stretch.frames < 3) continue;
    stretch.arc = fit_arc(catheter, data, clamp);
    releases.push_back(came_from_above(handle, rest, stretch.position, tolerance));
    stretches.push_back(std::move(stretch));
  }
  if (stretches.empty())
    throw InputError(
        fmt::format("{}: no stretch of {} s or more with the handle at rest and frames of {} in it: expected several, "
                    "over the whole range, up and down",
                    handle.source, rest_s, recording.source));
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    const bool second = releases.size() > 1 && releases[1].value_or(false);
    stretches[i].release = releases[i].value_or(i == 0 ? second : stretches[i - 1].release);
  }
  return stretches;
}

std::vector<HandleSample> samples_of(const std::vector<HandleStretch>& stretches) {
  std::vector<HandleSample> samples;
  samples.reserve(stretches.size());
  for (const HandleStretch& stretch : stretches)
    samples.push_back({stretch.position, stretch.release, stretch.arc.precurvature_per_m.head<2>(),
                       stretch.arc.covariance.diagonal().head<2>().cwiseSqrt()});
  return samples;
}

}  // namespace palpate::app
