// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <apps/palpate/identify_registration_report.hpp>
#include <limits>
#include <palpate/identification/precurvature.hpp>
#include <palpate/identification/registration.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/recording/text_table.hpp>

#include "arrays.hpp"
#include "bindings.hpp"
#include "fit_files.hpp"

namespace palpate::python {
namespace {

/// Part of a recording; all of it where none is given.
struct Span {
  double from_s = -std::numeric_limits<double>::infinity(), to_s = std::numeric_limits<double>::infinity();
};

Span span_of(const py::object& interval, const char* name) {
  if (interval.is_none()) return {};
  const Eigen::Vector2d ends_s = vector2(interval, name);
  if (!(ends_s.x() < ends_s.y()))
    throw InputError(
        fmt::format("{} = ({}, {}): expected (from_s, to_s), the later time last", name, ends_s.x(), ends_s.y()));
  return {ends_s.x(), ends_s.y()};
}

/// In the order of the catheter's sensors.
TrackerRecording bound(const Recording& recording, const CatheterFile& file) {
  TrackerRecording out = recording.data;
  if (!recording.bound) bind_to_catheter(out, file.catheter, file.ignore_sensors);
  require_readings(file.catheter, out.sensor_names.size(), "recording");
  return out;
}

/// What a catheter file is told of a registration.
struct RegistrationFound {
  Registration found;
  bool mounting = false;
  Catheter before;

  void write(const py::object& catheter, const py::object& out) const {
    const FitFiles files = fit_files(catheter, out, {.catheter = before, .poses = true});
    TomlEdit edit(files.catheter);
    app::put_registration(found, mounting, edit);
    write_catheter_file(edit, files.out);
  }
};

py::dict registration_as_dict(const Registration& found, CatheterFile file) {
  const std::size_t n = found.positions.size();
  py::dict out;
  out["converged"] = found.converged;
  out["T_reference_base"] = found.T_reference_base;
  out["base_covariance"] = found.base_covariance;
  out["precurvature_per_m"] =
      filled(n, {3}, [&](std::size_t i, double* to) { put_rows(found.positions[i].precurvature_per_m, to); });
  out["precurvature_sigma_per_m"] =
      filled(n, {3}, [&](std::size_t i, double* to) { put_rows(found.positions[i].sigma_per_m, to); });
  out["position_rms_m"] = found.position_rms_m;
  out["rotation_rms_rad"] = found.rotation_rms_rad;
  out["chi_square"] = found.chi_square;
  out["degrees_of_freedom"] = found.degrees_of_freedom;
  out["warnings"] = shown(found.warnings);
  file.catheter = found.catheter;
  out["catheter"] = std::move(file);
  return out;
}

py::dict registration(const CatheterFile& file, const std::vector<std::pair<const Recording*, py::object>>& stretches,
                      bool mounting, const py::object& mount_sigma_m, const py::object& mount_sigma_rad) {
  RegistrationOptions options{.mounting = mounting};
  if (!mount_sigma_m.is_none()) options.mount_sigma_m = number(mount_sigma_m, "mount_sigma_m");
  if (!mount_sigma_rad.is_none()) options.mount_sigma_rad = number(mount_sigma_rad, "mount_sigma_rad");
  std::vector<KnobPosition> positions;
  for (const auto& [recording, interval] : stretches) {
    const Span span = span_of(interval, "interval");
    const TrackerRecording ready = bound(*recording, file);
    positions.push_back(
        {.name = ready.source, .poses = mean_reference_poses(file.catheter, ready.frames, span.from_s, span.to_s)});
  }
  Registration found;
  {
    const OthersRun others_run;
    found = identify_registration(file.catheter, positions, options);
  }
  py::dict out = registration_as_dict(found, file);
  out["_found"] = RegistrationFound{std::move(found), mounting, file.catheter};
  return out;
}

ClampKnowledge clamp_of(const py::object& clamp) {
  const std::string text = word(clamp, "clamp");
  if (text == "exact") return ClampKnowledge::kExact;
  if (text == "stated") return ClampKnowledge::kStated;
  if (text == "free") return ClampKnowledge::kFree;
  throw InputError(fmt::format("clamp = '{}': expected exact, stated or free", printable(text)));
}

py::dict arc_as_dict(const ArcFit& fit) {
  py::dict out;
  out["converged"] = fit.converged;
  out["precurvature_per_m"] = fit.precurvature_per_m;
  out["covariance"] = fit.covariance;
  out["told"] = fit.told;
  out["T_frame_base"] = fit.T_frame_base;
  out["rms_m"] = fit.rms_m;
  out["chi_square"] = fit.chi_square;
  out["degrees_of_freedom"] = fit.degrees_of_freedom;
  out["doubtful"] = fit.doubtful;
  out["warnings"] = shown(fit.warnings);
  return out;
}

py::dict arc_of_points(const CatheterFile& file, const py::object& arc_length_m, const py::object& position_m,
                       const py::object& sigma_m, const py::object& clamp) {
  ArcData data;
  data.point_sigma_m = number(sigma_m, "sigma_m");
  if (!(data.point_sigma_m >= 0.0))
    throw InputError(fmt::format("sigma_m = {}: expected 0 (told by the residuals) or more", data.point_sigma_m));
  const Array s = numbers(arc_length_m, "arc_length_m", {kAnyLength});
  const Array p = numbers(position_m, "position_m", {s.size(), 3}, Values::kAny);
  for (py::ssize_t i = 0; i < s.size(); ++i) {
    const Vector3d at_m = Eigen::Map<const Vector3d>(p.data() + 3 * i);
    if (!at_m.array().isNaN().all()) data.points.push_back({s.data()[i], at_m});
  }
  return arc_as_dict(fit_arc(file.catheter, data, clamp_of(clamp)));
}

py::dict arc_of_recording(const CatheterFile& file, const Recording& recording, const py::object& interval,
                          const py::object& clamp) {
  const Span span = span_of(interval, "interval");
  const TrackerRecording ready = bound(recording, file);
  ArcData data;
  data.poses = mean_poses(file.catheter, ready.frames, span.from_s, span.to_s);
  return arc_as_dict(fit_arc(file.catheter, data, clamp_of(clamp)));
}

}  // namespace

void bind_shaft_identification(py::module_& m) {
  py::class_<RegistrationFound>(m, "RegistrationFound").def("write", &RegistrationFound::write);
  m.def("identify_registration", &registration);
  m.def("fit_arc_to_points", &arc_of_points);
  m.def("fit_arc_to_recording", &arc_of_recording);
}

}  // namespace palpate::python
