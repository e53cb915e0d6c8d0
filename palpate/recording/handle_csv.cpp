// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <palpate/recording/catheter_tendon_map.hpp>
#include <palpate/recording/handle_csv.hpp>
#include <palpate/recording/text_table.hpp>
#include <palpate/recording/time_bracket.hpp>

namespace palpate {

HandleTrace read_handle_csv(const std::filesystem::path& path, TendonInput input) {
  const TextFile file = read_text_file(path);
  CsvReader csv(file);
  const std::size_t time = csv.require("time_s"), position = csv.require(name_of(input));
  const auto moment_1 = csv.find("moment_1_Nm"), moment_2 = csv.find("moment_2_Nm");
  HandleTrace trace;
  trace.source = file.name;
  while (csv.next()) {
    const double time_s = csv.finite_number(time);
    if (!trace.times_s.empty() && !(time_s > trace.times_s.back()))
      csv.refuse(time, fmt::format("a time later than {}, that of the row before", trace.times_s.back()));
    trace.times_s.push_back(time_s);
    trace.position.push_back(csv.finite_number(position) * si_per_unit(input));
    for (const auto& moment : {moment_1, moment_2})
      trace.has_moments = trace.has_moments || (moment && !csv.text(*moment).empty());
  }
  if (trace.times_s.empty()) refuse_field(file.name, csv.line(), "row", "", "at least one row after the header");
  return trace;
}

BendTrace bends_at(const HandleTrace& handle, const TendonPlay& play, const std::vector<double>& times_s) {
  std::vector<TendonPlay::Memory> memories;  // after each sample
  TendonPlay::Memory memory;
  for (const double position : handle.position) {
    play.advance(position, memory);
    memories.push_back(memory);
  }
  BendTrace out;
  for (const double time_s : times_s) {
    BendReading& bend = out.bends.emplace_back();
    if (!std::isfinite(time_s)) continue;
    const TimeBracket at = bracket_time(handle.times_s, time_s);
    memory = memories[at.low];
    bend = play.advance((1.0 - at.weight) * handle.position[at.low] + at.weight * handle.position[at.high], memory);
    out.outside += at.inside ? 0 : 1;
    out.beyond_the_map += bend.inside ? 0 : 1;
  }
  return out;
}

}  // namespace palpate
