// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/simulation/random_stream.hpp>
#include <palpate/simulation/scenario.hpp>
#include <vector>

namespace palpate {

/// How far a beating heart moves its wall, along the wall's normal (towards the catheter) from where it rests. Beat i,
/// of length T_i and size A_i, from its start t_i:
///
///   x = A_i (1 - cos(2 pi (t - t_i) / T_i)) / 2 ,   T_i = T exp(s_T n - s_T^2 / 2), A_i likewise
///
/// log-normal draws, whose means are T and A and whose standard deviations are the stated shares of them; so no beat
/// has a length or a size below zero. Beats are drawn in order: the motion is the same at any frame rate.
class Heartbeat {
 public:
  Heartbeat(const WallLoad::Heart& heart, std::uint64_t seed);

  /// Displacement [m] at a time >= 0. The first beat starts at 0. Allocates where new beats are drawn.
  double at(double time_s);

 private:
  struct Beat {
    double start_s = 0.0, length_s = 0.0, size_m = 0.0;
  };
  void draw_next_beat();

  WallLoad::Heart heart_;
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
  std::vector<Beat> beats_;
};

}  // namespace palpate
