// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cassert>
#include <palpate/reproduction/experiment_statistics.hpp>
#include <vector>

namespace palpate::reproduction {
namespace {

/// Mean and standard deviation, axis by axis.
ErrorStatistics statistics_of(std::span<const Vector3d> values) {
  assert(values.size() >= 2);
  const auto n = static_cast<double>(values.size());
  ErrorStatistics out;
  for (const Vector3d& v : values) out.mean_N += v / n;
  Vector3d variance = Vector3d::Zero();
  for (const Vector3d& v : values) variance += (v - out.mean_N).cwiseAbs2() / (n - 1.0);
  out.sigma_N = variance.cwiseSqrt();
  return out;
}

}  // namespace

ErrorStatistics error_statistics(std::span<const Vector3d> estimate_N, std::span<const Vector3d> truth_N,
                                 std::size_t first) {
  assert(estimate_N.size() == truth_N.size());
  std::vector<Vector3d> errors;
  for (std::size_t i = first; i < truth_N.size(); ++i) errors.emplace_back(estimate_N[i] - truth_N[i]);
  return statistics_of(errors);
}

Vector3d inside_95(std::span<const Vector3d> estimate_N, std::span<const Vector3d> truth_N,
                   std::span<const Vector3d> sigma_N, std::size_t first) {
  assert(estimate_N.size() == truth_N.size() && sigma_N.size() == truth_N.size());
  constexpr double k95 = 1.96;
  Vector3d inside = Vector3d::Zero();
  for (std::size_t i = first; i < truth_N.size(); ++i)
    inside.array() += ((estimate_N[i] - truth_N[i]).array().abs() <= k95 * sigma_N[i].array()).cast<double>();
  return inside / static_cast<double>(truth_N.size() - first);
}

RepeatStatistics over_repeats(std::span<const ErrorStatistics> repeats) {
  std::vector<Vector3d> means, sigmas;
  for (const ErrorStatistics& r : repeats) {
    means.emplace_back(r.mean_N.cwiseAbs());
    sigmas.push_back(r.sigma_N);
  }
  const ErrorStatistics of_means = statistics_of(means), of_sigmas = statistics_of(sigmas);
  return {of_means.mean_N, of_means.sigma_N, of_sigmas.mean_N, of_sigmas.sigma_N};
}

}  // namespace palpate::reproduction
