// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <optional>
#include <palpate/recording/estimate_csv.hpp>
#include <palpate/session/export.hpp>
#include <palpate/session/session_run_reader.hpp>

namespace palpate::session {

namespace {

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c == '\n' ? ' ' : c);
  return out + '"';
}

/// The files of one catheter.
class CsvFiles {
 public:
  CsvFiles(const std::string& prefix, const CatheterSummary& summary, ExportReport& report)
      : names_(summary.catheter.sensor_names),
        tracker_(prefix + ".tracker.csv"),
        estimate_(prefix + ".estimate.csv", EstimateColumns::of(settings_of(summary.catheter).observer)),
        events_(prefix + ".events.csv"),
        toml_(prefix + ".catheter.toml") {
    for (const char* ending : {".tracker.csv", ".estimate.csv", ".events.csv", ".catheter.toml"})
      report.files.push_back(prefix + ending);
    tracker_.write("time_s,frame,sensor,status,q0,qx,qy,qz,tx_mm,ty_mm,tz_mm,error_mm\n");
    events_.write("device_time_s,output_time_s,received_ns,name,data\n");
    toml_.write(summary.catheter.toml);
    if (!summary.has_tendon) return;
    tendon_.emplace(prefix + ".tendon.csv");
    report.files.push_back(prefix + ".tendon.csv");
    tendon_->write("time_s,moment_1_Nm,moment_2_Nm,sigma_Nm\n");
  }

  void write(const LiveRecord& record, std::int64_t number, std::uint64_t& rounded) {
    const TrackerFrame& frame = record.frame;
    device_time_ = fmt::format("{}", frame.time_s);
    for (std::size_t i = 0; i < frame.readings.size() && i < names_.size(); ++i)
      write(frame.readings[i], fmt::format("{},{},{}", device_time_, number, names_[i]), rounded);
    estimate_.write(record.estimate);
    if (tendon_ && frame.tendon.present)
      tendon_->write(fmt::format("{},{},{},{}\n", device_time_, frame.tendon.moment_Nm.x(), frame.tendon.moment_Nm.y(),
                                 frame.tendon.sigma_Nm));
  }
  void write_event(const LiveRecord& event) {
    events_.write(fmt::format("{},{},{},{},{}\n", device_time_, event.output_time_s, event.received_ns,
                              quoted(event.event), quoted(event.data)));
  }
  void commit() {
    tracker_.commit();
    estimate_.commit();
    events_.commit();
    toml_.commit();
    if (tendon_) tendon_->commit();
  }

 private:
  void write(const SensorReading& reading, const std::string& row, std::uint64_t& rounded) {
    if (reading.status == SensorReading::Status::kAbsent) return;
    if (reading.status == SensorReading::Status::kMissing) return tracker_.write(row + ",MISSING,,,,,,,,\n");
    const auto& q = reading.quaternion_wxyz;
    const auto mm = [&](double metres) { return millimetres(metres, rounded); };
    tracker_.write(
        fmt::format("{},OK,{},{},{},{},{}\n", row,
                    reading.has_orientation ? fmt::format("{},{},{},{}", q(0), q(1), q(2), q(3)) : std::string(",,,"),
                    mm(reading.position_m.x()), mm(reading.position_m.y()), mm(reading.position_m.z()),
                    std::isnan(reading.error_m) ? std::string() : fmt::format("{}", mm(reading.error_m))));
  }

  std::vector<std::string> names_;
  OutputFile tracker_;
  EstimateCsvWriter estimate_;
  OutputFile events_, toml_;
  std::optional<OutputFile> tendon_;
  std::string device_time_;  ///< of the frame before; empty before the first
};

}  // namespace

void export_csv(const ExportSource& source, ExportReport& report) {
  std::vector<std::unique_ptr<CsvFiles>> files(source.summary.catheters.size());
  for (const std::size_t i : source.chosen)
    files[i] = std::make_unique<CsvFiles>(source.prefix_of(i), source.summary.catheters[i], report);
  std::vector<std::uint64_t> places(files.size());
  SessionReader reader(source.path);
  LiveRecord record;
  while (reader.next(record)) {
    for (std::size_t i = 0; i < files.size(); ++i) {
      if (!files[i] || (record.catheter != -1 && record.catheter != static_cast<int>(i))) continue;
      if (record.kind == LiveRecord::Kind::kEvent) {
        files[i]->write_event(record);
        continue;
      }
      files[i]->write(record, source.number_of(record, places[i]++), report.rounded);
      ++report.frames;
    }
  }
  for (const auto& one : files)
    if (one) one->commit();
}

}  // namespace palpate::session
