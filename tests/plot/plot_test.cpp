// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <limits>
#include <palpate/math/errors.hpp>
#include <palpate/plot/plot.hpp>
#include <string>

namespace palpate::plot {
namespace {

using std::filesystem::path;
using testing::HasSubstr;
using testing::StartsWith;

/// Empty folder of its own for every test; PATH is put back.
class WriteFigure : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (std::filesystem::temp_directory_path() / "palpate_plot_XXXXXX").string();
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override {
    ::setenv("PATH", path_variable_.c_str(), 1);
    std::filesystem::remove_all(folder_);
  }

  /// Stands in for gnuplot; an empty script makes it absent.
  void replace_gnuplot(const std::string& script) {
    const path bin = folder_ / "bin";
    std::filesystem::create_directory(bin);
    if (!script.empty()) {
      std::ofstream(bin / "gnuplot") << "#!/bin/sh\n" << script;
      std::filesystem::permissions(bin / "gnuplot", std::filesystem::perms::owner_all);
    }
    ::setenv("PATH", bin.c_str(), 1);
  }

  std::string failure(const Figure& figure, const path& file) {
    try {
      write_figure(figure, file);
    } catch (const InputError& error) {
      return error.what();
    }
    return "did not fail";
  }

  std::ptrdiff_t files_in(const path& folder) {
    return std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator());
  }

  path folder_;

 private:
  std::string path_variable_ = std::getenv("PATH");
};

std::string contents(const path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t found = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++found;
  return found;
}

Figure force_over_a_minute(std::size_t samples) {
  Figure figure{.title = "Tip force"};
  for (const char* axis : {"Fx", "Fy", "Fz"}) {
    Series estimate{.label = "estimate", .band_label = "95 % interval"};
    Series truth{.label = "truth"};
    for (std::size_t i = 0; i < samples; ++i) {
      const double t = 60.0 * static_cast<double>(i) / static_cast<double>(samples);
      const double f = 0.05 * std::sin(0.6 * t);
      estimate.x.push_back(t);
      estimate.y.push_back(f + 0.002 * std::sin(1000.0 * t));
      estimate.lower.push_back(f - 0.01);
      estimate.upper.push_back(f + 0.01);
      truth.x.push_back(t);
      truth.y.push_back(f);
    }
    figure.panels.push_back({.title = axis,
                             .x_label = "time [s]",
                             .y_label = std::string(axis) + " [N]",
                             .series = {std::move(estimate), std::move(truth)}});
  }
  return figure;
}

Figure one_curve(std::vector<double> x, std::vector<double> y) {
  return {.panels = {{.series = {{.label = "curve", .x = std::move(x), .y = std::move(y)}}}}};
}

TEST_F(WriteFigure, DrawsSvgWithItsWordsOnceWherePanelsShareThem) {
  write_figure(force_over_a_minute(600), folder_ / "force.svg");
  const std::string svg = contents(folder_ / "force.svg");
  EXPECT_THAT(svg, StartsWith("<?xml"));
  EXPECT_THAT(svg, HasSubstr("</svg>"));
  for (const char* word :
       {">Tip force<", ">Fx<", ">Fy<", ">Fz<", ">Fz [N]<", ">time [s]<", ">95 % interval<", ">truth<"}) {
    EXPECT_EQ(count(svg, word), 1U) << word;
  }
  EXPECT_EQ(files_in(folder_), 1);
}

TEST_F(WriteFigure, DrawsPng) {
  write_figure(force_over_a_minute(600), folder_ / "force.png");
  EXPECT_THAT(contents(folder_ / "force.png"), StartsWith("\x89PNG"));
  EXPECT_EQ(files_in(folder_), 1);
}

