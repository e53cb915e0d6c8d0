// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <palpate/math/units.hpp>
#include <palpate/observer/force_observer.hpp>
#include <palpate/simulation/virtual_tracker.hpp>

namespace {

/// A catheter told in code; palpate::read_catheter_file() reads the same from a file.
palpate::Catheter two_sensor_catheter() {
  palpate::Catheter catheter;
  catheter.rod = palpate::uniform_rod(0.070, {0.2612e-3, 0.16664e-3, 0.1645e-3}, {24.57, 0.0, 0.0});
  catheter.sensors.resize(2);  // poses with the noise of an electromagnetic tracker, where nothing else is said
  catheter.sensors[0].name = "tip";
  catheter.sensors[0].arc_length_m = 0.070;
  catheter.sensors[1].name = "shaft";
  catheter.sensors[1].arc_length_m = 0.0653;
  catheter.stiffness_sigma_fraction = 0.03;
  catheter.precurvature_sigma_per_m = {0.3, 0.3, 0.2};
  return catheter;
}

}  // namespace

/// One frame of two tracker poses in, one force out, with all that makes it uncertain.
int main() {
  using namespace palpate;
  const Catheter catheter = two_sensor_catheter();
  const auto truth_N = [](double /*time_s*/) { return Vector3d(0.02, -0.01, -0.10); };  // tip axes; pressing is -z
  const TrackerFrame frame = simulate_tracker(catheter, truth_N, {.duration_s = 0.05, .seed = 2}).frames.front();

  ForceObserver observer(catheter, {});
  const Estimate estimate = observer.update(frame);
  std::printf("%s, %d of %zu sensors used\n", describe(estimate.status).data(), estimate.sensors_used,
              frame.readings.size());
  const Vector3d sigma_N = estimate.covariance_tip_N2.diagonal().cwiseSqrt();
  for (int axis = 0; axis < 3; ++axis)
    std::printf("F%c = %+6.1f mN +- %4.1f   (true: %+6.1f)\n", "xyz"[axis], 1e3 * estimate.force_tip_N[axis],
                1e3 * sigma_N[axis], 1e3 * truth_N(0.0)[axis]);
  std::printf("|F| = %.1f g\n", kGramsForcePerNewton * estimate.force_tip_N.norm());
  return estimate.status == EstimateStatus::kUpdated || estimate.status == EstimateStatus::kReseeded ? 0 : 1;
}
