// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <palpate/plot/plot.hpp>
#include <string>
#include <string_view>
#include <vector>

/// The paper's tables and figures, each made again: a part is a piece of Markdown with its pictures, theirs beside
/// ours.
namespace palpate::reproduction {

struct NamedFigure {
  std::string name;  ///< "figure4": the picture becomes figure4.svg, and the Markdown refers to it so
  plot::Figure figure;
};

struct Part {
  std::string title = {};     ///< "Table 3: ..."
  std::string markdown = {};  ///< without the title
  std::vector<NamedFigure> figures = {};
};

struct Settings {
  int workers = 2;                                  ///< threads a part may use
  std::function<void(double share)> progress = {};  ///< called now and then, 0 to 1; may be empty
};

/// One entry of `palpate reproduce NAME`.
struct PartMaker {
  std::string_view name;   ///< "table3"
  std::string_view about;  ///< one line for --help
  Part (*make)(const Settings& settings);
};

/// All of them, in the paper's order; what the paper does not have (iterations, window, corrections) comes last.
const std::vector<PartMaker>& all_parts();

}  // namespace palpate::reproduction
