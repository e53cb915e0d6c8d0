// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <palpate/estimation/motion_model.hpp>

namespace palpate::test {

inline constexpr std::array kEveryMotion{ForceMotion::kRandomWalk, ForceMotion::kConstantVelocity,
                                         ForceMotion::kGaussMarkov, ForceMotion::kRhythm};

inline const char* name_of(ForceMotion motion) {
  constexpr std::array names{"walk", "velocity", "gauss_markov", "rhythm"};
  return names[static_cast<std::size_t>(motion)];
}

}  // namespace palpate::test
