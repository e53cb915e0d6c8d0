// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <palpate/reproduction/markdown.hpp>
#include <palpate/reproduction/methods.hpp>
#include <palpate/reproduction/paper_figures.hpp>
#include <palpate/reproduction/parts.hpp>

/// Section 4.3: a sine along d1 under other R and other starts. Tables 4 and 5.
namespace palpate::reproduction {

namespace {

using Row = std::vector<std::string>;
constexpr std::size_t kFactors = paper::kTable4Factors.size();

/// One column of Table 4, RMSE of Fx [N].
struct Factor {
  std::array<double, 4> ours{};  ///< EKF, IEKF, IAEKF, IAEKF tuned
  double map = 0.0, lag = 0.0, lag_metres = 0.0;
  double distance = 0.0;  ///< of IEKF from the independent maximum, any axis
  int unconverged = 0;
};

Factor run_factor(const Catheter& catheter, const Course& course, double factor) {
  const PaperOptions options{.R = factor * paper_noise()};
  const Vector3d start_N = course.force_tip_N.front();
  const std::vector<MethodRun> runs = run_methods(catheter, options, course, start_N);
  const IekfExplained explained = explain_iekf(catheter, options, course, start_N);
  Factor result;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    result.ours[i] = statistics(runs[i].run.error_N).rmse.x();
    if (i > 0) result.unconverged += runs[i].run.unconverged;
  }
  result.map = statistics(explained.map_N).rmse.x();
  result.lag = statistics(explained.lag_N).rmse.x();
  result.lag_metres = statistics(explained.lag_metres_N).rmse.x();
  result.distance = rmse_distance(runs[1].run.error_N, explained.map_N);
  return result;
}

template <class Value>
Row factor_row(const std::string& name, const std::array<Factor, kFactors>& factors, Value value) {
  Row row{name};
  for (std::size_t i = 0; i < kFactors; ++i) row.push_back(value(factors[i], i));
  return row;
}

MarkdownTable table4(const std::array<Factor, kFactors>& factors) {
  MarkdownTable table{{"RMSE of Fx [N]"}};
  for (const double factor : paper::kTable4Factors) table.header.push_back(fmt::format("{:g} R", factor));
  const std::array<const char*, 4> names{"EKF, ours", "IEKF, ours", "IAEKF, ours, cold start", "IAEKF, ours, tuned"};
  for (std::size_t m = 0; m < names.size(); ++m) {
    const std::size_t paper_row = std::min<std::size_t>(m, 2);
    const auto theirs = [&](std::size_t i) { return paper::kTable4[paper_row][i]; };
    if (m < 3)
      table.rows.push_back(factor_row(std::string(paper::kMethods[m]) + ", paper", factors,
                                      [&](const Factor&, std::size_t i) { return short_number(theirs(i)); }));
    table.rows.push_back(factor_row(names[m], factors, [&](const Factor& f, std::size_t i) {
      return fmt::format("{} ({})", short_number(f.ours[m]), against(f.ours[m], theirs(i)));
    }));
    if (m != 1) continue;
    const auto add = [&](const char* name, double Factor::*member) {
      table.rows.push_back(
          factor_row(name, factors, [&](const Factor& f, std::size_t) { return short_number(f.*member); }));
    };
    add("- independent maximum of the posterior", &Factor::map);
    add("- lag forced by Q and R, curvature 1e6 m^-2", &Factor::lag);
    add("- the same, curvature 1 m^-2", &Factor::lag_metres);
  }
  return table;
}

std::string table4_note(const std::array<Factor, kFactors>& factors) {
  double distance = 0.0;
  int unconverged = 0;
  std::string above;
  for (std::size_t i = 0; i < kFactors; ++i) {
    const Factor& f = factors[i];
    distance = std::max(distance, f.distance);
    unconverged += f.unconverged;
    const double theirs = paper::kTable4[1][i];
    if (f.ours[1] > theirs)
      above += fmt::format(
          " At {:g} R the forced lag is {}, {:.2g} times theirs ({:.2g} times with 1 m^-2): theirs would "
          "take {:.2g} of that R.",
          paper::kTable4Factors[i], short_number(f.lag), f.lag / theirs, f.lag_metres / theirs, theirs / f.lag);
  }
  return fmt::format(
      "IEKF's RMSE equals that of the independent maximum within {:.1e} on every axis; updates that did not converge "
      "in 10 "
      "undamped iterations: {}. With exact data IEKF's error is the lag alone, and the lag grows in proportion to R: "
      "the "
      "paper's row, which falls from 0.02 R to 0.1 R and then grows by 30 while R grows by 500, is not that of Eqs. "
      "(17)-(19) run to convergence.{} Neither reading of the curvature's variance gives theirs.\n",
      distance, unconverged, above);
}

/// Table 5, one method from one start.
void add_table5_rows(MarkdownTable& table, const std::array<std::vector<MethodRun>, 2>& runs, std::size_t method) {
  const auto paper_row = static_cast<std::size_t>(runs[0][method].paper_row);
  for (const bool mean : {true, false}) {
    Row row{mean ? std::string(runs[0][method].name) : "", mean ? "MEAN" : "STD"};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::array<std::string, 2> ours, theirs;
      for (std::size_t s = 0; s < 2; ++s) {
        const Statistics found = statistics(runs[s][method].run.error_N);
        const paper::Errors& printed = paper::kTable5[paper_row][s];
        ours[s] = short_number((mean ? found.mean : found.std)(static_cast<int>(axis)));
        theirs[s] = short_number((mean ? printed.mean : printed.std)[axis]);
      }
      row.push_back(theirs[0] + " / " + theirs[1]);
      row.push_back(ours[0] + " / " + ours[1]);
    }
    table.rows.push_back(row);
  }
}

