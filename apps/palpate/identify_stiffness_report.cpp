// SPDX-License-Identifier: Apache-2.0
#include "identify_stiffness_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <palpate/math/units.hpp>

namespace palpate::app {

namespace {

std::string_view unit_of(const std::string& name) {
  if (name == "stiffness scale") return "";
  return name == "shear stiffness" ? "N" : "N m2";
}

std::string_view name_of(StiffnessOptions::Method method) {
  return method == StiffnessOptions::Method::kNelderMead ? "nelder-mead" : "lm";
}

const Stiffness& stiffness_of(const Rod& rod) { return rod.first_flexible().stiffness_Nm2; }

double least_force_N(const LeftOut& left_out) { return std::max(1e-12, 1e-6 * std::abs(left_out.predicted_N)); }

bool is_loaded(const LeftOut& left_out) { return std::abs(left_out.stated_N) > least_force_N(left_out); }

std::string difference(const LeftOut& left_out) {
  const double difference_N = left_out.predicted_N - left_out.stated_N;
  if (!is_loaded(left_out)) return fmt::format("{:+.4f} N", difference_N);
  return fmt::format("{:+.2f} %", 100.0 * difference_N / left_out.stated_N);
}

void print_unknowns(const StiffnessFit& fit) {
  fmt::print("  {:<16}{:>12}        {:>10}   correlation\n", "unknown", "value", "sigma");
  for (std::size_t i = 0; i < fit.unknowns.size(); ++i) {
    const StiffnessUnknown& unknown = fit.unknowns[i];
    const bool told = std::isfinite(unknown.log_sigma);
    fmt::print("  {:<16}{:>12.5g} {:<6} {:>10}  ", unknown.name, unknown.value, unit_of(unknown.name),
               told ? fmt::format("{:.2g} %", 100.0 * unknown.log_sigma) : "not told");
    for (std::size_t j = 0; j <= i; ++j)
      fmt::print(" {:>6.3f}", fit.correlation(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
    fmt::print("\n");
  }
  const Stiffness& K = stiffness_of(fit.rod);
  fmt::print("shaft: EI1 {:.5g}, EI2 {:.5g}, GJ {:.5g} N m2", K.x(), K.y(), K.z());
  if (fit.rod.shears())
    fmt::print("; shear {:.4g} N, axial {:.4g} N", fit.rod.shear_stiffness_N, fit.rod.axial_stiffness_N);
  fmt::print("\n");
}

void print_cases(const StiffnessFit& fit) {
  fmt::print("residuals {:.4f} mm rms", fit.rms_m * kMillimetresPerMetre);
  if (fit.chi_square > 0.0)
    fmt::print("; chi-square {:.1f} at {} degrees of freedom", fit.chi_square, fit.degrees_of_freedom);
  fmt::print("; sigma of a point {:.4f} mm\n  {:<24}{:>7}{:>12}\n", fit.point_sigma_m * kMillimetresPerMetre, "case",
             "points", "rms [mm]");
  for (const StiffnessFit::Case& one : fit.cases)
    fmt::print("  {:<24}{:>7}{:>12.4f}\n", one.name, one.residual_m.size(), one.rms_m * kMillimetresPerMetre);
}

void print_left_out(const std::vector<LeftOut>& left_out) {
  if (left_out.empty()) return;
  fmt::print("each case left out, its load told by its shape and the others' stiffness\n");
  fmt::print("  {:<24}{:>11}{:>15}{:>11}{:>13}\n", "case", "stated [N]", "predicted [N]", "sigma [N]", "difference");
  for (const LeftOut& one : left_out)
    fmt::print("  {:<24}{:>11.4f}{:>15.4f}{:>11.4f}{:>13}\n", one.name, one.stated_N, one.predicted_N, one.sigma_N,
               difference(one));
}

nlohmann::json rows_of(const Eigen::MatrixXd& matrix) {
  nlohmann::json rows = nlohmann::json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    nlohmann::json row = nlohmann::json::array();
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) row.push_back(matrix(i, j));
    rows.push_back(std::move(row));
  }
  return rows;
}

nlohmann::json unknowns_json(const std::vector<StiffnessUnknown>& unknowns) {
  nlohmann::json rows = nlohmann::json::array();
  for (const StiffnessUnknown& unknown : unknowns)
    rows.push_back({{"name", unknown.name},
                    {"value", unknown.value},
                    {"unit", unit_of(unknown.name)},
                    {"sigma_percent", 100.0 * unknown.log_sigma}});
  return rows;
}

nlohmann::json cases_json(const StiffnessReport& report) {
  nlohmann::json rows = nlohmann::json::array();
  for (std::size_t i = 0; i < report.fit.cases.size(); ++i) {
    const StiffnessFit::Case& one = report.fit.cases[i];
    const Vector3d& force_N = report.load_cases[i].force_base_N;
    nlohmann::json residuals = nlohmann::json::array();
    for (const Vector3d& residual_m : one.residual_m) {
      const Vector3d residual_mm = residual_m * kMillimetresPerMetre;
      residuals.push_back({residual_mm.x(), residual_mm.y(), residual_mm.z()});
    }
    rows.push_back({{"name", one.name},
                    {"force_base_N", {force_N.x(), force_N.y(), force_N.z()}},
                    {"rms_mm", one.rms_m * kMillimetresPerMetre},
                    {"residuals_mm", std::move(residuals)}});
  }
  return rows;
}

nlohmann::json left_out_json(const std::vector<LeftOut>& left_out) {
  nlohmann::json rows = nlohmann::json::array();
  for (const LeftOut& one : left_out) {
    const double difference_N = one.predicted_N - one.stated_N;
    nlohmann::json row{{"name", one.name},
                       {"stated_N", one.stated_N},
                       {"predicted_N", one.predicted_N},
                       {"sigma_N", one.sigma_N},
                       {"difference_N", difference_N},
                       {"rms_mm", one.rms_m * kMillimetresPerMetre},
                       {"unknowns", unknowns_json(one.unknowns)}};
    row["difference_percent"] = is_loaded(one) ? nlohmann::json(100.0 * difference_N / one.stated_N) : nullptr;
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

void print_text(const StiffnessReport& report) {
  std::size_t points = 0;
  for (const LoadCase& one : report.load_cases) points += one.points.size();
  fmt::print("stiffness from {} load case{}, {} point{}, {}; {} iterations, {} evaluations of the cost\n",
             report.load_cases.size(), report.load_cases.size() == 1 ? "" : "s", points, points == 1 ? "" : "s",
             name_of(report.options.method), report.fit.iterations, report.fit.cost_evaluations);
  print_unknowns(report.fit);
  print_cases(report.fit);
  print_left_out(report.left_out);
  fmt::print("written: {}, its stiffness +- {:.3g} % with correlation {:.3g}\n", report.out,
             100.0 * report.sigma.fraction, report.sigma.correlation);
}

void print_json(const StiffnessReport& report) {
  const StiffnessFit& fit = report.fit;
  const Stiffness& K = stiffness_of(fit.rod);
  nlohmann::json json{{"catheter", report.catheter},
                      {"cases_file", report.cases},
                      {"written", report.out},
                      {"method", name_of(report.options.method)},
                      {"iterations", fit.iterations},
                      {"evaluations", {{"cost", fit.cost_evaluations}, {"rod", fit.rod_evaluations}}},
                      {"unknowns", unknowns_json(fit.unknowns)},
                      {"correlation", rows_of(fit.correlation)},
                      {"bending_stiffness_Nm2", {K.x(), K.y()}},
                      {"torsional_stiffness_Nm2", K.z()},
                      {"shear_stiffness_N", fit.rod.shear_stiffness_N},
                      {"axial_stiffness_N", fit.rod.axial_stiffness_N},
                      {"stiffness_sigma_percent", 100.0 * report.sigma.fraction},
                      {"stiffness_correlation", report.sigma.correlation},
                      {"rms_mm", fit.rms_m * kMillimetresPerMetre},
                      {"point_sigma_mm", fit.point_sigma_m * kMillimetresPerMetre},
                      {"chi_square", fit.chi_square},
                      {"degrees_of_freedom", fit.degrees_of_freedom},
                      {"cases", cases_json(report)},
                      {"left_out", left_out_json(report.left_out)},
                      {"warnings", report.warnings}};
  fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

}  // namespace palpate::app
