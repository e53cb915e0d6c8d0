// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/plot/plot.hpp>
#include <palpate/plot/thinning.hpp>
#include <vector>

namespace palpate::plot {

inline constexpr int kLeftMargin_px = 96;
inline constexpr int kRightMargin_px = 22;
inline constexpr int kTitle_px = 34;
inline constexpr int kTextLine_px = 22;
inline constexpr int kTicks_px = 26;  ///< tick labels under an axis

/// Where one panel stands: heights from the top of the figure.
struct Frame {
  double top_px = 0.0;
  double bottom_px = 0.0;
  bool shows_x_axis = true;  ///< tick labels and x label: not where the panel below has the same
  bool shows_legend = true;  ///< not where the panel above has the same
  PixelAxis x, y;
};

/// One frame a panel. Throws InputError when they do not fit.
std::vector<Frame> layout(const Figure& figure);

}  // namespace palpate::plot
