// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <palpate/math/units.hpp>
#include <palpate/recording/catheter_shaft.hpp>

namespace palpate {
namespace {

using Eigen::Vector2d;

constexpr double kJointTolerance_mm = 1e-6;
constexpr NumberRange kLength = {1.0, 5000.0, "a length in mm, 1..5000 (is it in metres?)"};
constexpr NumberRange kPositive = {1e-300, 1e300, "a number more than 0"};
constexpr NumberRange kModulus = {1e3, 1e13, "a modulus in Pa, 1e3..1e13 (is it in MPa or GPa?)"};
constexpr NumberRange kDiameter = {0.05, 200.0, "a diameter in mm, 0.05..200 (is it in metres?)"};
constexpr NumberRange kPoisson = {-0.99, 0.5, "Poisson's ratio, -0.99..0.5"};
constexpr NumberRange kPercent = {0.0, 100.0, "percent, 0..100"};
constexpr NumberRange kCorrelation = {0.0, 0.999, "a correlation, 0..0.999"};
constexpr NumberRange kCurvature = {-1000.0, 1000.0, "a curvature in 1/m, at most 1000"};
constexpr NumberRange kCurvatureSigma = {0.0, 1000.0, "a standard deviation in 1/m, 0..1000"};
constexpr NumberRange kStretch = {0.0, 1e12, "a stiffness in N, 0 or more"};
constexpr NumberRange kWeight = {0.0, 1000.0, "a weight in N/m, 0..1000"};
constexpr NumberRange kRigidTip = {0.0, 500.0, "a length in mm, 0..500"};
constexpr NumberRange kOffset = {-500.0, 500.0, "a length in mm, at most 500"};
constexpr NumberRange kAny = {-1e300, 1e300, "a number"};

/// What the shaft is made of where nothing else is said.
struct ShaftMaterial {
  std::optional<Vector2d> bending_Nm2;
  std::optional<double> torsional_Nm2;
  std::optional<double> poisson_ratio;
  Vector3d precurvature_per_m = Vector3d::Zero();
};

/// A stiffness given in N mm^2 is a million times too large: compared with the length it shows.
void check_magnitude(const TomlTable& table, std::string_view key, double stiffness_Nm2, double length_m) {
  const double force_N = stiffness_Nm2 / (length_m * length_m);
  if (force_N >= 1e-5 && force_N <= 1e4) return;
  table.refuse(key,
               fmt::format("a stiffness in N m^2 with stiffness / length^2 in 1e-5..1e4 N, here {:.3g} N (is it in "
                           "N mm^2?)",
                           force_N));
}

std::optional<Vector2d> read_bending(const TomlTable& table, double length_m) {
  const auto bending = table.optional_vector<2>("bending_stiffness_Nm2", kPositive);
  if (!bending) return std::nullopt;
  for (const double EI_Nm2 : *bending) check_magnitude(table, "bending_stiffness_Nm2", EI_Nm2, length_m);
  return bending;
}

std::optional<double> read_torsional(const TomlTable& table, double length_m) {
  const auto torsional = table.optional_number("torsional_stiffness_Nm2", kPositive);
  if (torsional) check_magnitude(table, "torsional_stiffness_Nm2", *torsional, length_m);
  return torsional;
}

void read_round_shaft(const TomlTable& table, double length_m, ShaftMaterial& material) {
  for (const char* key : {"bending_stiffness_Nm2", "torsional_stiffness_Nm2"}) {
    if (table.has(key)) table.refuse(key, "either this, or youngs_modulus_Pa with diameter_mm and poisson_ratio");
  }
  if (!material.poisson_ratio) table.refuse("poisson_ratio", kPoisson.expectation);
  const double diameter_m = table.number("diameter_mm", kDiameter) * kMetresPerMillimetre;
  const Stiffness stiffness =
      round_shaft_stiffness(table.number("youngs_modulus_Pa", kModulus), diameter_m, *material.poisson_ratio);
  check_magnitude(table, "youngs_modulus_Pa", stiffness.x(), length_m);
  material.bending_Nm2 = stiffness.head<2>();
}

ShaftMaterial read_material(const TomlTable& table, double length_m) {
  ShaftMaterial material;
  material.precurvature_per_m = table.optional_vector<3>("precurvature_per_m", kCurvature).value_or(Vector3d::Zero());
  material.poisson_ratio = table.optional_number("poisson_ratio", kPoisson);
  if (table.has("youngs_modulus_Pa") || table.has("diameter_mm")) {
    read_round_shaft(table, length_m, material);
    return material;
  }
  material.bending_Nm2 = read_bending(table, length_m);
  material.torsional_Nm2 = read_torsional(table, length_m);
  if (material.torsional_Nm2 && material.poisson_ratio) {
    table.refuse("poisson_ratio", "either this or torsional_stiffness_Nm2, not both");
  }
  return material;
}

Stiffness resolve_stiffness(const TomlTable& table, const ShaftMaterial& material) {
  if (!material.bending_Nm2) {
    table.refuse("bending_stiffness_Nm2", "[EI1, EI2] in N m^2, or youngs_modulus_Pa, diameter_mm and poisson_ratio");
  }
  const Vector2d& EI = *material.bending_Nm2;
  if (material.torsional_Nm2) return {EI.x(), EI.y(), *material.torsional_Nm2};
  if (!material.poisson_ratio) table.refuse("torsional_stiffness_Nm2", "GJ in N m^2, or poisson_ratio");
  return {EI.x(), EI.y(), torsional_stiffness_Nm2(EI.x(), EI.y(), *material.poisson_ratio)};
}

Section plain_section(const TomlTable& table, const ShaftMaterial& material, double from_mm, double to_mm) {
  Section section;
  section.from_m = from_mm * kMetresPerMillimetre;
  section.to_m = to_mm * kMetresPerMillimetre;
  section.stiffness_Nm2 = resolve_stiffness(table, material);
  section.precurvature_per_m = material.precurvature_per_m;
  return section;
}

/// Keys absent in the section are those of the whole catheter.
Section read_section(const TomlTable& table, ShaftMaterial material, double from_mm, double to_mm, double length_m) {
  if (const auto k = table.optional_vector<3>("precurvature_per_m", kCurvature)) material.precurvature_per_m = *k;
  if (const auto bending = read_bending(table, length_m)) material.bending_Nm2 = bending;
  if (const auto torsional = read_torsional(table, length_m)) material.torsional_Nm2 = torsional;
  if (!table.flag("rigid", false)) return plain_section(table, material, from_mm, to_mm);
  Section section;
  section.from_m = from_mm * kMetresPerMillimetre;
  section.to_m = to_mm * kMetresPerMillimetre;
  section.precurvature_per_m = material.precurvature_per_m;
  section.rigid = true;
  return section;
}

/// [0, length] in order; a stretch without a section is made of the catheter's own material.
std::vector<Section> read_sections(const TomlTable& table, const ShaftMaterial& material, double length_mm) {
  const double length_m = length_mm * kMetresPerMillimetre;
  std::vector<Section> sections;
  double end_mm = 0.0;
  for (const TomlTable& entry : table.tables("section", {"from_mm", "to_mm", "bending_stiffness_Nm2",
                                                         "torsional_stiffness_Nm2", "precurvature_per_m", "rigid"})) {
    double from_mm = entry.number("from_mm", kAny);
    double to_mm = entry.number("to_mm", kAny);
    if (from_mm < end_mm - kJointTolerance_mm) {
      entry.refuse("from_mm", fmt::format("{} or more, where the section before ends (in mm)", end_mm));
    }
    if (!(to_mm > from_mm && to_mm <= length_mm + kJointTolerance_mm)) {
      entry.refuse("to_mm", fmt::format("more than from_mm, at most length_mm = {}", length_mm));
    }
    if (from_mm > end_mm + kJointTolerance_mm) sections.push_back(plain_section(table, material, end_mm, from_mm));
    if (from_mm <= end_mm + kJointTolerance_mm) from_mm = end_mm;
    if (to_mm >= length_mm - kJointTolerance_mm) to_mm = length_mm;
    sections.push_back(read_section(entry, material, from_mm, to_mm, length_m));
    end_mm = to_mm;
  }
  if (end_mm < length_mm) sections.push_back(plain_section(table, material, end_mm, length_mm));
  return sections;
}

void read_shear(const TomlTable& table, Rod& rod) {
  const auto shear = table.optional_number("shear_stiffness_N", kStretch);
  const auto axial = table.optional_number("axial_stiffness_N", kStretch);
  rod.shear_stiffness_N = shear.value_or(0.0);
  rod.axial_stiffness_N = axial.value_or(0.0);
  constexpr std::string_view kBoth = "shear_stiffness_N and axial_stiffness_N both more than 0, or both 0 or absent";
  if ((rod.shear_stiffness_N > 0.0) != (rod.axial_stiffness_N > 0.0)) {
    table.refuse(shear ? "shear_stiffness_N" : "axial_stiffness_N", kBoth);
  }
}

void read_weight(const TomlTable& root, const TomlTable& table, Rod& rod) {
  Vector3d direction = Vector3d::Zero();
  if (const auto gravity = root.table("gravity", {"direction_in_base"})) {
    direction = gravity->optional_vector<3>("direction_in_base", kAny).value_or(Vector3d::Zero());
    if (!(direction.stableNorm() > 1e-6))
      gravity->refuse("direction_in_base", "[x, y, z], a direction in the base frame");
    direction.stableNormalize();
  }
  const double weight_N_per_m = table.number("weight_N_per_m", kWeight, 0.0);
  if (weight_N_per_m > 0.0 && direction.isZero()) {
    root.refuse("gravity", "[gravity] direction_in_base, for catheter.weight_N_per_m is given");
  }
  rod.distributed_load_base_N_per_m = weight_N_per_m * direction;
}

void read_uncertainty(const TomlTable& table, Catheter& catheter) {
  catheter.stiffness_sigma_fraction = 0.01 * table.number("stiffness_sigma_percent", kPercent, 0.0);
  catheter.stiffness_correlation = table.number("stiffness_correlation", kCorrelation, catheter.stiffness_correlation);
  catheter.precurvature_sigma_per_m =
      table.optional_vector<3>("precurvature_sigma_per_m", kCurvatureSigma).value_or(Vector3d::Zero());
}

}  // namespace

void read_shaft(const TomlTable& root, Catheter& catheter) {
  const auto found =
      root.table("catheter", {"name", "length_mm", "bending_stiffness_Nm2", "torsional_stiffness_Nm2", "poisson_ratio",
                              "youngs_modulus_Pa", "diameter_mm", "stiffness_sigma_percent", "stiffness_correlation",
                              "precurvature_per_m", "precurvature_sigma_per_m", "shear_stiffness_N",
                              "axial_stiffness_N", "weight_N_per_m", "rigid_tip_mm", "contact_offset_mm", "section"});
  if (!found) root.refuse("catheter", "a table [catheter]");
  const TomlTable& table = *found;
  catheter.name = table.text("name", "");
  const double length_mm = table.number("length_mm", kLength);
  const ShaftMaterial material = read_material(table, length_mm * kMetresPerMillimetre);
  Rod& rod = catheter.rod;
  rod.sections = read_sections(table, material, length_mm);
  const double rigid_tip_mm = table.number("rigid_tip_mm", kRigidTip, 0.0);
  rod.rigid_tip_m = rigid_tip_mm * kMetresPerMillimetre;
  const Vector3d end_of_tip_mm(0.0, 0.0, rigid_tip_mm);
  rod.contact_offset_m =
      table.optional_vector<3>("contact_offset_mm", kOffset).value_or(end_of_tip_mm) * kMetresPerMillimetre;
  read_shear(table, rod);
  read_weight(root, table, rod);
  read_uncertainty(table, catheter);
}

}  // namespace palpate
