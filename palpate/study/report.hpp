// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/plot/plot.hpp>
#include <palpate/study/results.hpp>
#include <string>
#include <vector>

namespace palpate::study {

/// A study told: a table over all runs, then each measure against each parameter, as a table and, where the
/// parameter is a number, a picture. Where the runs
/// say how much an error is (rmse, bias, evaluations) the curve is their median; where they say how often or how many
/// times (coverage, NEES, NIS, updated) it is their mean, for that is what a promise is kept by.
struct Report {
  struct Picture {
    std::string name;  ///< of the file, without folder
    plot::Figure figure;
  };
  std::string markdown;
  std::vector<Picture> pictures;
};

/// `stem`, `extension`: pictures are called STEM-PARAMETER.EXTENSION. Precondition: at least one shard is done.
Report make_report(const store::Database& database, const std::string& stem, const std::string& extension);

}  // namespace palpate::study
