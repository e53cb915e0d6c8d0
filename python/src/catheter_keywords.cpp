// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <palpate/math/errors.hpp>
#include <palpate/recording/nearest_name.hpp>
#include <palpate/recording/text_table.hpp>

#include "arrays.hpp"
#include "catheter_parts.hpp"

namespace palpate::python {
namespace {

constexpr double kJointTolerance_m = 1e-9;  // as of a catheter file

const std::vector<std::string_view> kKnown{"length_m",
                                           "bending_stiffness_Nm2",
                                           "torsional_stiffness_Nm2",
                                           "poisson_ratio",
                                           "youngs_modulus_Pa",
                                           "diameter_m",
                                           "precurvature_per_m",
                                           "sections",
                                           "shear_stiffness_N",
                                           "axial_stiffness_N",
                                           "rigid_tip_m",
                                           "contact_offset_m",
                                           "distributed_load_base_N_per_m",
                                           "sensors",
                                           "base",
                                           "base_sensor",
                                           "name",
                                           "tendon",
                                           "tendon_offset_m",
                                           "tendon_moment_sigma_fraction",
                                           "stiffness_sigma_fraction",
                                           "stiffness_correlation",
                                           "precurvature_sigma_per_m",
                                           "base_position_sigma_m",
                                           "base_rotation_sigma_rad",
                                           "bias_length_m",
                                           "bias_memory_s",
                                           "ignore_sensors",
                                           "observer_options"};

/// Keywords, each taken by name.
class Keywords {
 public:
  explicit Keywords(const py::kwargs& given) : given_(given) { require_known(given, "Catheter", kKnown); }

  bool has(const char* name) const { return given_.contains(name) && !given_[name].is_none(); }
  py::object required(const char* name, const char* expected = "this keyword") const {
    if (!has(name)) throw py::type_error(fmt::format("{}: not given: expected {}", name, expected));
    return given_[name];
  }
  double number(const char* name) const { return python::number(required(name), name); }
  void put(const char* name, double& out) const {
    if (has(name)) out = number(name);
  }
  void put(const char* name, Vector3d& out) const {
    if (has(name)) out = vector3(given_[name], name);
  }
  void put(const char* name, std::string& out) const {
    if (has(name)) out = word(given_[name], name);
  }
  /// Of a class of ours, or of several of them.
  template <class T>
  void put_object(const char* name, const char* kind, T& out) const {
    if (has(name)) out = object_of<T>(given_[name], name, kind);
  }

