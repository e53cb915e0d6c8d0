// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <palpate/math/errors.hpp>
#include <palpate/plot/layout.hpp>
#include <utility>

namespace palpate::plot {
namespace {

constexpr int kGap_px = 12;
constexpr int kLeastPlotHeight_px = 30;

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  void include(const Range& other) {
    low = std::min(low, other.low);
    high = std::max(high, other.high);
  }
};

/// Values between the outermost hundredths.
Range inner_range(std::vector<double> values) {
  Range range;
  if (values.empty()) return range;
  std::sort(values.begin(), values.end());
  const std::size_t cut = values.size() / 100;
  range.include(values[cut]);
  range.include(values[values.size() - 1 - cut]);
  return range;
}

/// The range with air around it, and never empty.
PixelAxis axis(Range range, bool log, double air, int pixels) {
  if (range.low > range.high) range = log ? Range{1.0, 10.0} : Range{0.0, 1.0};
  if (log) range = {std::log(range.low), std::log(range.high)};
  double margin = air * (range.high - range.low);
  if (range.high - range.low <= 1e-12 * std::abs(range.high)) margin = log ? 1.0 : 0.1 * std::abs(range.high);
  if (range.high - range.low + 2.0 * margin == 0.0) margin = 1.0;
  range = {range.low - margin, range.high + margin};
  if (log) range = {std::exp(range.low), std::exp(range.high)};
  return {range.low, range.high, log, pixels};
}

Range x_range(const Panel& panel) {
  const PixelAxis filter{.log = panel.log_x};
  Range range;
  for (const Series& series : panel.series) {
    for (const double x : series.x) {
      if (filter.shows(x)) range.include(x);
    }
  }
  return range;
}

Range y_range(const Panel& panel) {
  const PixelAxis filter{.log = panel.log_y};
  Range range;
  for (const Series& series : panel.series) {
    for (const double y : series.y) {
      if (filter.shows(y)) range.include(y);
    }
    for (const std::vector<double>* edge : {&series.lower, &series.upper}) {
      std::vector<double> shown;
      std::copy_if(edge->begin(), edge->end(), std::back_inserter(shown), [&](double y) { return filter.shows(y); });
      range.include(inner_range(std::move(shown)));
    }
  }
  return range;
}

bool same_x(const Panel& a, const Panel& b) { return a.x_label == b.x_label && a.log_x == b.log_x; }

bool same_legend(const Panel& a, const Panel& b) {
  return std::equal(a.series.begin(), a.series.end(), b.series.begin(), b.series.end(),
                    [](const Series& s, const Series& t) {
                      return s.label == t.label && s.band_label == t.band_label && s.style == t.style;
                    });
}

/// Lines of text that the legend will need, estimated from the number of letters.
int legend_lines(const Panel& panel, int width_px) {
  double widest_px = 0.0;
  int entries = 0;
  for (const Series& series : panel.series) {
    for (const std::string* label : {&series.label, &series.band_label}) {
      if (label->empty()) continue;
      widest_px = std::max(widest_px, 7.5 * static_cast<double>(label->size()) + 50.0);
      ++entries;
    }
  }
  if (entries == 0) return 0;
  const double free_px = width_px - kLeftMargin_px - kRightMargin_px - 8.0 * static_cast<double>(panel.title.size());
  const int columns = std::max(1, static_cast<int>(free_px / widest_px));
  return (entries + columns - 1) / columns;
}

/// Equal heights for all panels in what titles, legends and axis labels leave.
std::vector<Frame> place_panels(const Figure& figure) {
  const std::vector<Panel>& panels = figure.panels;
  std::vector<Frame> frames(panels.size());
  std::vector<int> above_px, below_px;
  int taken_px = figure.title.empty() ? 0 : kTitle_px;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    frames[i].shows_legend = i == 0 || !same_legend(panels[i - 1], panels[i]);
    frames[i].shows_x_axis = i + 1 == panels.size() || !same_x(panels[i], panels[i + 1]);
    const int lines = std::max(panels[i].title.empty() ? 0 : 1,
                               frames[i].shows_legend ? legend_lines(panels[i], figure.width_px) : 0);
    above_px.push_back(kGap_px + kTextLine_px * lines);
    below_px.push_back(!frames[i].shows_x_axis ? 0 : kTicks_px + (panels[i].x_label.empty() ? 0 : kTextLine_px));
    taken_px += above_px.back() + below_px.back();
  }
  const double height_px = (figure.height_px - taken_px - kGap_px) / static_cast<double>(panels.size());
  if (height_px < kLeastPlotHeight_px || figure.width_px < 3 * kLeftMargin_px) {
    throw InputError(fmt::format("a figure of {} x {} pixels is too small for {} panels", figure.width_px,
                                 figure.height_px, panels.size()));
  }
  double y_px = figure.title.empty() ? 0.0 : kTitle_px;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    frames[i].top_px = y_px + above_px[i];
    frames[i].bottom_px = frames[i].top_px + height_px;
    y_px = frames[i].bottom_px + below_px[i];
  }
  return frames;
}

/// Ranges: y of each panel, x of each group of neighbours that share it.
void set_axes(const Figure& figure, std::vector<Frame>& frames) {
  const int width_px = figure.width_px - kLeftMargin_px - kRightMargin_px;
  for (std::size_t first = 0; first < frames.size();) {
    Range shared;
    std::size_t end = first;
    do {
      shared.include(x_range(figure.panels[end]));
    } while (!frames[end++].shows_x_axis);
    for (std::size_t i = first; i < end; ++i) {
      const Panel& panel = figure.panels[i];
      frames[i].x = axis(shared, panel.log_x, 0.0, width_px);
      frames[i].y = axis(y_range(panel), panel.log_y, 0.05, static_cast<int>(frames[i].bottom_px - frames[i].top_px));
    }
    first = end;
  }
}

}  // namespace

std::vector<Frame> layout(const Figure& figure) {
  std::vector<Frame> frames = place_panels(figure);
  set_axes(figure, frames);
  return frames;
}

}  // namespace palpate::plot
