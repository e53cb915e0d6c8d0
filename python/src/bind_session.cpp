// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/stl.h>

#include <limits>
#include <palpate/math/errors.hpp>
#include <palpate/session/session_run_reader.hpp>

#include "arrays.hpp"
#include "bindings.hpp"

namespace palpate::python {
namespace {

using session::LiveRecord;
using session::SessionReader;

/// An event as it is recorded: `data` is JSON.
struct SessionEvent {
  double device_time_s = 0.0;  ///< of the catheter's frame before it; NaN before the first
  bool of_all = false;         ///< of the whole session, not of one catheter
  std::string name, data;
};

/// One catheter of a session. As `palpate export` reads it: a frame counts where it, its readings and its estimate are
/// as they were written, so that frames and estimates are row by row the same.
class SessionRun {
 public:
  SessionRun(const std::string& path, const std::string& catheter) : reader_(path), source_(path) {
    if (reader_.catheters().empty())
      throw InputError(fmt::format("{}: expected at least one catheter, found none that can be read", path));
    if (catheter.empty()) require_one();
    index_ = static_cast<int>(session::find_catheter(reader_, path, catheter));
    settings_ = session::settings_of(chosen());
    for (const Sensor& sensor : settings_.catheter.sensors) sensor_names_.push_back(sensor.name);
    if (settings_.catheter.base.tracked) sensor_names_.push_back(settings_.catheter.base.sensor.name);
  }

  /// Reads to the end, and gives each frame with its estimate to `take`.
  template <class Take>
  void read(const Take& take) {
    LiveRecord record;
    double device_time_s = std::numeric_limits<double>::quiet_NaN();
    while (reader_.next(record)) {
      if (record.catheter != index_ && record.catheter != -1) continue;
      if (record.kind == LiveRecord::Kind::kEvent) {
        events_.push_back({device_time_s, record.catheter == -1, record.event, record.data});
        continue;
      }
      device_time_s = record.frame.time_s;
      take(record);
    }
  }

  /// In the order of the readings, as the catheter has them.
  const std::vector<std::string>& sensor_names() const { return sensor_names_; }
  const std::string& source() const { return source_; }

  /// What is said beside the rows: the catheter as the session began, events, what could not be read.
  py::dict rest() const {
    py::list events;
    const py::str name = shown(chosen().name);
    for (const SessionEvent& event : events_)
      events.append(py::make_tuple(event.device_time_s, event.of_all ? py::object(py::none()) : py::object(name),
                                   shown(event.name), shown(event.data)));
    py::dict out;
    out["catheter"] = settings_;
    out["events"] = events;
    out["damage"] = shown(damage());
    return out;
  }

 private:
  const session::SessionCatheter& chosen() const { return reader_.catheters()[static_cast<std::size_t>(index_)]; }

  void require_one() const {
    if (reader_.catheters().size() < 2) return;
    std::vector<std::string> names;
    for (const session::SessionCatheter& one : reader_.catheters()) names.push_back(one.name);
    throw InputError(fmt::format("{}: has {} catheters: expected catheter_name=, one of {}", source_, names.size(),
                                 fmt::join(names, ", ")));
  }

  std::vector<std::string> damage() const {
    std::vector<std::string> lines = reader_.damage();
    if (chosen().sensor_names != sensor_names_)
      lines.push_back(
          fmt::format("{}: the names of its sensors are not what was written: those of its catheter file were "
                      "taken",
                      source_));
    return lines;
  }

  SessionReader reader_;
  std::string source_;
  int index_ = 0;
  CatheterFile settings_;
  std::vector<std::string> sensor_names_;
  std::vector<SessionEvent> events_;
};

py::tuple read_session_recording(const std::string& path, const py::object& catheter_name) {
  SessionRun run(path, catheter_name.is_none() ? "" : word(catheter_name, "catheter_name"));
  Recording out{.data = {}, .of_session = true};
  out.data.source = run.source();
  out.data.sensor_names = run.sensor_names();
  out.data.sensor_lines.assign(out.data.sensor_names.size(), 0);
  {
    const OthersRun others_run;
    run.read([&](const LiveRecord& record) {
      out.data.frames.push_back(record.frame);
      out.data.frames.back().readings.resize(out.data.sensor_names.size(), {.status = SensorReading::Status::kAbsent});
      out.output_time_s.push_back(record.output_time_s);
      out.received_ns.push_back(record.received_ns);
    });
  }
  return py::make_tuple(std::move(out), run.rest());
}

py::tuple read_session_estimates(const std::string& path, const py::object& catheter_name) {
  SessionRun run(path, catheter_name.is_none() ? "" : word(catheter_name, "catheter_name"));
  std::vector<Estimate> estimates;
  {
    const OthersRun others_run;
    run.read([&](const LiveRecord& record) { estimates.push_back(record.estimate); });
  }
  return py::make_tuple(estimate_columns(estimates), run.rest());
}

}  // namespace

void bind_session(py::module_& m) {
  m.def("looks_like_session", [](const std::string& path) { return session::looks_like_session(path); });
  m.def("read_session_recording", &read_session_recording);
  m.def("read_session_estimates", &read_session_estimates);
}

}  // namespace palpate::python
