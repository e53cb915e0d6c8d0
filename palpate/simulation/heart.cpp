// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <palpate/simulation/heart.hpp>

namespace palpate {

namespace {

/// Log-normal factor of mean 1 and standard deviation `spread`, from a standard normal draw.
double spread_factor(double spread, double normal) {
  const double variance = std::log1p(spread * spread);
  return std::exp(std::sqrt(variance) * normal - 0.5 * variance);
}

}  // namespace

Heartbeat::Heartbeat(const WallLoad::Heart& heart, std::uint64_t seed)
    : heart_(heart), engine_(random_engine(seed, RandomStream::kHeart)) {}

void Heartbeat::draw_next_beat() {
  const double start_s = beats_.empty() ? 0.0 : beats_.back().start_s + beats_.back().length_s;
  const double length = normal_(engine_), size = normal_(engine_);
  beats_.push_back({.start_s = start_s,
                    .length_s = 60.0 / heart_.beats_per_min * spread_factor(heart_.interval_spread, length),
                    .size_m = heart_.amplitude_m * spread_factor(heart_.size_spread, size)});
}

double Heartbeat::at(double time_s) {
  if (heart_.beats_per_min == 0.0) return 0.0;
  while (beats_.empty() || beats_.back().start_s + beats_.back().length_s <= time_s) draw_next_beat();
  const auto next = std::upper_bound(beats_.begin(), beats_.end(), time_s,
                                     [](double t, const Beat& beat) { return t < beat.start_s; });
  const Beat& beat = *std::prev(next);
  const double phase_rad = 2.0 * std::numbers::pi * (time_s - beat.start_s) / beat.length_s;
  return 0.5 * beat.size_m * (1.0 - std::cos(phase_rad));
}

}  // namespace palpate
