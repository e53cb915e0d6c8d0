// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <palpate/recording/tendon_csv.hpp>
#include <palpate/recording/text_table.hpp>
#include <palpate/recording/time_bracket.hpp>

namespace palpate {
namespace {

struct Columns {
  explicit Columns(const CsvReader& csv)
      : time(csv.require("time_s")),
        moment_1(csv.require("moment_1_Nm")),
        moment_2(csv.require("moment_2_Nm")),
        sigma(csv.require("sigma_Nm")),
        tension(csv.find("tension_N")) {}

  std::size_t time, moment_1, moment_2, sigma;
  std::optional<std::size_t> tension;
};

Eigen::Vector2d read_moment(const CsvReader& csv, const Columns& columns, const Tendon& tendon) {
  if (!csv.text(columns.moment_1).empty() || !csv.text(columns.moment_2).empty()) {
    return {csv.finite_number(columns.moment_1), csv.finite_number(columns.moment_2)};
  }
  if (!columns.tension || csv.text(*columns.tension).empty()) {
    csv.refuse(columns.moment_1, "a moment in N m, or a tension_N");
  }
  if (!(tendon.offset_m > 0.0)) {
    csv.refuse(columns.moment_1, "a moment in N m, or [tendon] offset_mm in the catheter file to use tension_N");
  }
  return {csv.finite_number(*columns.tension) * tendon.offset_m, 0.0};
}

double read_sigma(const CsvReader& csv, const Columns& columns, const Tendon& tendon,
                  const Eigen::Vector2d& moment_Nm) {
  if (csv.text(columns.sigma).empty()) return tendon.moment_sigma_fraction * moment_Nm.norm();
  const double sigma_Nm = csv.finite_number(columns.sigma);
  if (sigma_Nm < 0.0) csv.refuse(columns.sigma, "a standard deviation, 0 or more");
  return sigma_Nm;
}

}  // namespace

TendonTrace read_tendon_csv(const std::filesystem::path& path, const Tendon& tendon) {
  const TextFile file = read_text_file(path);
  CsvReader csv(file);
  const Columns columns(csv);
  TendonTrace trace;
  trace.source = file.name;
  while (csv.next()) {
    const double time_s = csv.finite_number(columns.time);
    if (!trace.times_s.empty() && !(time_s > trace.times_s.back())) {
      csv.refuse(columns.time, fmt::format("a time later than {}, that of the row before", trace.times_s.back()));
    }
    trace.times_s.push_back(time_s);
    trace.moment_Nm.push_back(read_moment(csv, columns, tendon));
    trace.sigma_Nm.push_back(read_sigma(csv, columns, tendon, trace.moment_Nm.back()));
  }
  if (trace.times_s.empty()) refuse_field(file.name, csv.line(), "row", "", "at least one row after the header");
  return trace;
}

TendonTrace::Sample TendonTrace::interpolate(double time_s) const {
  const TimeBracket at = bracket_time(times_s, time_s);
  return {(1.0 - at.weight) * moment_Nm[at.low] + at.weight * moment_Nm[at.high],
          (1.0 - at.weight) * sigma_Nm[at.low] + at.weight * sigma_Nm[at.high], at.inside};
}

}  // namespace palpate
