// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <apps/palpate/estimate_input.hpp>
#include <apps/palpate/estimate_warnings.hpp>
#include <apps/palpate/reference_tare.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/observer/smoothing.hpp>

#include "arrays.hpp"
#include "bindings.hpp"

namespace palpate::python {
namespace {

/// What `palpate estimate` is told besides recording and catheter.
struct Wishes {
  app::EstimateOptions command = {};
  bool smooth = false, strict = false;
};

Wishes wishes_of(const py::object& tendon, const py::object& reference, bool smooth, bool strict, CatheterFile& file) {
  Wishes wishes{.smooth = smooth, .strict = strict};
  if (!tendon.is_none()) wishes.command.tendon = path_text(tendon, "tendon");
  if (!reference.is_none()) {
    const Eigen::Vector2d span_s = vector2(reference, "reference");
    if (!(span_s.x() < span_s.y()))
      throw InputError(
          fmt::format("reference = ({}, {}): expected (from_s, to_s), the later time last", span_s.x(), span_s.y()));
    file.reference = {.given = true, .from_s = span_s.x(), .to_s = span_s.y(), .straight = file.reference.straight};
  }
  if (smooth && file.observer.forecast_s > 0.0)
    throw InputError(
        fmt::format("forecast_s = {}: expected without smooth, which knows what comes", file.observer.forecast_s));
  return wishes;
}

/// Bound to another catheter, readings would stand for other sensors.
void require_names(const Recording& recording, const Catheter& catheter) {
  require_readings(catheter, recording.data.sensor_names.size(), "recording");
  for (std::size_t i = 0; i < catheter.sensors.size(); ++i)
    if (recording.data.sensor_names[i] != catheter.sensors[i].name)
      throw InputError(fmt::format("recording: sensor {} is \"{}\": expected \"{}\", as the catheter has it", i + 1,
                                   recording.data.sensor_names[i], catheter.sensors[i].name));
}

struct Offline {
  std::vector<Estimate> estimates;
  Catheter catheter;
  std::optional<Tare> tare;
};

Offline run(const TrackerRecording& recording, const CatheterFile& file, const Wishes& wishes,
            std::vector<std::string>& warnings) {
  if (wishes.strict) app::refuse_passed_over_rows(recording);
  app::CorrectedCatheter corrected = app::correct_by_reference(file, recording, warnings);
  ForceObserver observer(corrected.catheter, file.observer);
  SmoothingPass smoothing(observer);
  Offline out{{}, corrected.catheter, corrected.tare};
  for (const TrackerFrame& frame : recording.frames) {
    const Estimate estimate = observer.update(frame);
    if (wishes.strict) app::refuse_passed_over_readings(recording, frame, estimate);
    if (wishes.smooth)
      smoothing.add(observer, frame, estimate);
    else
      out.estimates.push_back(estimate);
  }
  if (wishes.smooth) out.estimates = smoothing.finish(observer);
  const auto used = std::count_if(out.estimates.begin(), out.estimates.end(),
                                  [](const Estimate& estimate) { return estimate.used != 0; });
  app::warn_of_few_used(recording, static_cast<std::size_t>(used), warnings);
  return out;
}

TrackerRecording prepared(const std::variant<const Recording*, std::vector<std::string>>& source, Wishes& wishes,
                          const CatheterFile& file, std::vector<std::string>& warnings) {
  if (const auto* paths = std::get_if<std::vector<std::string>>(&source)) {
    wishes.command.recordings = *paths;
    return app::load_recording(wishes.command, file, warnings);
  }
  const Recording& recording = *std::get<const Recording*>(source);
  if (!recording.bound) return app::prepare_recording({recording.data}, wishes.command, file, warnings);
  if (!wishes.command.tendon.empty())
    throw InputError("tendon: expected None, for this recording was read for its catheter already");
  require_names(recording, file.catheter);
  if (recording.data.frames.empty())
    throw InputError(fmt::format("{}: expected at least one frame", recording.data.source));
  return recording.data;
}

py::object tare_of(const Offline& offline) {
  if (!offline.tare) return py::none();
  const Tare& tare = *offline.tare;
  py::dict out;
  out["frames"] = tare.frames;
  out["base_shift_m"] = filled(3, {}, [&](std::size_t i, double* to) { *to = tare.base_shift_m(i); });
  out["base_rotation_rad"] = filled(3, {}, [&](std::size_t i, double* to) { *to = tare.base_rotation_rad(i); });
  out["precurvature_change_per_m"] =
      filled(3, {}, [&](std::size_t i, double* to) { *to = tare.precurvature_change_per_m(i); });
  out["largest_change_sigmas"] = tare.largest_change_sigmas;
  return out;
}

py::tuple estimate(const std::variant<const Recording*, std::vector<std::string>>& source, const CatheterFile& given,
                   const py::object& tendon, const py::object& reference, bool smooth, bool strict,
                   const py::dict& options) {
  CatheterFile file = given;
  set_options(options, file.observer);
  Wishes wishes = wishes_of(tendon, reference, smooth, strict, file);
  if (!wishes.command.tendon.empty()) file.catheter = driven_by_map(file.catheter);
  std::vector<std::string> warnings = file.warnings;
  app::warn_of_states_without_sigma(file, warnings);
  Offline offline;
  {
    const OthersRun others_run;
    offline = run(prepared(source, wishes, file, warnings), file, wishes, warnings);
  }
  file.catheter = offline.catheter;
  file.reference.given = false;  // it is in the catheter now
  return py::make_tuple(estimate_columns(offline.estimates), std::move(file), shown(warnings), tare_of(offline));
}

}  // namespace

void bind_estimation(py::module_& m) {
  m.def("estimate", &estimate);
  m.def("check_options", [](const CatheterFile& file, const py::dict& options) {
    ObserverOptions as_changed = file.observer;
    set_options(options, as_changed);
  });
}

}  // namespace palpate::python
