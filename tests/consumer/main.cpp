// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <palpate/math/errors.hpp>
#include <palpate/rod/rod.hpp>

/// Ends with 0 when a good rod is accepted and a bad one refused.
int main() {
  const palpate::Stiffness stiffness_Nm2(1e-4, 1e-4, 8e-5);
  palpate::uniform_rod(0.07, stiffness_Nm2, palpate::Vector3d(20.0, 0.0, 0.0)).validate();
  try {
    palpate::uniform_rod(-0.07, stiffness_Nm2, palpate::Vector3d::Zero()).validate();
  } catch (const palpate::InputError& error) {
    std::printf("refused, as it should be: %s\n", error.what());
    return 0;
  }
  std::puts("a rod of negative length was accepted");
  return 1;
}
