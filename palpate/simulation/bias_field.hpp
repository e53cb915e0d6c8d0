// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <palpate/math/rotation.hpp>
#include <vector>

namespace palpate {

/// A smooth random vector field over space, the same at every time: what an electromagnetic tracker is wrong by. Its
/// components are independent, of mean 0, and two places d apart are correlated by exp(-d^2 / 2 l^2):
///
///   b_c(x) = rms / sqrt(3) * sqrt(2 / N) * sum_i cos(w_ci . x + phase_ci),   w ~ N(0, I / l^2), N = 64 waves
///
/// `rms` is that of |b| over many fields; one field, seen over a distance of l, has a value of its own. Random Fourier
/// features of the Gaussian kernel: Rahimi and Recht 2007.
class BiasField {
 public:
  /// `rms` in the unit of the values, 0 for none; `length_m` more than 0. Same seed, same field.
  BiasField(double rms, double length_m, std::uint64_t seed);

  Vector3d at(const Vector3d& position_m) const;

 private:
  struct Wave {
    Vector3d per_m;
    double phase_rad;
  };
  std::vector<Wave> waves_;  ///< three components one behind the other
  double amplitude_;
};

}  // namespace palpate
