// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <iostream>
#include <palpate/evaluation/force_average.hpp>
#include <palpate/identification/tare.hpp>
#include <palpate/observer/force_observer.hpp>
#include <palpate/recording/catheter_file.hpp>
#include <palpate/recording/tracker_recording.hpp>
#include <tests/shared_data.hpp>

namespace palpate {
namespace {

struct Load {
  double along_gravity_N = 0.0, sigma_N = 0.0;
};

/// What `palpate estimate --average` does over the last 100 frames (docs/howto/soft_beam.md).
Load load_of(const char* run) {
  const CatheterFile file = read_catheter_file(PALPATE_SOURCE_DIR "/examples/soft_beam/soft_beam.toml");
  const ReferenceInterval& reference = file.reference;
  TrackerRecording recording = read_tracker_recording(test::shared_data("data/soft_beam") / run,
                                                      {&file.catheter, reference.from_s, reference.to_s});
  bind_to_catheter(recording, file.catheter);
  const Tare found = tare(file.catheter, recording.frames, {reference.from_s, reference.to_s, reference.straight});
  ForceObserver observer(found.catheter, file.observer);
  const std::size_t last_100 = recording.frames.size() - 100;
  ForceAverage average(recording.frames[last_100].time_s, recording.frames.back().time_s);
  for (const TrackerFrame& frame : recording.frames) average.add(observer.update(frame));
  EXPECT_EQ(average.frames(), 100);
  const Vector3d down = found.catheter.rod.distributed_load_base_N_per_m.normalized();
  const Load load{down.dot(average.force_base_N()), std::sqrt(down.dot(average.covariance_base_N2() * down))};
  std::cout << run << ": " << load.along_gravity_N << " N along gravity, sigma " << load.sigma_N << " N\n";
  return load;
}

TEST(SoftBeam, UnloadedBeamShowsNoLoad) {
  PALPATE_NEEDS_SHARED("data/soft_beam");
  EXPECT_NEAR(load_of("beam_gravity_V2_a.csv").along_gravity_N, 0.0, 0.05);
}

TEST(SoftBeam, HalfANewtonIsFoundWithin12Percent) {
  PALPATE_NEEDS_SHARED("data/soft_beam");
  EXPECT_NEAR(load_of("beam_load52_V2_a.csv").along_gravity_N, 0.51012, 0.12 * 0.51012);
}

TEST(SoftBeam, OneNewtonIsFoundWithin12Percent) {
  PALPATE_NEEDS_SHARED("data/soft_beam");
  EXPECT_NEAR(load_of("beam_load101_V2_a.csv").along_gravity_N, 1.00062, 0.12 * 1.00062);
}

}  // namespace
}  // namespace palpate
