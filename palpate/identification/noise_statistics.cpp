// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <palpate/identification/noise_statistics.hpp>

namespace palpate {

double quantile(std::vector<double> values, double share) {
  const auto place = std::lround(share * static_cast<double>(values.size() - 1));
  const auto at = values.begin() + place;
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double samples_per_independent(const std::vector<double>& values) {
  const std::size_t n = values.size();
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(n);
  const auto lagged = [&](std::size_t lag) {
    double sum = 0.0;
    for (std::size_t i = lag; i < n; ++i) sum += (values[i] - mean) * (values[i - lag] - mean);
    return sum;
  };
  const double power = lagged(0);
  double samples = 1.0;
  if (!(power > 0.0)) return samples;
  for (std::size_t lag = 1; lag < n / 3 && static_cast<double>(lag) < 1.0 + 2.5 * samples; ++lag)
    samples += 2.0 * lagged(lag) / power;
  return std::max(1.0, samples);
}

double smallest_step(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const double round_off = 1e-12 * std::max(std::abs(values.front()), std::abs(values.back()));
  double step = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double gap = values[i] - values[i - 1];
    if (gap > round_off && (step == 0.0 || gap < step)) step = gap;
  }
  return step;
}

double hidden_quantisation_variance(double step, double observed_variance) {
  if (!(step > 0.0)) return 0.0;
  const double visible = std::max(0.0, observed_variance - step * step / 12.0);
  const double decay = 4.0 * std::numbers::pi * std::numbers::pi * visible / (step * step);
  double sum = 0.0;
  for (int k = 1; k <= 50; ++k) sum += std::exp(-decay * k * k) / (k * k);
  return step * step / (2.0 * std::numbers::pi * std::numbers::pi) * sum;
}

double difference_variance(const std::vector<double>& values, std::size_t lag) {
  if (lag >= values.size()) return 0.0;
  double squares = 0.0;
  for (std::size_t i = lag; i < values.size(); ++i) squares += std::pow(values[i] - values[i - lag], 2);
  return 0.5 * squares / static_cast<double>(values.size() - lag);
}

double allan_variance(const std::vector<double>& values, std::size_t count) {
  std::vector<double> sums{0.0};
  for (const double value : values) sums.push_back(sums.back() + value);
  double squares = 0.0;
  std::size_t pairs = 0;
  for (std::size_t i = 0; i + 2 * count <= values.size(); ++i, ++pairs)
    squares += std::pow(sums[i + 2 * count] - 2.0 * sums[i + count] + sums[i], 2);
  return 0.5 * squares / (static_cast<double>(pairs) * static_cast<double>(count) * static_cast<double>(count));
}

}  // namespace palpate
