// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

/// Fewer points, same picture: what falls into one pixel column is replaced by what shows of it.
namespace palpate::plot {

/// Maps an axis range to pixels.
struct PixelAxis {
  double from = 0.0;
  double to = 1.0;
  bool log = false;
  int pixels = 1;

  /// A finite value that this axis can show: positive where it is logarithmic.
  bool shows(double value) const;
  /// Whole pixels from the left or lower end. Precondition: shows(value).
  long pixel(double value) const;
};

/// Points of a curve or, with two ordinates, of a band. Runs are drawn unconnected.
struct Point {
  double x, y;
};
struct BandPoint {
  double x, lower, upper;
};
using Run = std::vector<Point>;
using BandRun = std::vector<BandPoint>;

/// First, least, greatest and last point of every pixel column, in their order; a new run after every gap.
std::vector<Run> thin_line(const std::vector<double>& x, const std::vector<double>& y, const PixelAxis& x_axis,
                           const PixelAxis& y_axis);

/// Outer envelope of every pixel column; a new run after every gap.
std::vector<BandRun> thin_band(const std::vector<double>& x, const std::vector<double>& lower,
                               const std::vector<double>& upper, const PixelAxis& x_axis, const PixelAxis& y_axis);

/// One point a pixel, as one run.
Run thin_cloud(const std::vector<double>& x, const std::vector<double>& y, const PixelAxis& x_axis,
               const PixelAxis& y_axis);

}  // namespace palpate::plot