 private:
  const py::kwargs& given_;
};

double poisson_ratio(const Keywords& given) {
  const double nu = given.number("poisson_ratio");
  if (!(nu >= -0.99 && nu <= 0.5)) throw InputError(fmt::format("poisson_ratio = {}: expected -0.99 to 0.5", nu));
  return nu;
}

/// Stated, or of a solid round shaft.
Stiffness stiffness(const Keywords& given) {
  if (given.has("youngs_modulus_Pa") || given.has("diameter_m")) {
    for (const char* name : {"bending_stiffness_Nm2", "torsional_stiffness_Nm2"})
      if (given.has(name))
        throw InputError(
            fmt::format("{}: expected either this, or youngs_modulus_Pa with diameter_m and poisson_ratio", name));
    return round_shaft_stiffness(given.number("youngs_modulus_Pa"), given.number("diameter_m"), poisson_ratio(given));
  }
  const Eigen::Vector2d EI = vector2(given.required("bending_stiffness_Nm2"), "bending_stiffness_Nm2");
  if (given.has("poisson_ratio") && given.has("torsional_stiffness_Nm2"))
    throw InputError("poisson_ratio: expected either this or torsional_stiffness_Nm2, not both");
  const double GJ = given.has("poisson_ratio") ? torsional_stiffness_Nm2(EI.x(), EI.y(), poisson_ratio(given))
                                               : given.number("torsional_stiffness_Nm2");
  return {EI.x(), EI.y(), GJ};
}

Section as_told(const ShaftSection& told, Section section) {
  section.rigid = told.rigid;
  if (told.precurvature_per_m) section.precurvature_per_m = *told.precurvature_per_m;
  if (told.bending_stiffness_Nm2) section.stiffness_Nm2.head<2>() = *told.bending_stiffness_Nm2;
  if (told.torsional_stiffness_Nm2) section.stiffness_Nm2.z() = *told.torsional_stiffness_Nm2;
  if (told.rigid) section.stiffness_Nm2.setZero();
  return section;
}

/// [0, length] in order; a stretch of which nothing is told is as the whole.
std::vector<Section> joined(const std::vector<ShaftSection>& told, const Section& whole) {
  std::vector<Section> out;
  double end_m = 0.0;
  const auto stretch = [&](double from_m, double to_m) {
    Section section = whole;
    section.from_m = from_m;
    section.to_m = to_m;
    return section;
  };
  for (std::size_t i = 0; i < told.size(); ++i) {
    const ShaftSection& one = told[i];
    if (!(one.from_m >= end_m - kJointTolerance_m))
      throw InputError(fmt::format("sections[{}].from_m = {}: expected {} or more, where the section before ends", i,
                                   one.from_m, end_m));
    if (!(one.to_m > one.from_m && one.to_m <= whole.to_m + kJointTolerance_m))
      throw InputError(fmt::format("sections[{}].to_m = {}: expected more than from_m, at most length_m = {}", i,
                                   one.to_m, whole.to_m));
    const bool gap = one.from_m > end_m + kJointTolerance_m;
    if (gap) out.push_back(stretch(end_m, one.from_m));
    out.push_back(as_told(
        one, stretch(gap ? one.from_m : end_m, one.to_m >= whole.to_m - kJointTolerance_m ? whole.to_m : one.to_m)));
    end_m = out.back().to_m;
  }
  if (end_m < whole.to_m) out.push_back(stretch(end_m, whole.to_m));
  return out;
}

void put_shaft(const Keywords& given, Catheter& catheter) {
  Section whole{.from_m = 0.0, .to_m = given.number("length_m"), .stiffness_Nm2 = stiffness(given)};
  given.put("precurvature_per_m", whole.precurvature_per_m);
  std::vector<ShaftSection> sections;
  given.put_object("sections", "a list of palpate.Section", sections);
  Rod& rod = catheter.rod;
  if (!(whole.to_m > 0.0)) throw InputError(fmt::format("length_m = {}: expected more than 0", whole.to_m));
  rod.sections = joined(sections, whole);
  given.put("rigid_tip_m", rod.rigid_tip_m);
  rod.contact_offset_m = Vector3d(0.0, 0.0, rod.rigid_tip_m);
  given.put("contact_offset_m", rod.contact_offset_m);
  given.put("shear_stiffness_N", rod.shear_stiffness_N);
  given.put("axial_stiffness_N", rod.axial_stiffness_N);
  given.put("distributed_load_base_N_per_m", rod.distributed_load_base_N_per_m);
}

void put_tendon(const Keywords& given, Tendon& tendon) {
  std::string model;
  given.put("tendon", model);
  tendon.present = given.has("tendon");
  if (tendon.present && model != "couple" && model != "end_moment")
    throw InputError(fmt::format("tendon = '{}': expected couple or end_moment", printable(model)));
  if (model == "end_moment") tendon.model = TendonModel::kEndMoment;
  for (const char* name : {"tendon_offset_m", "tendon_moment_sigma_fraction"})
    if (!tendon.present && given.has(name))
      throw InputError(fmt::format("{}: expected together with tendon, its model", name));
  given.put("tendon_offset_m", tendon.offset_m);
  given.put("tendon_moment_sigma_fraction", tendon.moment_sigma_fraction);
}

void put_base(const Keywords& given, BaseRegistration& base) {
  if (given.has("base") && given.has("base_sensor"))
    throw InputError("base: expected either this, or base_sensor, which measures it");
  given.put_object("base", "palpate.Pose", base.T_tracker_base);
  given.put_object("base_sensor", "palpate.Sensor", base.sensor);
  base.tracked = given.has("base_sensor");
  given.put("base_position_sigma_m", base.position_sigma_m);
  given.put("base_rotation_sigma_rad", base.rotation_sigma_rad);
}

}  // namespace

void require_known(const py::kwargs& given, std::string_view kind, const std::vector<std::string_view>& known) {
  for (const auto& [key, value] : given) {
    const std::string name = word(key, fmt::format("{}: keyword", kind));
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    throw py::type_error(fmt::format("{}: keyword '{}': expected one that its docstring lists; is '{}' meant?", kind,
                                     printable(name), nearest_name(name, known)));
  }
}

CatheterFile catheter_from_keywords(const py::kwargs& kwargs) {
  const Keywords given(kwargs);
  CatheterFile file;
  Catheter& catheter = file.catheter;
  put_shaft(given, catheter);
  put_tendon(given, catheter.tendon);
  given.required("sensors", "a list of palpate.Sensor");
  given.put_object("sensors", "a list of palpate.Sensor", catheter.sensors);
  put_base(given, catheter.base);
  given.put("name", catheter.name);
  given.put("stiffness_sigma_fraction", catheter.stiffness_sigma_fraction);
  given.put("stiffness_correlation", catheter.stiffness_correlation);
  given.put("precurvature_sigma_per_m", catheter.precurvature_sigma_per_m);
  given.put("bias_length_m", catheter.bias_length_m);
  given.put("bias_memory_s", catheter.bias_memory_s);
  if (given.has("ignore_sensors")) file.ignore_sensors = words(given.required("ignore_sensors"), "ignore_sensors");
  if (given.has("observer_options")) {
    const py::object options = given.required("observer_options");
    if (!py::isinstance<py::dict>(options))
      throw py::type_error("observer_options: expected a dict, as of ForceObserver");
    set_options(options, file.observer);
  }
  catheter.validate();
  return file;
}

}  // namespace palpate::python
