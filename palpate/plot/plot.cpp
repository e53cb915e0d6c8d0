// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <cassert>
#include <cstddef>
#include <iterator>
#include <palpate/math/errors.hpp>
#include <palpate/plot/gnuplot.hpp>
#include <palpate/plot/layout.hpp>
#include <palpate/plot/plot.hpp>
#include <palpate/plot/thinning.hpp>
#include <string_view>

namespace palpate::plot {
namespace {

// Okabe and Ito's colours, without the yellow that is lost on white.
constexpr std::array<const char*, 7> kColours = {"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                                 "#E69F00", "#56B4E9", "#000000"};

/// Single quotes: gnuplot reads neither escapes nor commands inside.
std::string gnuplot_string(std::string_view text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'') result += '\'';
    result += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return result + "'";
}

std::string title_clause(const std::string& label) {
  return label.empty() ? "notitle" : "title " + gnuplot_string(label);
}

struct Pen {
  double width;
  int dash;
};

/// A gnuplot script that grows: data blocks first, then the commands that draw them.
class Script {
 public:
  explicit Script(const Figure& figure) : width_px_(figure.width_px), height_px_(figure.height_px) {}

  void add_panel(const Panel& panel, const Frame& frame) {
    std::string bands, curves;
    for (std::size_t i = 0; i < panel.series.size(); ++i) {
      const Series& series = panel.series[i];
      assert(series.x.size() == series.y.size());
      const char* colour = kColours[i % kColours.size()];
      if (!series.lower.empty()) bands += band(series, frame, colour);
      // The first curve is the widest: one that follows it closely stays visible on top of it.
      curves += curve(series, frame, colour, {.width = i == 0 ? 2.2 : 1.2, .dash = i < kColours.size() ? 1 : 2});
    }
    set_up(panel, frame);
    // Bands lie under all curves. The NaN draws the axes of a panel without any data.
    append("plot {}{}NaN notitle\nunset label 4\n", bands, curves);
  }

  std::string finish(std::string_view terminal, const std::string& title) const {
    std::string head = fmt::format(
        "set terminal {} size {},{} font 'sans-serif,11' background rgb '#FFFFFF' noenhanced\nset encoding utf8\n{}",
        terminal, width_px_, height_px_, data_);
    head += "set multiplot\nset border 3 lc rgb '#606060'\nset tics nomirror out scale 0.5 tc rgb '#202020'\n";
    head += "set grid xtics ytics lt 1 lc rgb '#DDDDDD' lw 1\n";
    if (!title.empty()) {
      head += fmt::format("set label 4 {} at screen {}, screen {} left font ',14'\n", gnuplot_string(title),
                          across(kLeftMargin_px), up(0.6 * kTitle_px));
    }
    return head + commands_ + "unset multiplot\n";
  }

 private:
  template <typename... Arguments>
  void append(fmt::format_string<Arguments...> text, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(commands_), text, std::forward<Arguments>(arguments)...);
  }

  double across(double x_px) const { return x_px / width_px_; }
  double up(double y_px) const { return 1.0 - y_px / height_px_; }

  void set_up(const Panel& panel, const Frame& frame) {
    append("set lmargin at screen {}\nset rmargin at screen {}\n", across(kLeftMargin_px),
           across(width_px_ - kRightMargin_px));
    append("set tmargin at screen {}\nset bmargin at screen {}\n", up(frame.top_px), up(frame.bottom_px));
    append("{} logscale x\n{} logscale y\n", panel.log_x ? "set" : "unset", panel.log_y ? "set" : "unset");
    append("set xrange [{}:{}]\nset yrange [{}:{}]\n", frame.x.from, frame.x.to, frame.y.from, frame.y.to);
    append("set format x {}\nset format y '%g'\n", frame.shows_x_axis ? "'%g'" : "''");
    // Labels at fixed places: gnuplot's own depend on the width of the tick labels and may leave the picture.
    append("set label 1 {} at graph 0, screen {} left\n", gnuplot_string(panel.title), up(frame.top_px - 11));
    append("set label 2 {} at screen {}, graph 0.5 center rotate\n", gnuplot_string(panel.y_label), across(16));
    append("set label 3 {} at graph 0.5, screen {} center\n", gnuplot_string(frame.shows_x_axis ? panel.x_label : ""),
           up(frame.bottom_px + kTicks_px + 0.6 * kTextLine_px));
    if (frame.shows_legend) {
      append("set key at graph 1, screen {} right bottom horizontal Left reverse samplen 2\n", up(frame.top_px - 4));
    } else {
      append("unset key\n");
    }
  }

  template <typename Runs, typename Write>
  std::string data_block(const Runs& runs, const Write& write) {
    std::string name = fmt::format("$d{}", blocks_++);
    data_ += name + " << EOD\n";
    for (const auto& run : runs) {
      for (const auto& point : run) write(point);
      // A lone sample between two gaps: doubled, so that the line has a dot to draw.
      if (run.size() == 1) write(run.front());
      data_ += '\n';
    }
    data_ += "EOD\n";
    return name;
  }

  std::string points(const std::vector<Run>& runs) {
    return data_block(runs, [this](const Point& p) { fmt::format_to(std::back_inserter(data_), "{} {}\n", p.x, p.y); });
  }

  std::string band(const Series& series, const Frame& frame, const char* colour) {
    assert(series.lower.size() == series.x.size() && series.upper.size() == series.x.size());
    const auto runs = thin_band(series.x, series.lower, series.upper, frame.x, frame.y);
    if (runs.empty()) return {};
    const std::string name = data_block(runs, [this](const BandPoint& p) {
      fmt::format_to(std::back_inserter(data_), "{} {} {}\n", p.x, p.lower, p.upper);
    });
    return fmt::format("{} using 1:2:3 with filledcurves fc rgb '{}' fs transparent solid 0.25 noborder {}, ", name,
                       colour, title_clause(series.band_label));
  }

  std::string curve(const Series& series, const Frame& frame, const char* colour, Pen pen) {
    const bool line = series.style == Style::kLines;
    const auto runs = line ? thin_line(series.x, series.y, frame.x, frame.y)
                           : std::vector<Run>{thin_cloud(series.x, series.y, frame.x, frame.y)};
    if (runs.empty() || runs.front().empty()) return {};
    const double dot = !line && runs.front().size() < 200 ? 0.8 : 0.4;  // few points are easily overlooked
    const std::string look =
        line ? fmt::format("lines lw {} dt {}", pen.width, pen.dash) : fmt::format("points pt 7 ps {}", dot);
    return fmt::format("{} using 1:2 with {} lc rgb '{}' {}, ", points(runs), look, colour, title_clause(series.label));
  }

  int width_px_, height_px_;
  int blocks_ = 0;
  std::string data_, commands_;
};

}  // namespace

void write_figure(const Figure& figure, const std::filesystem::path& file) {
  assert(!figure.panels.empty());
  const std::string extension = file.extension().string();
  if (extension != ".svg" && extension != ".png") {
    throw InputError(fmt::format("{}: pictures end in .svg or .png, not in '{}'", file.string(), extension));
  }
  const std::vector<Frame> frames = layout(figure);
  Script script(figure);
  for (std::size_t i = 0; i < frames.size(); ++i) script.add_panel(figure.panels[i], frames[i]);
  run_gnuplot(script.finish(extension == ".svg" ? "svg rounded" : "pngcairo rounded", figure.title), file);
}

}  // namespace palpate::plot
