// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <palpate/simulation/scenario.hpp>

namespace palpate {

namespace {

using Points = std::vector<std::pair<double, double>>;

double chord(const Points& points, std::size_t i) {
  return (points[i + 1].second - points[i].second) / (points[i + 1].first - points[i].first);
}

/// Slope of the smooth curve at a point: of the parabola through it and its neighbours, limited after Fritsch and
/// Carlson (1980) to three times the flatter chord, and level at a turning point. At the ends that of the chord.
double slope(const Points& points, std::size_t i) {
  if (i == 0) return chord(points, 0);
  if (i + 1 == points.size()) return chord(points, i - 1);
  const double before = chord(points, i - 1), behind = chord(points, i);
  if (before * behind <= 0.0) return 0.0;
  const double before_s = points[i].first - points[i - 1].first, behind_s = points[i + 1].first - points[i].first;
  const double parabola = (behind_s * before + before_s * behind) / (before_s + behind_s);
  const double most = 3.0 * std::min(std::abs(before), std::abs(behind));
  return std::clamp(parabola, -most, most);
}

/// Between points i and i + 1; `share` of the way.
double smooth(const Points& points, std::size_t i, double share) {
  const double t = share, t2 = t * t, t3 = t2 * t, h = points[i + 1].first - points[i].first;
  return (2.0 * t3 - 3.0 * t2 + 1.0) * points[i].second + (3.0 * t2 - 2.0 * t3) * points[i + 1].second +
         h * ((t3 - 2.0 * t2 + t) * slope(points, i) + (t3 - t2) * slope(points, i + 1));
}

double along_course(const Points& points, Signal::Course course, double time_s) {
  if (!(time_s > points.front().first)) return points.front().second;
  if (time_s >= points.back().first) return points.back().second;
  const auto above = std::upper_bound(points.begin(), points.end(), time_s,
                                      [](double t, const auto& point) { return t < point.first; });
  const auto i = static_cast<std::size_t>(above - points.begin()) - 1;
  const auto& [from_s, from] = points[i];
  const double share = (time_s - from_s) / (points[i + 1].first - from_s);
  switch (course) {
    case Signal::Course::kHold:
      return from;
    case Signal::Course::kSmooth:
      return smooth(points, i, share);
    case Signal::Course::kLinear:
      break;
  }
  return from + share * (points[i + 1].second - from);
}

}  // namespace

double Signal::at(double time_s) const {
  double value = constant;
  for (const Sine& sine : sines)
    value += sine.amplitude * std::sin(2.0 * std::numbers::pi * sine.frequency_hz * time_s + sine.phase_rad);
  if (!points.empty()) value += along_course(points, course, time_s);
  return value;
}

Vector3d at(const Signal3& signals, double time_s) {
  return {signals[0].at(time_s), signals[1].at(time_s), signals[2].at(time_s)};
}

}  // namespace palpate
