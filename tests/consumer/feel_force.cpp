// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <palpate/math/errors.hpp>
#include <palpate/observer/force_observer.hpp>
#include <palpate/simulation/virtual_tracker.hpp>

namespace {

/// 70 mm, bent to 20 1/m, with two sensors.
palpate::Catheter make_catheter() {
  palpate::Catheter catheter;
  catheter.rod = palpate::uniform_rod(0.07, {2.6e-4, 1.7e-4, 1.6e-4}, {20.0, 0.0, 0.0});
  for (const double arc_length_m : {0.07, 0.065}) {
    palpate::Sensor sensor;
    sensor.name = arc_length_m == 0.07 ? "tip" : "shaft";
    sensor.arc_length_m = arc_length_m;
    catheter.sensors.push_back(sensor);
  }
  return catheter;
}

/// True where the force of a virtual recording is found within four sigmas, and those are small.
bool feels_the_force(const palpate::Catheter& catheter) {
  const palpate::Vector3d truth_N(0.02, -0.03, -0.06);
  const auto recording = palpate::simulate_tracker(catheter, [&](double) { return truth_N; }, {.duration_s = 2.0});
  palpate::ForceObserver observer(catheter, {});
  palpate::Estimate now;
  for (const palpate::TrackerFrame& frame : recording.frames) now = observer.update(frame);
  const palpate::Vector3d error_N = now.force_tip_N - truth_N, sigma_N = now.covariance_tip_N2.diagonal().cwiseSqrt();
  std::printf("%s: error (%.1f, %.1f, %.1f) mN, sigma (%.1f, %.1f, %.1f) mN\n", palpate::describe(now.status).data(),
              1e3 * error_N.x(), 1e3 * error_N.y(), 1e3 * error_N.z(), 1e3 * sigma_N.x(), 1e3 * sigma_N.y(),
              1e3 * sigma_N.z());
  return (error_N.cwiseAbs().array() < 4.0 * sigma_N.array()).all() && sigma_N.maxCoeff() < 0.02;
}

/// True where a rod of negative length is refused.
bool refuses_nonsense() {
  try {
    palpate::uniform_rod(-0.07, {1e-4, 1e-4, 8e-5}, palpate::Vector3d::Zero()).validate();
  } catch (const palpate::InputError& error) {
    std::printf("refused, as it should be: %s\n", error.what());
    return true;
  }
  std::puts("a rod of negative length was accepted");
  return false;
}

}  // namespace

/// Links palpate::palpate alone.
int main() { return feels_the_force(make_catheter()) && refuses_nonsense() ? 0 : 1; }
