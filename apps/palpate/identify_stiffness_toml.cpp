// SPDX-License-Identifier: Apache-2.0
#include "identify_stiffness_toml.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <palpate/math/units.hpp>
#include <palpate/recording/toml_table.hpp>

namespace palpate::app {

namespace {

using Unknowns = StiffnessOptions::Unknowns;

/// d (ln EI1, ln EI2, ln GJ) / d ln of the unknown.
Vector3d effect_of(const std::string& name, Unknowns unknowns, const Stiffness& K) {
  const double EI_Nm2 = K.x() + K.y();
  const bool tied = unknowns == Unknowns::kBending;
  if (name == "EI1") return {1.0, 0.0, tied ? K.x() / EI_Nm2 : 0.0};
  if (name == "EI2") return {0.0, 1.0, tied ? K.y() / EI_Nm2 : 0.0};
  if (name == "GJ") return {0.0, 0.0, 1.0};
  if (name == "stiffness scale") return Vector3d::Ones();
  return Vector3d::Zero();  // the shear stiffness has a sigma of its own, for which a catheter file has no place
}

double mean_correlation(const Matrix3d& covariance) {
  const Vector3d sigma = covariance.diagonal().cwiseSqrt();
  double sum = 0.0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < i; ++j) sum += covariance(i, j) / std::max(sigma(i) * sigma(j), 1e-300);
  return sum / 3.0;
}

std::string how_well(const StiffnessFit& fit, std::initializer_list<std::string_view> names) {
  std::string text = "identified:";
  for (const StiffnessUnknown& unknown : fit.unknowns) {
    if (std::find(names.begin(), names.end(), unknown.name) == names.end()) continue;
    text += std::isfinite(unknown.log_sigma) ? fmt::format(" +- {:.2g} %,", 100.0 * unknown.log_sigma)
                                             : " not told by these loads,";
  }
  return fmt::format("{} {} load case{}", text, fit.cases.size(), fit.cases.size() == 1 ? "" : "s");
}

/// Puts the stiffness of the fitted rod where the file states that of the old one.
class StiffnessEditor {
 public:
  StiffnessEditor(const std::filesystem::path& path, const StiffnessFit& fit) : edit_(path), fit_(fit) {
    parsed_ = parse_toml({.name = edit_.source(), .lines = edit_.lines()});
  }

  TomlEdit finish(const CommonSigma& sigma, bool shears) {
    edit_sections();
    edit_whole_shaft();
    if (shears) {
      edit_.set("catheter", "shear_stiffness_N", toml_number(fit_.rod.shear_stiffness_N), how_shear());
      edit_.set("catheter", "axial_stiffness_N", toml_number(fit_.rod.axial_stiffness_N), how_shear());
    }
    edit_.set("catheter", "stiffness_correlation", toml_number(sigma.correlation, 3), "of EI1, EI2, GJ as identified");
    edit_.set("catheter", "stiffness_sigma_percent", toml_number(100.0 * sigma.fraction, 3),
              "one for EI1, EI2, GJ: no combination of them is claimed better than identified");
    return std::move(edit_);
  }

 private:
  /// Of a shear stiffness, which follows EI1 and EI2 where it is not free.
  std::string how_shear() const {
    const bool own = fit_.unknowns.back().name == "shear stiffness";
    return own ? how_well(fit_, {"shear stiffness"}) : "keeps its share of EI1 + EI2";
  }

  const toml::table* section(std::size_t i) const {
    const toml::array* sections = parsed_["catheter"]["section"].as_array();
    return sections != nullptr && i < sections->size() ? sections->get(i)->as_table() : nullptr;
  }

  /// The rod's section in which the middle of the file's lies.
  const Section& rod_section(const toml::table& entry) const {
    const double middle_m =
        0.5 * kMetresPerMillimetre * (entry["from_mm"].value_or(0.0) + entry["to_mm"].value_or(0.0));
    for (const Section& found : fit_.rod.sections)
      if (middle_m < found.to_m) return found;
    return fit_.rod.sections.back();
  }

