// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>
#include <palpate/simulation/bias_field.hpp>
#include <random>

namespace palpate {

namespace {

constexpr std::size_t kWaves = 64;  // of a component

}  // namespace

BiasField::BiasField(double rms, double length_m, std::uint64_t seed)
    : amplitude_(rms * std::sqrt(2.0 / (3.0 * static_cast<double>(kWaves)))) {
  if (rms == 0.0) return;
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> per_m(0.0, 1.0 / length_m);
  std::uniform_real_distribution<double> phase(0.0, 2.0 * std::numbers::pi);
  waves_.resize(3 * kWaves);
  for (Wave& wave : waves_) {
    for (double& component : wave.per_m) component = per_m(engine);
    wave.phase_rad = phase(engine);
  }
}

Vector3d BiasField::at(const Vector3d& position_m) const {
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 0; i < waves_.size(); ++i)
    sum(static_cast<Eigen::Index>(i / kWaves)) += std::cos(waves_[i].per_m.dot(position_m) + waves_[i].phase_rad);
  return amplitude_ * sum;
}

}  // namespace palpate