TEST_F(WriteFigure, StaysSmallWith24000Samples) {
  write_figure(force_over_a_minute(24000), folder_ / "force.svg");
  EXPECT_LT(std::filesystem::file_size(folder_ / "force.svg"), 600'000U);
}

TEST_F(WriteFigure, DrawsNoLineAcrossAGap) {
  const double gap = std::numeric_limits<double>::quiet_NaN();
  write_figure(one_curve({0, 1, 2, 3, 4}, {0, 1, 0, 1, 0}), folder_ / "whole.svg");
  write_figure(one_curve({0, 1, 2, 3, 4}, {0, 1, gap, 1, 0}), folder_ / "gap.svg");
  const auto moves = [&](const char* name) { return count(contents(folder_ / name), "M"); };
  EXPECT_EQ(moves("gap.svg"), moves("whole.svg") + 1);
}

TEST_F(WriteFigure, DrawsAxesWithoutDataAndConstants) {
  Figure figure = one_curve({}, {});
  figure.panels.push_back(one_curve({1.0, 2.0}, {0.0, 0.0}).panels[0]);
  figure.panels.push_back(one_curve({-1.0, 1.0}, {-1.0, 0.0}).panels[0]);
  figure.panels.back().log_x = figure.panels.back().log_y = true;
  write_figure(figure, folder_ / "empty.svg");
  EXPECT_THAT(contents(folder_ / "empty.svg"), HasSubstr("</svg>"));
}

TEST_F(WriteFigure, KeepsWordsAndNamesFromBeingCommands) {
  const path witness = folder_ / "witness";
  const std::string hostile =
      "it's'\n!touch " + witness.string() + "\n`touch " + witness.string() + "`\"$(touch " + witness.string() + ")";
  Figure figure = one_curve({0.0, 1.0}, {0.0, 1.0});
  figure.title = figure.panels[0].title = figure.panels[0].y_label = figure.panels[0].series[0].label = hostile;
  const path file = folder_ / "it's a `name` \"with\" $(traps); #.svg";
  write_figure(figure, file);
  EXPECT_FALSE(std::filesystem::exists(witness));
  EXPECT_THAT(contents(file), HasSubstr("it's'"));
}

TEST_F(WriteFigure, RefusesOtherExtensions) {
  EXPECT_THAT(failure(one_curve({0.0}, {0.0}), folder_ / "force.pdf"), HasSubstr(".svg or .png"));
  EXPECT_EQ(files_in(folder_), 0);
}

TEST_F(WriteFigure, RefusesAFigureTooSmallForItsPanels) {
  Figure figure = force_over_a_minute(10);
  figure.height_px = 150;
  EXPECT_THAT(failure(figure, folder_ / "force.svg"), HasSubstr("150"));
  EXPECT_EQ(files_in(folder_), 0);
}

TEST_F(WriteFigure, NamesAFolderThatIsNotThere) {
  EXPECT_THAT(failure(one_curve({0.0}, {0.0}), folder_ / "nowhere" / "force.svg"), HasSubstr("nowhere/force.svg"));
}

TEST_F(WriteFigure, SaysThatGnuplotIsAbsent) {
  replace_gnuplot("");
  EXPECT_THAT(failure(one_curve({0.0}, {0.0}), folder_ / "force.svg"), HasSubstr("gnuplot-nox"));
  EXPECT_EQ(files_in(folder_), 1) << "only bin/";
}

TEST_F(WriteFigure, PassesOnWhatGnuplotSaysAndKeepsTheOldPicture) {
  std::ofstream(folder_ / "force.svg") << "old";
  replace_gnuplot("echo half a picture; echo no such terminal >&2; exit 3\n");
  EXPECT_THAT(failure(one_curve({0.0}, {0.0}), folder_ / "force.svg"), HasSubstr("no such terminal"));
  EXPECT_EQ(contents(folder_ / "force.svg"), "old");
  EXPECT_EQ(files_in(folder_), 2) << "force.svg and bin/";
}

TEST_F(WriteFigure, FailsWhenGnuplotIsKilled) {
  replace_gnuplot("kill -9 $$\n");
  EXPECT_THAT(failure(one_curve({0.0}, {0.0}), folder_ / "force.svg"), HasSubstr("gnuplot failed"));
}

}  // namespace
}  // namespace palpate::plot
