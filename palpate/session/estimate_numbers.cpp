// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cmath>
#include <palpate/session/estimate_numbers.hpp>

namespace palpate::session {

namespace {

constexpr std::array<std::array<int, 2>, 6> kUpper{{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};

/// One walk over the numbers serves both ways: `visit` reads or writes each.
template <typename EstimateType, typename Visit>
void visit_numbers(EstimateType& e, const Visit& visit) {
  const auto vector = [&](auto& v) {
    for (int i = 0; i < 3; ++i) visit(v(i));
  };
  visit(e.time_s);
  vector(e.force_tip_N);
  for (const auto& [row, column] : kUpper) visit(e.covariance_tip_N2(row, column));
  vector(e.force_base_N);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) visit(e.R_base_tip(row, column));
  visit(e.nis);
  for (auto& source : e.sigma_by_source_N) vector(source);
  vector(e.shaft.stiffness_Nm2);
  vector(e.shaft.stiffness_sigma_Nm2);
  vector(e.shaft.precurvature_per_m);
  vector(e.shaft.precurvature_sigma_per_m);
  vector(e.observability.weakest_force_N);
  vector(e.observability.weakest_log_stiffness);
  vector(e.observability.weakest_precurvature_per_m);
  visit(e.observability.weakest_sigmas);
  visit(e.observability.stiffness_scale_sigma);
  visit(e.observability.stiffness_scale_prior_sigma);
}

template <typename EstimateType, typename Visit>
void visit_extra(EstimateType& e, const Visit& visit) {
  const auto force = [&](auto& gaussian) {
    for (int i = 0; i < 3; ++i) visit(gaussian.mean_N(i));
    for (const auto& [row, column] : kUpper) visit(gaussian.covariance_N2(row, column));
  };
  visit(e.convergence.paper);
  visit(e.convergence.normalised);
  force(e.forecast);
  visit(e.lagged.time_s);
  force(e.lagged.force);
}

void mirror(Matrix3d& covariance) {
  for (const auto& [row, column] : kUpper) covariance(column, row) = covariance(row, column);
}

}  // namespace

const std::array<std::string_view, kEstimateNumbers>& estimate_number_names() {
  static constexpr std::array<std::string_view, kEstimateNumbers> names{"time_s",
                                                                        "fx_tip_N",
                                                                        "fy_tip_N",
                                                                        "fz_tip_N",
                                                                        "cov_xx_N2",
                                                                        "cov_yy_N2",
                                                                        "cov_zz_N2",
                                                                        "cov_xy_N2",
                                                                        "cov_xz_N2",
                                                                        "cov_yz_N2",
                                                                        "fx_base_N",
                                                                        "fy_base_N",
                                                                        "fz_base_N",
                                                                        "R_base_tip_11",
                                                                        "R_base_tip_12",
                                                                        "R_base_tip_13",
                                                                        "R_base_tip_21",
                                                                        "R_base_tip_22",
                                                                        "R_base_tip_23",
                                                                        "R_base_tip_31",
                                                                        "R_base_tip_32",
                                                                        "R_base_tip_33",
                                                                        "nis",
                                                                        "noise_x_N",
                                                                        "noise_y_N",
                                                                        "noise_z_N",
                                                                        "bias_x_N",
                                                                        "bias_y_N",
                                                                        "bias_z_N",
                                                                        "stiffness_x_N",
                                                                        "stiffness_y_N",
                                                                        "stiffness_z_N",
                                                                        "precurvature_x_N",
                                                                        "precurvature_y_N",
                                                                        "precurvature_z_N",
                                                                        "base_x_N",
                                                                        "base_y_N",
                                                                        "base_z_N",
                                                                        "mounting_x_N",
                                                                        "mounting_y_N",
                                                                        "mounting_z_N",
                                                                        "tendon_x_N",
                                                                        "tendon_y_N",
                                                                        "tendon_z_N",
                                                                        "EI1_Nm2",
                                                                        "EI2_Nm2",
                                                                        "GJ_Nm2",
                                                                        "sigma_EI1_Nm2",
                                                                        "sigma_EI2_Nm2",
                                                                        "sigma_GJ_Nm2",
                                                                        "k1_0_per_m",
                                                                        "k2_0_per_m",
                                                                        "tau_0_per_m",
                                                                        "sigma_k1_0_per_m",
                                                                        "sigma_k2_0_per_m",
                                                                        "sigma_tau_0_per_m",
                                                                        "weakest_fx_tip_N",
                                                                        "weakest_fy_tip_N",
                                                                        "weakest_fz_tip_N",
                                                                        "weakest_log_EI1",
                                                                        "weakest_log_EI2",
                                                                        "weakest_log_GJ",
                                                                        "weakest_k1_0_per_m",
                                                                        "weakest_k2_0_per_m",
                                                                        "weakest_tau_0_per_m",
                                                                        "weakest_sigmas",
                                                                        "stiffness_scale_sigma",
                                                                        "stiffness_scale_prior_sigma"};
  return names;
}

const std::array<std::string_view, kExtraNumbers>& extra_number_names() {
  static constexpr std::array<std::string_view, kExtraNumbers> names{
      "convergence_paper",  "convergence_normalised", "forecast_fx_tip_N",  "forecast_fy_tip_N",  "forecast_fz_tip_N",
      "forecast_cov_xx_N2", "forecast_cov_yy_N2",     "forecast_cov_zz_N2", "forecast_cov_xy_N2", "forecast_cov_xz_N2",
      "forecast_cov_yz_N2", "lagged_time_s",          "lagged_fx_tip_N",    "lagged_fy_tip_N",    "lagged_fz_tip_N",
      "lagged_cov_xx_N2",   "lagged_cov_yy_N2",       "lagged_cov_zz_N2",   "lagged_cov_xy_N2",   "lagged_cov_xz_N2",
      "lagged_cov_yz_N2"};
  return names;
}

void numbers_of(const Estimate& estimate, EstimateNumbers& numbers) {
  std::size_t i = 0;
  visit_numbers(estimate, [&](const double& value) { numbers[i++] = value; });
}

void set_numbers(const EstimateNumbers& numbers, Estimate& estimate) {
  std::size_t i = 0;
  visit_numbers(estimate, [&](double& value) { value = numbers[i++]; });
  mirror(estimate.covariance_tip_N2);
}

void extra_numbers_of(const Estimate& estimate, ExtraNumbers& numbers) {
  std::size_t i = 0;
  visit_extra(estimate, [&](const double& value) { numbers[i++] = value; });
}

void set_extra_numbers(const ExtraNumbers& numbers, Estimate& estimate) {
  std::size_t i = 0;
  visit_extra(estimate, [&](double& value) { value = numbers[i++]; });
  mirror(estimate.forecast.covariance_N2);
  mirror(estimate.lagged.force.covariance_N2);
}

bool has_extra(const Estimate& estimate) {
  static const Estimate plain;
  ExtraNumbers numbers{}, none{};
  extra_numbers_of(estimate, numbers);
  extra_numbers_of(plain, none);
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (!same_number(numbers[i], none[i])) return true;
  return estimate.lagged.age_frames != plain.lagged.age_frames;
}

std::int64_t observability_bits(const Observability& o) {
  return (o.axial_force_hidden ? 1 : 0) | (o.shaft_straight ? 2 : 0) | (o.lateral_force_hidden ? 4 : 0) |
         (o.stiffness_rests_on_prior ? 8 : 0) | (o.precurvature_rests_on_prior ? 16 : 0);
}

void set_observability_bits(std::int64_t bits, Observability& o) {
  o.axial_force_hidden = (bits & 1) != 0;
  o.shaft_straight = (bits & 2) != 0;
  o.lateral_force_hidden = (bits & 4) != 0;
  o.stiffness_rests_on_prior = (bits & 8) != 0;
  o.precurvature_rests_on_prior = (bits & 16) != 0;
}

std::int64_t packed_rejections(const Estimate& estimate) {
  std::int64_t packed = 0;
  for (std::size_t i = 0; i < estimate.rejections.size(); ++i)
    packed |= static_cast<std::int64_t>(estimate.rejections[i]) << (4 * i);
  return packed;
}

void set_packed_rejections(std::int64_t packed, Estimate& estimate) {
  for (std::size_t i = 0; i < estimate.rejections.size(); ++i)
    estimate.rejections[i] = static_cast<Rejection>((packed >> (4 * i)) & 15);
}

std::string_view describe(FrameTime verdict) {
  static constexpr std::array<std::string_view, kFrameTimes> words{"first",        "advanced",   "resynchronised",
                                                                   "stands still", "steps back", "not finite"};
  return words[static_cast<std::size_t>(verdict)];
}

bool same_number(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) || (std::isnan(a) && std::isnan(b));
}

}  // namespace palpate::session
