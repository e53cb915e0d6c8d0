// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <memory>
#include <palpate/session/estimate_numbers.hpp>
#include <palpate/session/export.hpp>
#include <palpate/session/hdf5_file.hpp>

namespace palpate::session {

namespace {

/// The unit at the end of a name: "cov_xx_N2" -> "N^2".
std::string unit_of(std::string_view name) {
  constexpr std::array<std::array<std::string_view, 2>, 7> kUnits{
      {{"_N2", "N^2"}, {"_Nm2", "N m^2"}, {"_Nm", "N m"}, {"_N", "N"}, {"_per_m", "1/m"}, {"_s", "s"}, {"_m", "m"}}};
  for (const auto& [ending, unit] : kUnits)
    if (name.ends_with(ending)) return std::string(unit);
  return name == "received_ns" ? "ns" : "1";
}

template <typename Number>
class Columns {
 public:
  Columns(const Hdf5File& file, const std::string& group, std::initializer_list<std::string_view> names) {
    for (const std::string_view name : names) add_column(file, group, name);
  }
  void add_column(const Hdf5File& file, const std::string& group, std::string_view name) {
    columns_.emplace_back(file, fmt::format("{}/{}", group, name), unit_of(name));
  }
  template <typename Numbers>
  void add_all(const Numbers& values) {
    std::size_t i = 0;
    for (const auto value : values) columns_[i++].add(value);
  }
  void finish() {
    for (auto& column : columns_) column.finish();
  }

 private:
  std::vector<Hdf5File::Column<Number>> columns_;
};

/// One catheter's group: /catheter_I/frame, /sensor_I, /estimate.
class Group {
 public:
  Group(const Hdf5File& file, const std::string& path, const SessionCatheter& catheter)
      : times_(make(file, path + "/frame"), path + "/frame", {"device_time_s", "output_time_s"}),
        counts_(file, path + "/frame", {"number", "received_ns"}),
        codes_(
            make(file, path + "/estimate"), path + "/estimate",
            {"status", "time_verdict", "used", "sensors_used", "dof", "jumped", "evaluations", "rejections", "hidden"}),
        numbers_(file, path + "/estimate", {}) {
    for (const std::string_view name : estimate_number_names()) numbers_.add_column(file, path + "/estimate", name);
    file.set_text(path, "name", catheter.name);
    file.set_text(path, "catheter_toml", catheter.toml);
    file.set_text(path + "/estimate/status", "codes",
                  "0 UPDATED, 1 RESEEDED, 2 AMBIGUOUS, 3 REJECTED, 4 HELD, 5 NOT_CONVERGED");
    for (std::size_t i = 0; i < catheter.sensor_names.size(); ++i) {
      const std::string sensor = fmt::format("{}/sensor_{}", path, i);
      readings_.emplace_back(
          make(file, sensor), sensor,
          std::initializer_list<std::string_view>{"q0", "qx", "qy", "qz", "tx_m", "ty_m", "tz_m", "error_m"});
      statuses_.emplace_back(file, sensor, std::initializer_list<std::string_view>{"status", "has_orientation"});
      file.set_text(sensor, "name", catheter.sensor_names[i]);
      file.set_text(sensor + "/status", "codes", "0 MISSING, 1 OK, 2 absent from the frame");
    }
  }

  void add(const LiveRecord& record) {
    const Estimate& e = record.estimate;
    times_.add_all(std::array{record.frame.time_s, record.output_time_s});
    counts_.add_all(std::array{record.frame.number, record.received_ns});
    codes_.add_all(std::array<std::int64_t, 9>{static_cast<std::int64_t>(e.status), static_cast<std::int64_t>(e.time),
                                               e.used, e.sensors_used, e.dof, e.jumped, e.evaluations,
                                               packed_rejections(e), observability_bits(e.observability)});
    EstimateNumbers numbers{};
    numbers_of(e, numbers);
    numbers_.add_all(numbers);
    for (std::size_t i = 0; i < readings_.size(); ++i) {
      const SensorReading& r = record.frame.readings[i];
      const auto& q = r.quaternion_wxyz;
      const auto& t = r.position_m;
      readings_[i].add_all(std::array{q(0), q(1), q(2), q(3), t(0), t(1), t(2), r.error_m});
      statuses_[i].add_all(std::array<std::int64_t, 2>{static_cast<std::int64_t>(r.status), r.has_orientation});
    }
  }
  void finish() {
    times_.finish();
    counts_.finish();
    codes_.finish();
    numbers_.finish();
    for (auto& columns : readings_) columns.finish();
    for (auto& columns : statuses_) columns.finish();
  }

 private:
  static const Hdf5File& make(const Hdf5File& file, const std::string& group) {
    file.make_group(group);
    return file;
  }
  Columns<double> times_;
  Columns<std::int64_t> counts_, codes_;
  Columns<double> numbers_;
  std::vector<Columns<double>> readings_;
  std::vector<Columns<std::int64_t>> statuses_;
};

}  // namespace

void export_hdf5(const ExportSource& source, ExportReport& report) {
  report.files.push_back(source.prefix + ".h5");
  Hdf5File file(report.files.back());
  file.set_text("/", "program_version", source.summary.program_version);
  file.set_text("/", "started", source.summary.started);
  std::vector<std::unique_ptr<Group>> groups(source.summary.catheters.size());
  for (const std::size_t i : source.chosen)
    groups[i] = std::make_unique<Group>(file, fmt::format("/catheter_{}", i), source.summary.catheters[i].catheter);
  SessionReader reader(source.path);
  LiveRecord record;
  while (reader.next(record)) {
    const auto i = static_cast<std::size_t>(record.catheter);
    if (record.kind != LiveRecord::Kind::kFrame || !groups[i]) continue;
    groups[i]->add(record);
    ++report.frames;
  }
  for (const auto& group : groups)
    if (group) group->finish();
  file.commit();
}

}  // namespace palpate::session
