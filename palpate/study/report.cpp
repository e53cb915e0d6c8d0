// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <palpate/study/report.hpp>
#include <palpate/study/statistics.hpp>
#include <span>

namespace palpate::study {

namespace {

/// Columns that belong together: the three axes, or one alone.
struct Quantity {
  std::string title;  ///< "rmse [mN]"
  std::vector<std::string> columns;
  double scale = 1.0;  ///< from the column's unit to the title's
  bool mean = false;   ///< the mean speaks, otherwise the median
  bool share = false;  ///< of yes and no: no band
  bool logarithmic = false;
};

std::vector<Quantity> quantities_of(const nlohmann::json& columns) {
  const std::vector<Quantity> all{
      {"rmse [mN]", {"rmse_x_N", "rmse_y_N", "rmse_z_N"}, 1e3},
      {"bias [mN]", {"bias_x_N", "bias_y_N", "bias_z_N"}, 1e3},
      {"inside the 95 % interval [%]", {"inside_95_x", "inside_95_y", "inside_95_z"}, 100.0, true, true},
      {"NEES (3 is right)", {"nees"}, 1.0, true, false, true},
      {"NIS / degree (1 is right)", {"nis_per_dof"}, 1.0, true},
      {"rod solutions", {"evaluations"}},
      {"used [%]", {"updated"}, 100.0, true, true}};
  std::vector<Quantity> there;
  for (const Quantity& quantity : all)
    if (std::find(columns.begin(), columns.end(), quantity.columns[0]) != columns.end()) there.push_back(quantity);
  return there;
}

/// A name or a value of the study file, within Markdown, in a cell of a table, too.
std::string plain(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '|' || c == '\\') out += '\\';
    out += std::iscntrl(static_cast<unsigned char>(c)) != 0 ? ' ' : c;
  }
  return out;
}

/// Within <...>, where blanks and parentheses may stand.
std::string link_to(const std::string& file) {
  std::string out;
  for (const char c : file) {
    if (c == '<' || c == '>' || c == '\\') out += '\\';
    out += c;
  }
  return "<" + out + ">";
}

std::string label_of(const Quantity& quantity, std::size_t i) {
  constexpr const char* kAxes[] = {"along d1", "along d2", "along d3"};
  return quantity.columns.size() == 1 ? std::string() : kAxes[i];
}

std::string cell(const Spread& s, const Quantity& q) {
  if (s.runs == 0) return "";
  if (q.share) return fmt::format("{:.2f}", q.scale * s.mean);
  return fmt::format("{:.4g} ({:.4g} .. {:.4g})", q.scale * (q.mean ? s.mean : s.median), q.scale * s.low,
                     q.scale * s.high);
}

std::string what_cells_say(const Quantity& q) {
  if (q.share) return "mean";
  return q.mean ? "mean (5 % .. 95 % of the runs)" : "median (5 % .. 95 % of the runs)";
}

/// spreads[column][group]
using Spreads = std::vector<std::vector<Spread>>;

std::string table(const Quantity& q, const Groups& groups, const Spreads& spreads) {
  std::string text = fmt::format("**{}**, {}\n\n| {} | runs |", q.title, what_cells_say(q), plain(groups.parameter));
  for (std::size_t i = 0; i < q.columns.size(); ++i)
    text += fmt::format(" {} |", label_of(q, i).empty() ? q.title : label_of(q, i));
  text += "\n|---|---|";
  for (std::size_t i = 0; i < q.columns.size(); ++i) text += "---|";
  for (std::size_t g = 0; g < groups.labels.size(); ++g) {
    text += fmt::format("\n| {} | {} |", plain(groups.labels[g]), spreads[0][g].runs);
    for (const std::vector<Spread>& column : spreads) text += fmt::format(" {} |", cell(column[g], q));
  }
  return text + "\n\n";
}

/// Below two decades the ticks of a logarithmic axis say too little.
bool over_decades(const Groups& groups) { return groups.logarithmic && groups.x.back() > 100.0 * groups.x.front(); }

plot::Series series_of(const Quantity& q, std::size_t i, const Groups& groups, const std::vector<Spread>& spreads) {
  const std::string which = q.mean ? "mean" : "median", axis = label_of(q, i);
  plot::Series series{.label = axis.empty() ? which : axis + ", " + which, .x = groups.x};
  for (const Spread& s : spreads) {
    series.y.push_back(q.scale * (q.mean ? s.mean : s.median));
    if (q.share) continue;
    series.lower.push_back(q.scale * s.low);
    series.upper.push_back(q.scale * s.high);
  }
  return series;
}

