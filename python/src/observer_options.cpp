// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <apps/palpate/estimate_options.hpp>
#include <functional>
#include <palpate/math/errors.hpp>
#include <palpate/recording/nearest_name.hpp>
#include <palpate/recording/text_table.hpp>

#include "arrays.hpp"
#include "bindings.hpp"

namespace palpate::python {
namespace {

struct Field {
  std::string_view name;
  std::function<void(py::handle, ObserverOptions&)> set;
  std::function<py::object(const ObserverOptions&)> get;
};

Field field(std::string_view name, double ObserverOptions::*member) {
  return {name, [=](py::handle value, ObserverOptions& o) { o.*member = number(value, name); },
          [=](const ObserverOptions& o) { return py::float_(o.*member); }};
}

Field field(std::string_view name, bool ObserverOptions::*member) {
  return {name, [=](py::handle value, ObserverOptions& o) { o.*member = truth_value(value, name); },
          [=](const ObserverOptions& o) { return py::bool_(o.*member); }};
}

Field field(std::string_view name, int ObserverOptions::*member) {
  const auto set = [=](py::handle value, ObserverOptions& o) {
    const long whole = whole_number(value, name);
    if (whole < -1'000'000 || whole > 1'000'000)
      throw InputError(fmt::format("{} = {}: expected a whole number of usual size", name, whole));
    o.*member = static_cast<int>(whole);
  };
  return {name, set, [=](const ObserverOptions& o) { return py::int_(o.*member); }};
}

/// Chosen by the words of the command line, from the first enumerator to `last`.
template <class Enum>
Field choice(std::string_view name, Enum ObserverOptions::*member, Enum last) {
  const auto set = [=](py::handle value, ObserverOptions& o) {
    const std::string text = word(value, name);
    std::vector<std::string_view> known;
    for (int i = 0; i <= static_cast<int>(last); ++i) {
      known.push_back(app::name_of(static_cast<Enum>(i)));
      if (known.back() != text) continue;
      o.*member = static_cast<Enum>(i);
      return;
    }
    throw InputError(fmt::format("{} = '{}': expected one of {}", name, printable(text), fmt::join(known, ", ")));
  };
  return {name, set, [=](const ObserverOptions& o) { return py::str(std::string(app::name_of(o.*member))); }};
}

const std::vector<Field>& fields() {
  using O = ObserverOptions;
  static const std::vector<Field> all{choice("method", &O::method, Method::kUkf),
                                      choice("measurement", &O::measurement, MeasurementKind::kTipAndCurvature),
                                      choice("force_model", &O::force_model, ForceMotion::kRhythm),
                                      field("estimate_stiffness", &O::estimate_stiffness),
                                      field("free_torsion", &O::free_torsion),
                                      field("estimate_precurvature", &O::estimate_precurvature),
                                      field("consider_uncertainty", &O::consider_uncertainty),
                                      field("stiffness_rate_per_s", &O::stiffness_rate_per_s),
                                      field("stiffness_drift_per_sqrt_s", &O::stiffness_drift_per_sqrt_s),
                                      field("precurvature_drift_per_m_sqrt_s", &O::precurvature_drift_per_m_sqrt_s),
                                      field("force_rate_N_per_sqrt_s", &O::force_rate_N_per_sqrt_s),
                                      field("force_acceleration_N_per_s_sqrt_s", &O::force_acceleration_N_per_s_sqrt_s),
                                      field("force_memory_s", &O::force_memory_s),
                                      field("initial_force_sigma_N", &O::initial_force_sigma_N),
                                      field("max_iterations", &O::max_iterations),
                                      field("adaptation_window", &O::adaptation_window),
                                      field("outlier_probability", &O::outlier_probability),
                                      field("jump_probability", &O::jump_probability),
                                      field("noise_tail_degrees", &O::noise_tail_degrees),
                                      field("disturbance_rms_N", &O::disturbance_rms_N),
                                      field("disturbance_memory_s", &O::disturbance_memory_s),
                                      field("forecast_s", &O::forecast_s),
                                      field("smoothing_lag_frames", &O::smoothing_lag_frames),
                                      field("report_convergence_index", &O::report_convergence_index)};
  return all;
}

const Field& find_field(const std::string& name) {
  std::vector<std::string_view> known;
  for (const Field& one : fields()) {
    if (one.name == name) return one;
    known.push_back(one.name);
  }
  throw InputError(fmt::format("option '{}': expected one of {}; is '{}' meant?", printable(name),
                               fmt::join(known, ", "), nearest_name(name, known)));
}

}  // namespace

void set_options(const py::dict& values, ObserverOptions& options) {
  for (const auto& [key, value] : values) {
    const std::string name = word(key, "option");
    if (name != "state") {
      find_field(name).set(value, options);
      continue;
    }
    std::vector<std::string> names;
    if (!py::isinstance<py::sequence>(value) || py::isinstance<py::str>(value))
      throw InputError("state: expected a list of words, as in [\"force\", \"stiffness\"]");
    for (const py::handle one : value) names.push_back(word(one, "state"));
    if (!choose_state(names, options))
      throw InputError(
          fmt::format("state = {}: expected \"force\", to which \"stiffness\" and \"precurvature\" may be "
                      "added",
                      names));
  }
  options.validate();
}

py::dict as_dict(const ObserverOptions& options) {
  py::dict out;
  for (const Field& one : fields()) out[py::str(std::string(one.name))] = one.get(options);
  return out;
}

}  // namespace palpate::python
