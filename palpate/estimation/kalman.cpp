// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <palpate/estimation/kalman.hpp>

namespace palpate::detail {

void DampingRule::accepted(double kept_share) {
  const double s = 2.0 * kept_share - 1.0;
  value *= std::clamp(1.0 - s * s * s, 0.1, 2.0);
  if (value < kNegligible) value = 0.0;
  growth = 2.0;
}

void DampingRule::refused() {
  value = std::max(value, kLeast) * growth;
  growth *= 2.0;
}

void begin(int rows, const Gaussian& prior, Update& out) {
  out.status = UpdateStatus::kFailed;
  out.posterior = prior;
  out.chi_square = out.residual_chi_square = out.surprise = 0.0;
  out.rows = rows;
  out.evaluations = 0;
  out.line.more_noise.resize(0, 0);
}

}  // namespace palpate::detail
