// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/session/inspection.hpp>
#include <palpate/session/lost_rows.hpp>

namespace palpate::session {

namespace {

/// Gathers one catheter; of its frames the times alone are kept.
class Gatherer {
 public:
  explicit Gatherer(const SessionCatheter& catheter) {
    summary_.catheter = catheter;
    summary_.usable.resize(catheter.sensor_names.size());
  }
  void add(const LiveRecord& record) {
    const TrackerFrame& frame = record.frame;
    if (summary_.frames++ == 0) summary_.first_s = frame.time_s;
    summary_.numbers_rise = summary_.numbers_rise && (times_.empty() || frame.number > last_number_);
    last_number_ = frame.number;
    summary_.last_s = frame.time_s;
    ++summary_.statuses[static_cast<std::size_t>(record.estimate.status)];
    bool any = false;
    for (std::size_t i = 0; i < frame.readings.size() && i < summary_.usable.size(); ++i) {
      any = any || frame.readings[i].status != SensorReading::Status::kAbsent;
      summary_.usable[i] += frame.readings[i].status == SensorReading::Status::kOk ? 1 : 0;
    }
    summary_.frames_without_rows += any ? 0 : 1;
    summary_.has_tendon = summary_.has_tendon || frame.tendon.present;
    TrackerFrame time;
    time.time_s = frame.time_s;
    times_.push_back(time);
  }
  CatheterSummary finish() {
    summary_.gaps = find_gaps(times_);
    summary_.median_period_s = std::numeric_limits<double>::quiet_NaN();
    std::vector<double> periods_s;
    for (std::size_t i = 1; i < times_.size(); ++i) {
      const double period_s = times_[i].time_s - times_[i - 1].time_s;
      if (std::isfinite(period_s)) periods_s.push_back(period_s);
    }
    if (periods_s.empty()) return std::move(summary_);
    const auto middle = periods_s.begin() + static_cast<std::ptrdiff_t>(periods_s.size() / 2);
    std::nth_element(periods_s.begin(), middle, periods_s.end());
    summary_.median_period_s = *middle;
    return std::move(summary_);
  }

 private:
  CatheterSummary summary_;
  std::vector<TrackerFrame> times_;
  std::int64_t last_number_ = 0;
};

std::uint64_t dropped_in(const LiveRecord& event) {
  const nlohmann::json data = nlohmann::json::parse(event.data, nullptr, false);
  return data.is_object() ? data.value("count", std::uint64_t{0}) : 0;
}

void read_records(SessionReader& reader, SessionSummary& summary) {
  std::vector<Gatherer> catheters(reader.catheters().begin(), reader.catheters().end());
  LiveRecord record;
  std::int64_t first_ns = 0;
  while (reader.next(record)) {
    if (first_ns == 0) first_ns = record.received_ns;
    summary.received_s = 1e-9 * static_cast<double>(record.received_ns - first_ns);
    if (record.kind == LiveRecord::Kind::kEvent) {
      ++summary.events[record.event];
      if (record.event == "dropped") summary.dropped += dropped_in(record);
    } else if (static_cast<std::size_t>(record.catheter) < catheters.size()) {
      catheters[static_cast<std::size_t>(record.catheter)].add(record);
    }
  }
  for (Gatherer& catheter : catheters) summary.catheters.push_back(catheter.finish());
}

std::uintmax_t bytes_of(const std::filesystem::path& path) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  return error ? 0 : bytes;
}

}  // namespace

SessionSummary inspect(const std::filesystem::path& path, bool full) {
  SessionReader reader(path);
  SessionSummary summary;
  summary.bytes = bytes_of(path);
  summary.log_bytes = bytes_of(path.string() + "-wal");
  summary.program_version = reader.about("program_version");
  summary.started = reader.about("started");
  summary.durability = reader.about("durability");
  read_records(reader, summary);
  summary.lost = reader.lost();
  summary.damage = reader.damage();
  OpenSession session = open_session(path);
  summary.schema_version = session.database->integer("PRAGMA user_version");
  if (summary.damage.empty() || full)
    for (const std::string& said : check_integrity(*session.database, full))
      summary.damage.push_back(path.string() + ": " + said);
  return summary;
}

}  // namespace palpate::session
