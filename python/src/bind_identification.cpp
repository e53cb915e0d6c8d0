// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <apps/palpate/identify_stiffness_input.hpp>
#include <apps/palpate/identify_stiffness_toml.hpp>
#include <palpate/identification/delay.hpp>
#include <palpate/identification/noise.hpp>
#include <palpate/identification/noise_moving.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/recording/text_table.hpp>

#include "arrays.hpp"
#include "bindings.hpp"
#include "estimate_rows.hpp"
#include "fit_files.hpp"

namespace palpate::python {
namespace {

LoadCase load_case(const py::dict& given) {
  LoadCase out{.name = word(given["name"], "case.name"), .force_base_N = {}, .points = {}};
  const auto named = [&](const char* what) { return fmt::format("case '{}': {}", out.name, what); };
  out.force_base_N = vector3(given["force_base_N"], named("force_base_N"));
  const Array s = numbers(given["arc_length_m"], named("arc_length_m"), {kAnyLength}, Values::kAny);
  const Array p = numbers(given["position_base_m"], named("position_base_m"), {s.size(), 3}, Values::kAny);
  const double sigma_m = number(given["sigma_m"], named("sigma_m"));
  if (!(sigma_m >= 0.0)) throw InputError(fmt::format("{} = {}: expected 0 or more", named("sigma_m"), sigma_m));
  for (py::ssize_t i = 0; i < s.size(); ++i) {
    ShapePoint& point = out.points.emplace_back();
    point.arc_length_m = s.data()[i];
    point.position_base_m = Eigen::Map<const Vector3d>(p.data() + 3 * i);
    point.sigma_m.setConstant(sigma_m);
  }
  return out;
}

StiffnessOptions options_of(const py::object& wanted, const py::object& by, const py::object& poisson_ratio,
                            bool free_shear) {
  const std::string unknowns = word(wanted, "unknowns"), method = word(by, "method");
  using O = StiffnessOptions;
  O options{.free_shear = free_shear};
  if (unknowns == "scale")
    options.unknowns = O::Unknowns::kScale;
  else if (unknowns == "bending,torsion")
    options.unknowns = O::Unknowns::kBendingAndTorsion;
  else if (unknowns != "bending")
    throw InputError(fmt::format("unknowns = '{}': expected bending, scale or bending,torsion", printable(unknowns)));
  if (method == "nelder-mead")
    options.method = O::Method::kNelderMead;
  else if (method != "lm")
    throw InputError(fmt::format("method = '{}': expected lm or nelder-mead", printable(method)));
  if (!poisson_ratio.is_none()) options.poisson_ratio = number(poisson_ratio, "poisson_ratio");
  return options;
}

/// What a catheter file is told of a fit.
struct StiffnessFound {
  StiffnessFit fit;
  StiffnessOptions::Unknowns unknowns;
  Fitted fitted;

