// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <apps/palpate/estimate_input.hpp>
#include <limits>
#include <palpate/math/errors.hpp>
#include <palpate/recording/csv_writers.hpp>
#include <palpate/recording/estimate_csv.hpp>
#include <palpate/recording/text_table.hpp>

#include "arrays.hpp"
#include "bindings.hpp"
#include "frame_arguments.hpp"

namespace palpate::python {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
using Status = SensorReading::Status;

const char* word_of(Status status) {
  return status == Status::kOk ? "OK" : status == Status::kMissing ? "MISSING" : "ABSENT";
}

/// What the tracker said; NaN where it said nothing.
void put_position(const SensorReading& reading, double* out) {
  put_rows(reading.status == Status::kOk ? reading.position_m : Vector3d(Vector3d::Constant(kNaN)), out);
}
void put_quaternion(const SensorReading& reading, double* out) {
  const bool known = reading.status == Status::kOk && reading.has_orientation;
  put_rows(known ? reading.quaternion_wxyz : Eigen::Vector4d(Eigen::Vector4d::Constant(kNaN)), out);
}

py::dict sensor_columns(const TrackerRecording& data, std::size_t sensor) {
  const std::size_t n = data.frames.size();
  const auto reading = [&](std::size_t i) -> const SensorReading& { return data.frames[i].readings[sensor]; };
  py::dict out;
  out["status"] = filled<std::int8_t>(
      n, {}, [&](std::size_t i, std::int8_t* to) { *to = static_cast<std::int8_t>(reading(i).status); });
  out["quaternion_wxyz"] = filled(n, {4}, [&](std::size_t i, double* to) { put_quaternion(reading(i), to); });
  out["position_m"] = filled(n, {3}, [&](std::size_t i, double* to) { put_position(reading(i), to); });
  out["error_m"] = filled(n, {}, [&](std::size_t i, double* to) { *to = reading(i).error_m; });
  return out;
}

py::dict frame_columns(const Recording& recording) {
  const TrackerRecording& data = recording.data;
  const std::size_t n = data.frames.size();
  py::dict out;
  out["time_s"] = filled(n, {}, [&](std::size_t i, double* to) { *to = data.frames[i].time_s; });
  out["frame"] = filled<std::int64_t>(n, {}, [&](std::size_t i, std::int64_t* to) { *to = data.frames[i].number; });
  out["tendon_moment_Nm"] = filled(n, {2}, [&](std::size_t i, double* to) {
    const TendonReading& tendon = data.frames[i].tendon;
    put_rows(tendon.present ? tendon.moment_Nm : Eigen::Vector2d(Eigen::Vector2d::Constant(kNaN)), to);
  });
  if (!recording.of_session) return out;
  out["output_time_s"] = filled(n, {}, [&](std::size_t i, double* to) { *to = recording.output_time_s[i]; });
  out["received_ns"] =
      filled<std::int64_t>(n, {}, [&](std::size_t i, std::int64_t* to) { *to = recording.received_ns[i]; });
  return out;
}

/// Arrays, one a sensor: what a user's own tracker gave.
Recording from_arrays(const py::object& time_s, const py::dict& sensors, const py::object& source) {
  Recording out;
  out.data.source = word(source, "source");
  const Array times = numbers(time_s, "time_s", {kAnyLength}, Values::kAny);
  const py::ssize_t n = times.size();
  out.data.frames.resize(static_cast<std::size_t>(n));
  for (py::ssize_t i = 0; i < n; ++i) {
    TrackerFrame& frame = out.data.frames[static_cast<std::size_t>(i)];
    frame.time_s = times.data()[i];
    frame.number = i;
    frame.readings.resize(sensors.size());
  }
  for (const auto& [key, value] : sensors) {
    const std::string name = word(key, "sensors");
    if (!py::isinstance<py::tuple>(value) || py::len(value) != 2)
      throw InputError(fmt::format("sensors['{}']: expected (position_m, quaternion_wxyz or None)", name));
    const auto pair = py::reinterpret_borrow<py::tuple>(value);
    const SensorArrays arrays(pair[0], pair[1], n, fmt::format("sensors['{}']: ", name));
    for (py::ssize_t i = 0; i < n; ++i)
      out.data.frames[static_cast<std::size_t>(i)].readings[out.data.sensor_names.size()] = arrays.reading(i);
    out.data.sensor_names.push_back(name);
  }
  return out;
}

/// What `load` makes of options and settings, as its catheter's.
template <class Load>
py::tuple bound_by(const Load& load, const CatheterFile& file, const py::object& tendon) {
  app::EstimateOptions options;
  if (!tendon.is_none()) options.tendon = path_text(tendon, "tendon");
  CatheterFile settings = file;
  if (!options.tendon.empty()) settings.catheter = driven_by_map(settings.catheter);
  std::vector<std::string> warnings;
  Recording out{.data = load(options, settings, warnings), .bound = true};
  return py::make_tuple(std::move(out), shown(warnings));
}

py::tuple read_bound(const std::vector<std::string>& paths, const CatheterFile& file, const py::object& tendon) {
  const auto load = [&](app::EstimateOptions& options, const CatheterFile& settings, auto& warnings) {
    options.recordings = paths;
    return app::load_recording(options, settings, warnings);
  };
  return bound_by(load, file, tendon);
}

/// The same of a recording that was read already.
py::tuple bind(const Recording& recording, const CatheterFile& file, const py::object& tendon) {
  const auto load = [&](const app::EstimateOptions& options, const CatheterFile& settings, auto& warnings) {
    return app::prepare_recording({recording.data}, options, settings, warnings);
  };
  py::tuple out = bound_by(load, file, tendon);
  auto& bound = out[0].cast<Recording&>();
  bound.of_session = recording.of_session;
  bound.output_time_s = recording.output_time_s;
  bound.received_ns = recording.received_ns;
  return out;
}

/// What a row of a CSV can say, and reads back.
void require_csv_name(const std::string& name) {
  if (!name.empty() && name.find_first_of(",\"\r\n") == std::string::npos && trim(name) == name) return;
  throw InputError(
      fmt::format("sensor '{}': expected a name without comma, quote or line break, and no blank at its ends, for a "
                  "tracker CSV",
                  printable(name)));
}

void write_csv(const Recording& recording, const py::object& path) {
  Catheter names;
  for (const std::string& name : recording.data.sensor_names) {
    require_csv_name(name);
    names.sensors.emplace_back().name = name;
  }
  write_tracker_csv(path_text(path, "path"), names, recording.data.frames);
}

TrackerFrame frame_at(const Recording& recording, py::ssize_t i) {
  const auto n = static_cast<py::ssize_t>(recording.data.frames.size());
  if (i < -n || i >= n) throw py::index_error(fmt::format("frame {} of {}", i, n));
  return recording.data.frames[static_cast<std::size_t>(i < 0 ? i + n : i)];
}

void bind_frame(py::module_& m) {
  const auto readings = [](const TrackerFrame& f) { return f.readings.size(); };
  py::class_<TrackerFrame>(m, "Frame",
                           "One instant of a tracker, n sensors: time_s, number, status (n words), position_m (n, 3), "
                           "quaternion_wxyz (n, 4), tendon_moment_Nm (2,) or None. NaN where nothing was said.")
      .def_readonly("time_s", &TrackerFrame::time_s)
      .def_readonly("number", &TrackerFrame::number)
      .def_property_readonly("status",
                             [](const TrackerFrame& f) {
                               py::list out;
                               for (const SensorReading& reading : f.readings) out.append(word_of(reading.status));
                               return out;
                             })
      .def_property_readonly("position_m",
                             [=](const TrackerFrame& f) {
                               return filled(readings(f), {3},
                                             [&](std::size_t i, double* out) { put_position(f.readings[i], out); });
                             })
      .def_property_readonly("quaternion_wxyz",
                             [=](const TrackerFrame& f) {
                               return filled(readings(f), {4},
                                             [&](std::size_t i, double* out) { put_quaternion(f.readings[i], out); });
                             })
      .def_property_readonly("tendon_moment_Nm", [](const TrackerFrame& f) {
        return f.tendon.present ? std::optional(f.tendon.moment_Nm) : std::nullopt;
      });
}

}  // namespace

void bind_recording(py::module_& m) {
  bind_frame(m);
  py::class_<Recording>(m, "Recording")
      .def(py::init(&from_arrays))
      .def_static("read", [](const std::string& path) { return Recording{.data = read_tracker_recording(path)}; })
      .def_static("read_bound", &read_bound)
      .def("bind", &bind)
      .def_property_readonly("source", [](const Recording& r) { return shown(r.data.source); })
      .def_property_readonly("sensor_names", [](const Recording& r) { return shown(r.data.sensor_names); })
      .def_property_readonly("notes", [](const Recording& r) { return shown(r.data.notes); })
      .def_readonly("bound", &Recording::bound)
      .def("frame_columns", [](const Recording& r) { return frame_columns(r); })
      .def("sensor_columns", [](const Recording& r, std::size_t i) { return sensor_columns(r.data, i); })
      .def("write_csv", &write_csv)
      .def("frame_at", &frame_at)
      .def("__len__", [](const Recording& r) { return r.data.frames.size(); });
}

}  // namespace palpate::python
