// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

/// Pictures of curves over time or against each other. A thin layer over gnuplot.
namespace palpate::plot {

enum class Style { kLines, kPoints };

/// One curve. A NaN (on a logarithmic axis also a value <= 0) leaves a gap; nothing is drawn across it.
struct Series {
  std::string label = {};              ///< empty: not in the legend
  std::vector<double> x = {}, y = {};  ///< of equal size
  std::vector<double> lower = {};      ///< optional band around y: empty, or of the size of x
  std::vector<double> upper = {};
  std::string band_label = {};  ///< empty: the band is not in the legend
  Style style = Style::kLines;
};

/// One pair of axes. Neighbouring panels with the same x label share the x range; only the lowest prints it.
struct Panel {
  std::string title = {};
  std::string x_label = {};  ///< with its unit: "time [s]"
  std::string y_label = {};
  bool log_x = false;
  bool log_y = false;
  std::vector<Series> series = {};
};

/// Panels one above the other.
struct Figure {
  std::string title = {};
  std::vector<Panel> panels = {};
  int width_px = 1000;
  int height_px = 800;
};

/// Writes the figure as SVG or PNG, by the file's extension. Colours tell apart for colour-blind readers too. Long
/// series are thinned to what the picture can show; peaks stay. The y range shows every value of y and all of a band
/// but its outermost hundredth, so that a wide first interval does not flatten the rest.
///
/// Preconditions: at least one panel; sizes as documented at Series.
/// Throws InputError when the extension is neither .svg nor .png, the figure is too small for its panels, the folder
/// cannot be written, or gnuplot is absent or fails; then `file` is as it was before. Not for the real-time thread.
void write_figure(const Figure& figure, const std::filesystem::path& file);

}  // namespace palpate::plot
