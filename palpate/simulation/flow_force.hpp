// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/math/rotation.hpp>
#include <palpate/simulation/random_stream.hpp>
#include <palpate/simulation/scenario.hpp>

namespace palpate {

/// Coloured force of flowing liquid on the tip, tip components: a Gauss-Markov process an axis, started in its
/// stationary state and discretised exactly,
///
///   f_(k+1) = a f_k + rms sqrt(1 - a^2) n ,   a = exp(-dt / memory) .
class FlowForce {
 public:
  FlowForce(const Flow& flow, std::uint64_t seed);

  /// The force [N] after another `step_s`; the first call gives the start. Draws as often whatever the step is.
  Vector3d next(double step_s);

 private:
  Flow flow_;
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
  Vector3d force_N_ = Vector3d::Zero();
  bool started_ = false;
};

}  // namespace palpate