  void edit_sections() {
    for (std::size_t i = 0; section(i) != nullptr; ++i) {
      const toml::table& entry = *section(i);
      const bool own = entry.contains("bending_stiffness_Nm2") || entry.contains("torsional_stiffness_Nm2");
      const Section& fitted = rod_section(entry);
      if (!own || fitted.rigid) continue;
      edit_.set("catheter.section", i, "torsional_stiffness_Nm2", toml_number(fitted.stiffness_Nm2.z()), how_GJ());
      edit_.set("catheter.section", i, "bending_stiffness_Nm2",
                toml_array({fitted.stiffness_Nm2.x(), fitted.stiffness_Nm2.y()}), how_EI());
    }
  }

  /// What holds wherever no section says otherwise: the stiffness of the first such stretch, if there is one.
  const Section* plain_stretch() const {
    for (const Section& fitted : fit_.rod.sections) {
      if (fitted.rigid) continue;
      bool own = false;
      for (std::size_t i = 0; section(i) != nullptr; ++i)
        own = own || (&rod_section(*section(i)) == &fitted && (section(i)->contains("bending_stiffness_Nm2") ||
                                                               section(i)->contains("torsional_stiffness_Nm2")));
      if (!own) return &fitted;
    }
    return nullptr;
  }

  void edit_whole_shaft() {
    const Section* fitted = plain_stretch();
    if (fitted == nullptr) return;
    for (const char* key : {"youngs_modulus_Pa", "diameter_mm", "poisson_ratio"}) edit_.remove("catheter", key);
    edit_.set("catheter", "torsional_stiffness_Nm2", toml_number(fitted->stiffness_Nm2.z()), how_GJ());
    edit_.set("catheter", "bending_stiffness_Nm2", toml_array({fitted->stiffness_Nm2.x(), fitted->stiffness_Nm2.y()}),
              how_EI());
  }

  std::string how_EI() const { return how_well(fit_, {"EI1", "EI2", "stiffness scale"}); }
  std::string how_GJ() const {
    const auto names_it = [](const StiffnessUnknown& unknown) {
      return unknown.name == "GJ" || unknown.name == "stiffness scale";
    };
    const bool own = std::any_of(fit_.unknowns.begin(), fit_.unknowns.end(), names_it);
    return own ? how_well(fit_, {"GJ", "stiffness scale"}) : "follows EI1 and EI2";
  }

  TomlEdit edit_;
  const StiffnessFit& fit_;
  toml::table parsed_;
};

}  // namespace

Matrix3d log_stiffness_covariance(const StiffnessFit& fit, Unknowns unknowns, const Catheter& before) {
  const Stiffness& K = fit.rod.first_flexible().stiffness_Nm2;
  const auto count = static_cast<Eigen::Index>(fit.unknowns.size());
  Eigen::MatrixXd covariance = fit.log_covariance;
  Eigen::Matrix3Xd effect(3, count);
  const double stated = before.stiffness_sigma_fraction > 0.0 ? before.stiffness_sigma_fraction : 1.0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const StiffnessUnknown& unknown = fit.unknowns[static_cast<std::size_t>(i)];
    effect.col(i) = effect_of(unknown.name, unknowns, K);
    if (std::isfinite(unknown.log_sigma)) continue;
    covariance.row(i).setZero();
    covariance.col(i).setZero();
    covariance(i, i) = stated * stated;
  }
  return effect * covariance * effect.transpose();
}

CommonSigma common_sigma(const StiffnessFit& fit, Unknowns unknowns, const Catheter& before) {
  const Matrix3d covariance = log_stiffness_covariance(fit, unknowns, before);
  const double c = std::clamp(mean_correlation(covariance), 0.0, 0.999);
  const Matrix3d shape = (1.0 - c) * Matrix3d::Identity() + c * Matrix3d::Ones();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix3d> ratio(covariance, shape, Eigen::EigenvaluesOnly);
  return {.fraction = std::min(1.0, std::sqrt(std::max(0.0, ratio.eigenvalues().maxCoeff()))), .correlation = c};
}

TomlEdit with_identified_stiffness(const std::filesystem::path& catheter_file, const Catheter& before,
                                   const StiffnessFit& fit, Unknowns unknowns) {
  return StiffnessEditor(catheter_file, fit).finish(common_sigma(fit, unknowns, before), before.rod.shears());
}

}  // namespace palpate::app
