// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <palpate/math/errors.hpp>
#include <palpate/rod/rod.hpp>

namespace palpate {
namespace {

constexpr double kJointTolerance_m = 1e-12;

std::string show(const Vector3d& v) { return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z()); }

[[noreturn]] void refuse(std::string_view parameter, const std::string& value, std::string_view expectation) {
  throw InputError(fmt::format("rod: {} = {}: expected {}", parameter, value, expectation));
}

void validate_section(const Section& section, std::size_t index, double expected_from_m) {
  const auto name = [&](const char* field) { return fmt::format("sections[{}].{}", index, field); };
  if (!(std::abs(section.from_m - expected_from_m) <= kJointTolerance_m)) {
    refuse(name("from_m"), fmt::format("{}", section.from_m),
           fmt::format("{}, where the section before ends", expected_from_m));
  }
  if (!(section.to_m > section.from_m) || !std::isfinite(section.to_m)) {
    refuse(name("to_m"), fmt::format("{}", section.to_m), fmt::format("more than from_m, {}", section.from_m));
  }
  if (!section.rigid && !((section.stiffness_Nm2.array() > 0.0).all() && section.stiffness_Nm2.allFinite())) {
    refuse(name("stiffness_Nm2"), show(section.stiffness_Nm2), "three positive numbers (EI1, EI2, GJ)");
  }
  if (!section.precurvature_per_m.allFinite()) {
    refuse(name("precurvature_per_m"), show(section.precurvature_per_m), "three finite numbers (k1, k2, tau)");
  }
}

}  // namespace

double torsional_stiffness_Nm2(double EI1_Nm2, double EI2_Nm2, double poisson_ratio) {
  return (EI1_Nm2 + EI2_Nm2) / (2.0 * (1.0 + poisson_ratio));
}

Stiffness round_shaft_stiffness(double youngs_modulus_Pa, double diameter_m, double poisson_ratio) {
  const double EI_Nm2 = youngs_modulus_Pa * std::numbers::pi * std::pow(diameter_m, 4) / 64.0;
  return {EI_Nm2, EI_Nm2, torsional_stiffness_Nm2(EI_Nm2, EI_Nm2, poisson_ratio)};
}

const Section& Rod::first_flexible() const {
  const auto found = std::find_if(sections.begin(), sections.end(), [](const Section& s) { return !s.rigid; });
  return found == sections.end() ? sections.front() : *found;
}

void Rod::validate() const {
  if (sections.empty()) refuse("sections", "[]", "at least one section");
  double end_m = 0.0;
  for (std::size_t i = 0; i < sections.size(); ++i) {
    validate_section(sections[i], i, end_m);
    end_m = sections[i].to_m;
  }
  if (!(rigid_tip_m >= 0.0) || !std::isfinite(rigid_tip_m)) {
    refuse("rigid_tip_m", fmt::format("{}", rigid_tip_m), "0 or more");
  }
  if (!contact_offset_m.allFinite()) refuse("contact_offset_m", show(contact_offset_m), "three finite numbers");
  const bool kirchhoff = shear_stiffness_N == 0.0 && axial_stiffness_N == 0.0;
  const bool cosserat = shear_stiffness_N > 0.0 && axial_stiffness_N > 0.0 && std::isfinite(shear_stiffness_N) &&
                        std::isfinite(axial_stiffness_N);
  if (!kirchhoff && !cosserat) {
    refuse("shear_stiffness_N, axial_stiffness_N", fmt::format("{}, {}", shear_stiffness_N, axial_stiffness_N),
           "both positive, or both 0 for no shear and no stretch");
  }
  if (!distributed_load_base_N_per_m.allFinite()) {
    refuse("distributed_load_base_N_per_m", show(distributed_load_base_N_per_m), "three finite numbers");
  }
}

Rod uniform_rod(double length_m, const Stiffness& stiffness_Nm2, const Vector3d& precurvature_per_m) {
  Rod rod;
  rod.sections.push_back({.from_m = 0.0,
                          .to_m = length_m,
                          .stiffness_Nm2 = stiffness_Nm2,
                          .precurvature_per_m = precurvature_per_m,
                          .rigid = false});
  return rod;
}

}  // namespace palpate
