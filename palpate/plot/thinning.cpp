// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <palpate/plot/thinning.hpp>
#include <set>
#include <utility>

namespace palpate::plot {
namespace {

/// Consecutive samples [begin, end) that are all shown and lie in one pixel column.
struct Column {
  std::size_t begin, end;
  bool after_gap;
};

template <typename Shown>
std::vector<Column> columns(const std::vector<double>& x, const PixelAxis& axis, const Shown& shown) {
  std::vector<Column> found;
  bool gap = true;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!axis.shows(x[i]) || !shown(i)) {
      gap = true;
    } else if (!gap && axis.pixel(x[i]) == axis.pixel(x[found.back().begin])) {
      found.back().end = i + 1;
    } else {
      found.push_back({i, i + 1, gap});
      gap = false;
    }
  }
  return found;
}

}  // namespace

bool PixelAxis::shows(double value) const { return std::isfinite(value) && (!log || value > 0.0); }

long PixelAxis::pixel(double value) const {
  const double share = log ? std::log(value / from) / std::log(to / from) : (value - from) / (to - from);
  return static_cast<long>(std::floor(share * pixels));
}

std::vector<Run> thin_line(const std::vector<double>& x, const std::vector<double>& y, const PixelAxis& x_axis,
                           const PixelAxis& y_axis) {
  std::vector<Run> runs;
  for (const Column& column : columns(x, x_axis, [&](std::size_t i) { return y_axis.shows(y[i]); })) {
    if (column.after_gap) runs.emplace_back();
    const auto at = [&](std::size_t i) { return y.begin() + static_cast<std::ptrdiff_t>(i); };
    const auto [least, greatest] = std::minmax_element(at(column.begin), at(column.end));
    std::array<std::size_t, 4> kept = {column.begin, static_cast<std::size_t>(least - y.begin()),
                                       static_cast<std::size_t>(greatest - y.begin()), column.end - 1};
    std::sort(kept.begin(), kept.end());
    const auto last = std::unique(kept.begin(), kept.end());
    for (auto i = kept.begin(); i != last; ++i) runs.back().push_back({x[*i], y[*i]});
  }
  return runs;
}

std::vector<BandRun> thin_band(const std::vector<double>& x, const std::vector<double>& lower,
                               const std::vector<double>& upper, const PixelAxis& x_axis, const PixelAxis& y_axis) {
  std::vector<BandRun> runs;
  const auto shown = [&](std::size_t i) { return y_axis.shows(lower[i]) && y_axis.shows(upper[i]); };
  for (const Column& column : columns(x, x_axis, shown)) {
    if (column.after_gap) runs.emplace_back();
    BandPoint envelope{x[column.begin], lower[column.begin], upper[column.begin]};
    for (std::size_t i = column.begin; i < column.end; ++i) {
      envelope.lower = std::min(envelope.lower, lower[i]);
      envelope.upper = std::max(envelope.upper, upper[i]);
    }
    runs.back().push_back(envelope);
    envelope.x = x[column.end - 1];
    if (column.end - column.begin > 1) runs.back().push_back(envelope);
  }
  return runs;
}

Run thin_cloud(const std::vector<double>& x, const std::vector<double>& y, const PixelAxis& x_axis,
               const PixelAxis& y_axis) {
  Run kept;
  std::set<std::pair<long, long>> taken;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!x_axis.shows(x[i]) || !y_axis.shows(y[i])) continue;
    if (taken.emplace(x_axis.pixel(x[i]), y_axis.pixel(y[i])).second) kept.push_back({x[i], y[i]});
  }
  return kept;
}

}  // namespace palpate::plot
