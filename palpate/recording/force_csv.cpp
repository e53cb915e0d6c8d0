// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <palpate/recording/force_csv.hpp>
#include <palpate/recording/text_table.hpp>
#include <palpate/recording/time_bracket.hpp>

namespace palpate {
namespace {

Vector3d read_vector(const CsvReader& csv, const std::array<std::size_t, 3>& columns) {
  return {csv.finite_number(columns[0]), csv.finite_number(columns[1]), csv.finite_number(columns[2])};
}

}  // namespace

ForceTrace read_force_csv(const std::filesystem::path& path) {
  const TextFile file = read_text_file(path);
  CsvReader csv(file);
  const std::size_t time = csv.require("time_s");
  const std::array tip = {csv.require("fx_tip_N"), csv.require("fy_tip_N"), csv.require("fz_tip_N")};
  const bool has_base = csv.find("fx_base_N") || csv.find("fy_base_N") || csv.find("fz_base_N");
  std::array<std::size_t, 3> base{};
  if (has_base) base = {csv.require("fx_base_N"), csv.require("fy_base_N"), csv.require("fz_base_N")};

  ForceTrace trace;
  trace.source = file.name;
  while (csv.next()) {
    const double time_s = csv.finite_number(time);
    if (!trace.times_s.empty() && !(time_s > trace.times_s.back())) {
      csv.refuse(time, fmt::format("a time later than {}, that of the row before", trace.times_s.back()));
    }
    trace.times_s.push_back(time_s);
    trace.force_tip_N.push_back(read_vector(csv, tip));
    if (has_base) trace.force_base_N.push_back(read_vector(csv, base));
  }
  if (trace.times_s.empty()) refuse_field(file.name, csv.line(), "row", "", "at least one row after the header");
  return trace;
}

ForceTrace::Sample ForceTrace::interpolate(double time_s) const {
  const TimeBracket at = bracket_time(times_s, time_s);
  return {(1.0 - at.weight) * force_tip_N[at.low] + at.weight * force_tip_N[at.high], at.inside};
}

}  // namespace palpate