  void write(const py::object& catheter, const py::object& out) const {
    const FitFiles files = fit_files(catheter, out, fitted);
    if (!fit.converged)
      throw InputError(
          fmt::format("{}: the fit did not converge in {} iterations: nothing was written", files.out, fit.iterations));
    write_catheter_file(app::with_identified_stiffness(files.catheter, files.stated.catheter, fit, unknowns),
                        files.out);
  }
};

py::dict as_dict(const StiffnessFit& fit, const std::vector<std::string>& warnings, CatheterFile file) {
  py::list unknowns;
  for (const StiffnessUnknown& one : fit.unknowns) unknowns.append(py::make_tuple(one.name, one.value, one.log_sigma));
  py::dict out;
  out["converged"] = fit.converged;
  out["unknowns"] = unknowns;
  out["stiffness_Nm2"] = Vector3d(fit.rod.first_flexible().stiffness_Nm2);
  out["log_covariance"] = fit.log_covariance;
  out["rms_m"] = fit.rms_m;
  out["chi_square"] = fit.chi_square;
  out["degrees_of_freedom"] = fit.degrees_of_freedom;
  out["point_sigma_m"] = fit.point_sigma_m;
  out["iterations"] = fit.iterations;
  out["warnings"] = shown(warnings);
  file.catheter.rod = fit.rod;
  out["catheter"] = std::move(file);
  return out;
}

py::dict stiffness(const CatheterFile& file, const std::variant<std::string, std::vector<py::dict>>& cases,
                   const py::object& unknowns, const py::object& method, const py::object& poisson_ratio,
                   bool free_shear) {
  StiffnessOptions options = options_of(unknowns, method, poisson_ratio, free_shear);
  app::StiffnessInput input{.catheter = file.catheter, .cases = {}, .warnings = {}};
  const bool cases_given = !std::holds_alternative<std::string>(cases);
  if (const auto* path = std::get_if<std::string>(&cases)) {
    const LoadCaseFile read = read_load_cases(*path, file.catheter);
    if (read.own_weight_subtracted) options.own_weight = StiffnessOptions::OwnWeight::kSubtracted;
    input = app::load_stiffness_input(file, read);
  } else {
    for (const py::dict& one : std::get<std::vector<py::dict>>(cases)) input.cases.push_back(load_case(one));
  }
  StiffnessFit fit;
  {
    const OthersRun others_run;
    fit = identify_stiffness(input.catheter, input.cases, options);
  }
  input.warnings.insert(input.warnings.end(), fit.warnings.begin(), fit.warnings.end());
  py::dict out = as_dict(fit, input.warnings, file);
  out["_found"] = StiffnessFound{std::move(fit),
                                 options.unknowns,
                                 {.catheter = file.catheter, .poses = !cases_given, .base = true, .stiffness = true}};
  return out;
}

py::dict delay(const py::object& time_s, const py::object& force_tip_N, const py::object& sigma_N,
               const py::object& truth_time_s, const py::object& truth_force_N, const py::object& max_delay_s,
               bool free_gain) {
  const ForceTrace felt = trace_from(time_s, force_tip_N, "estimate");
  const auto n = static_cast<py::ssize_t>(felt.times_s.size());
  const Array sigma = numbers(sigma_N, "estimate.sigma_N", {n, 3});
  const ForceTrace truth = trace_from(truth_time_s, truth_force_N, "truth");
  const double most_s = number(max_delay_s, "max_delay_s");
  if (!(most_s > 0.0 && most_s <= 1000.0))
    throw InputError(fmt::format("max_delay_s = {}: expected seconds, more than 0, at most 1000", most_s));
  std::vector<TimedForce> tracker, sensor;
  for (std::size_t i = 0; i < felt.times_s.size(); ++i)
    tracker.push_back({felt.times_s[i], felt.force_tip_N[i], rows3(sigma)[i]});
  for (std::size_t i = 0; i < truth.times_s.size(); ++i) sensor.push_back({truth.times_s[i], truth.force_tip_N[i]});
  const DelayFit fit = identify_delay(tracker, sensor, {.max_delay_s = most_s, .free_gain = free_gain});
  py::dict out;
  out["delay_s"] = fit.delay_s;
  out["sigma_s"] = fit.sigma_s;
  out["gain"] = fit.gain;
  out["gain_sigma"] = fit.gain_sigma;
  out["offset_N"] = fit.offset_N;
  out["rms_N"] = fit.rms_N;
  out["explained"] = fit.explained;
  out["ambiguous"] = fit.ambiguous;
  out["used"] = fit.used;
  return out;
}

const char* word_of(Rest rest) { return rest == Rest::kStill ? "still" : rest == Rest::kDrifts ? "drifts" : "moves"; }

py::dict noise_at_rest(const SensorSamples& samples) {
  const RestNoise found = identify_rest_noise(samples);
  py::dict out;
  out["untold"] = found.untold;
  out["used"] = found.used;
  out["outliers"] = found.outliers;
  out["covariance"] = found.covariance;
  out["rest"] = word_of(found.rest);
  out["sigma_fraction"] = found.sigma_fraction;
  out["correlation_time_s"] = found.correlation_time_s;
  return out;
}

py::dict noise_of_motion(const SensorSamples& samples) {
  const MovingNoise found = identify_moving_noise(samples);
  py::dict out;
  out["untold"] = found.untold;
  out["used"] = found.used;
  out["holds"] = found.holds();
  out["sigma"] = filled(6, {}, [&](std::size_t i, double* to) { *to = found.channels[i].sigma; });
  out["sigma_fraction"] = filled(6, {}, [&](std::size_t i, double* to) { *to = found.channels[i].sigma_fraction; });
  return out;
}

py::dict noise(const Recording& recording, const py::object& interval, bool moving) {
  NoiseInterval span;
  if (!interval.is_none()) {
    const Eigen::Vector2d ends_s = vector2(interval, "interval");
    span = {ends_s.x(), ends_s.y()};
  }
  py::dict out;
  for (std::size_t i = 0; i < recording.data.sensor_names.size(); ++i) {
    const SensorSamples samples = collect_samples(recording.data.frames, i, span);
    out[shown(recording.data.sensor_names[i])] = moving ? noise_of_motion(samples) : noise_at_rest(samples);
  }
  return out;
}

}  // namespace

void bind_identification(py::module_& m) {
  py::class_<StiffnessFound>(m, "StiffnessFound").def("write", &StiffnessFound::write);
  m.def("identify_stiffness", &stiffness);
  m.def("identify_delay", &delay);
  m.def("identify_noise", &noise);
}

}  // namespace palpate::python
