// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/session/catheter_change.hpp>

namespace palpate::session {

namespace {

using nlohmann::json;

template <class Derived>
json numbers(const Eigen::MatrixBase<Derived>& values) {
  json out = json::array();
  for (Eigen::Index column = 0; column < values.cols(); ++column)
    for (Eigen::Index row = 0; row < values.rows(); ++row) out.push_back(values(row, column));
  return out;
}

template <class Matrix>
Matrix matrix(const json& values) {
  Matrix out;
  if (values.size() != static_cast<std::size_t>(out.size())) throw json::other_error::create(0, "length", nullptr);
  for (Eigen::Index i = 0; i < out.size(); ++i) out(i) = values.at(static_cast<std::size_t>(i)).get<double>();
  return out;
}

using Matrix6d = Eigen::Matrix<double, 6, 6>;

json base_json(const BaseRegistration& base) {
  return {{"R_tracker_base", numbers(base.T_tracker_base.R)},
          {"p_tracker_base_m", numbers(base.T_tracker_base.p)},
          {"position_sigma_m", base.position_sigma_m},
          {"rotation_sigma_rad", base.rotation_sigma_rad},
          {"covariance", base.covariance ? numbers(*base.covariance) : json()}};
}

void apply_base(const json& change, BaseRegistration& base) {
  base.T_tracker_base.R = matrix<Matrix3d>(change.at("R_tracker_base"));
  base.T_tracker_base.p = matrix<Vector3d>(change.at("p_tracker_base_m"));
  base.position_sigma_m = change.at("position_sigma_m").get<double>();
  base.rotation_sigma_rad = change.at("rotation_sigma_rad").get<double>();
  base.covariance.reset();
  if (!change.at("covariance").is_null()) base.covariance = matrix<Matrix6d>(change.at("covariance"));
}

}  // namespace

json catheter_change(const Catheter& catheter) {
  json precurvatures = json::array();
  for (const Section& section : catheter.rod.sections) precurvatures.push_back(numbers(section.precurvature_per_m));
  return {{"base", base_json(catheter.base)},
          {"precurvature_per_m", std::move(precurvatures)},
          {"precurvature_sigma_per_m", numbers(catheter.precurvature_sigma_per_m)},
          {"distributed_load_base_N_per_m", numbers(catheter.rod.distributed_load_base_N_per_m)}};
}

void apply_catheter_change(const json& change, Catheter& catheter) {
  try {
    Catheter changed = catheter;
    apply_base(change.at("base"), changed.base);
    const json& precurvatures = change.at("precurvature_per_m");
    if (precurvatures.size() != changed.rod.sections.size())
      throw InputError(fmt::format("precurvature_per_m: {} sections: expected {}", precurvatures.size(),
                                   changed.rod.sections.size()));
    for (std::size_t i = 0; i < precurvatures.size(); ++i)
      changed.rod.sections[i].precurvature_per_m = matrix<Vector3d>(precurvatures[i]);
    changed.precurvature_sigma_per_m = matrix<Vector3d>(change.at("precurvature_sigma_per_m"));
    changed.rod.distributed_load_base_N_per_m = matrix<Vector3d>(change.at("distributed_load_base_N_per_m"));
    catheter = std::move(changed);
  } catch (const json::exception& error) {
    throw InputError(fmt::format("change of the catheter: {}", error.what()));
  }
}

bool apply_event(const LiveRecord& event, CatheterFile& settings) {
  if (event.event != "tare" && event.event != "base") return false;
  const json data = json::parse(event.data, nullptr, false);
  if (!data.is_object() || !data.contains("catheter"))
    throw InputError(fmt::format("event \"{}\": expected JSON with the change of the catheter", event.event));
  apply_catheter_change(data["catheter"], settings.catheter);
  return true;
}

}  // namespace palpate::session
