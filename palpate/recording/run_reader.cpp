// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <palpate/math/errors.hpp>
#include <palpate/recording/run_reader.hpp>
#include <palpate/recording/text_table.hpp>

namespace palpate {

namespace {

bool same_time(double a_s, double b_s) {
  return std::abs(a_s - b_s) <= 1e-6 || (!std::isfinite(a_s) && !std::isfinite(b_s));
}

void match_rows(const TrackerRecording& recording, const std::vector<EstimateRow>& rows, const std::string& path) {
  const std::size_t both = std::min(rows.size(), recording.frames.size());
  for (std::size_t i = 0; i < both; ++i) {
    const TrackerFrame& frame = recording.frames[i];
    if (!same_time(rows[i].time_s, frame.time_s))
      refuse_field(path, rows[i].line, "time_s", fmt::format("{}", rows[i].time_s),
                   fmt::format("{} s, the time of frame {} of {}: is it the estimate of this recording?", frame.time_s,
                               frame.number, recording.source));
  }
  if (rows.size() != recording.frames.size())
    throw InputError(fmt::format("{}: {} rows: expected {}, one for every frame of {}", path, rows.size(),
                                 recording.frames.size(), recording.source));
}

}  // namespace

std::vector<RunGap> find_gaps(const std::vector<TrackerFrame>& frames) {
  std::vector<double> periods_s;
  for (std::size_t i = 1; i < frames.size(); ++i) periods_s.push_back(frames[i].time_s - frames[i - 1].time_s);
  std::vector<double> finite = periods_s;
  std::erase_if(finite, [](double period_s) { return !(period_s > 0.0) || !std::isfinite(period_s); });
  if (finite.empty()) return {};
  const auto middle = finite.begin() + static_cast<std::ptrdiff_t>(finite.size() / 2);
  std::nth_element(finite.begin(), middle, finite.end());
  const double most_s = std::max(0.25, 5.0 * *middle);
  std::vector<RunGap> gaps;
  for (std::size_t i = 0; i < periods_s.size(); ++i)
    if (periods_s[i] > most_s) gaps.push_back({frames[i].time_s, frames[i + 1].time_s});
  return gaps;
}

FileRunReader::FileRunReader(TrackerRecording recording, RunDescription description, const std::string& estimate_path)
    : recording_(std::move(recording)), description_(std::move(description)) {
  description_.source = recording_.source;
  description_.sensor_names = recording_.sensor_names;
  description_.has_estimates = !estimate_path.empty();
  if (description_.has_estimates) {
    estimate_ = read_estimate_csv(estimate_path);
    match_rows(recording_, estimate_, estimate_path);
  }
  for (const std::string& note : recording_.notes) events_.push_back({std::nullopt, note});
  if (recording_.duplicate_rows > 0)
    events_.push_back({std::nullopt, fmt::format("{} duplicate rows were passed over", recording_.duplicate_rows)});
  gaps_ = find_gaps(recording_.frames);
}

bool FileRunReader::next(RunMoment& moment) {
  if (next_ >= recording_.frames.size()) return false;
  moment.frame = recording_.frames[next_];
  if (description_.has_estimates) moment.estimate = estimate_[next_];
  ++next_;
  return true;
}

}  // namespace palpate