/// Shares of the three axes in one panel; what has a band in a panel of its own, that none hides another.
void add_panels(const Quantity& q, const Groups& groups, const Spreads& spreads, plot::Figure& figure) {
  for (std::size_t i = 0; i < spreads.size(); ++i) {
    if (i == 0 || !q.share)
      figure.panels.push_back(
          {.x_label = groups.parameter, .y_label = q.title, .log_x = over_decades(groups), .log_y = q.logarithmic});
    figure.panels.back().series.push_back(series_of(q, i, groups, spreads[i]));
    if (!q.share) figure.panels.back().series[0].band_label = "5 to 95 % of the runs";
  }
}

/// Another than those of `pictures`: sensors `tip-1` and `tip_1` have one name here.
std::string file_name(const std::string& stem, std::string parameter, const std::string& extension,
                      const std::vector<Report::Picture>& pictures) {
  for (char& c : parameter)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  std::string name = fmt::format("{}-{}{}", stem, parameter, extension);
  for (int i = 2; std::any_of(pictures.begin(), pictures.end(), [&](const auto& p) { return p.name == name; }); ++i)
    name = fmt::format("{}-{}-{}{}", stem, parameter, i, extension);
  return name;
}

std::string heading(const StudyHead& head) {
  std::string text = fmt::format("# {}\n\nPlan `{}`, model {}: {} points, {} runs in {} shards, seed {}.\n",
                                 plain(head.name), head.plan_id.substr(0, 12), head.plan.at("model").get<std::string>(),
                                 head.points, head.runs, head.shards, head.plan.at("seed").dump());
  for (const nlohmann::json& parameter : head.plan.at("parameters"))
    if (const Groups groups = groups_of(parameter); groups.labels.size() == 1)
      text += fmt::format("\n`{}` is {} in all of them.\n", plain(groups.parameter), plain(groups.labels[0]));
  if (head.shards_done < head.shards)
    text += fmt::format("\n**Not complete:** {} of {} shards are done.\n", head.shards_done, head.shards);
  if (head.runs_failed > 0)
    text +=
        fmt::format("\n**{} runs failed** and are not counted below; the column `failure` of the export says why.\n",
                    head.runs_failed);
  return text + '\n';
}

std::string overall(const store::Database& database, std::span<const Quantity> quantities) {
  std::string text = "## All runs\n\n| | runs | mean | 5 % | median | 95 % |\n|---|---|---|---|---|---|\n";
  for (const Quantity& q : quantities)
    for (std::size_t i = 0; i < q.columns.size(); ++i) {
      const Spread s = spread_over_all(database, q.columns[i]);
      text += fmt::format("| {}{} | {} | {:.4g} | {:.4g} | {:.4g} | {:.4g} |\n", q.title,
                          label_of(q, i).empty() ? "" : ", " + label_of(q, i), s.runs, q.scale * s.mean,
                          q.scale * s.low, q.scale * s.median, q.scale * s.high);
    }
  return text + "\n";
}

}  // namespace

Report make_report(const store::Database& database, const std::string& stem, const std::string& extension) {
  const StudyHead head = read_head(database);
  const std::vector<Quantity> quantities = quantities_of(head.plan.at("columns"));
  Report report{.markdown = heading(head) + overall(database, quantities), .pictures = {}};
  for (const nlohmann::json& parameter : head.plan.at("parameters")) {
    const Groups groups = groups_of(parameter);
    if (groups.labels.size() == 1) continue;  // the heading has it
    Report::Picture picture{file_name(stem, groups.parameter, extension, report.pictures), {}};
    picture.figure.title = head.name;
    report.markdown += fmt::format("## Against {}\n\n", plain(groups.parameter));
    if (groups.numeric) report.markdown += fmt::format("![{}]({})\n\n", plain(groups.parameter), link_to(picture.name));
    for (const Quantity& q : quantities) {
      Spreads spreads;
      for (const std::string& column : q.columns) spreads.push_back(spreads_by(database, parameter, column));
      report.markdown += table(q, groups, spreads);
      add_panels(q, groups, spreads, picture.figure);
    }
    picture.figure.height_px = 120 + 210 * static_cast<int>(picture.figure.panels.size());
    if (groups.numeric) report.pictures.push_back(std::move(picture));
  }
  return report;
}

}  // namespace palpate::study