/// Cells of a method in Table 5 at or below the paper's, "12 of 12".
std::string cells_below(const std::array<std::vector<MethodRun>, 2>& runs, std::size_t method) {
  int below = 0, all = 0;
  for (std::size_t s = 0; s < 2; ++s) {
    const Statistics found = statistics(runs[s][method].run.error_N);
    const paper::Errors& printed = paper::kTable5[static_cast<std::size_t>(runs[s][method].paper_row)][s];
    for (std::size_t axis = 0; axis < 3; ++axis, all += 2) {
      const auto i = static_cast<int>(axis);
      below += std::abs(found.mean(i)) <= std::abs(printed.mean[axis]) ? 1 : 0;
      below += found.std(i) <= printed.std[axis] ? 1 : 0;
    }
  }
  return fmt::format("{} of {}", below, all);
}

}  // namespace

Part make_table4(const Settings& settings) {
  const Catheter catheter = paper_catheter();
  const Course course = sine_course(catheter);
  std::array<Factor, kFactors> factors;
  for (std::size_t i = 0; i < kFactors; ++i) {
    factors[i] = run_factor(catheter, course, paper::kTable4Factors[i]);
    if (settings.progress) settings.progress(static_cast<double>(i + 1) / kFactors);
  }
  Part part{.title = "Table 4: other measurement noise covariances"};
  part.markdown =
      table4(factors).text() +
      "\nFx = 0.1 sin(2 pi t) N, 15 samples a second, 150 steps (our choice), k1,0 = 24.57 1/m (ours), started at "
      "the true force. \"below\": at or below the paper's.\n\n" +
      table4_note(factors) + "\n" + tuning_note();
  return part;
}

Part make_table5(const Settings&) {
  const Catheter catheter = paper_catheter();
  const Course course = sine_course(catheter);
  std::array<std::vector<MethodRun>, 2> runs;
  double distance = 0.0;
  for (std::size_t s = 0; s < 2; ++s) {
    const Vector3d start_N = Vector3d::Constant(0.1 * paper::kTable5Shares[s]);
    runs[s] = run_methods(catheter, {}, course, start_N);
    const IekfExplained explained = explain_iekf(catheter, {}, course, start_N);
    distance = std::max(distance, rmse_distance(runs[s][1].run.error_N, explained.map_N));
  }
  MarkdownTable table{{"0.2 / 0.5 Fmax", "[N]", "e(Fx) paper", "ours", "e(Fy) paper", "ours", "e(Fz) paper", "ours"}};
  for (std::size_t method = 0; method < runs[0].size(); ++method) add_table5_rows(table, runs, method);
  Part part{.title = "Table 5: other initial forces"};
  part.markdown =
      table.text() +
      fmt::format(
          "\nFx = 0.1 sin(2 pi t) N as in Table 4. The paper does not say how it starts axes whose true force is "
          "zero; we start all three at 0.02 N and at 0.05 N, P0 = Q, and count every step, the first included. "
          "IEKF's RMSE equals that of the independent maximum within {:.1e}: its error is the forced lag of Table "
          "4, and the start is forgotten in the first update. The paper's own IEKF has a spread of 2e-6 N along x "
          "here and an RMSE of 6.8e-6 N for the same force in Table 4.\n\n",
          distance) +
      fmt::format("Cells at or below the paper's: IEKF {}, IAEKF from a cold start {}, tuned {}.\n\n",
                  cells_below(runs, 1), cells_below(runs, 2), cells_below(runs, 3)) +
      tuning_note();
  return part;
}

}  // namespace palpate::reproduction
