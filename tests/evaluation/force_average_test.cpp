// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <palpate/evaluation/force_average.hpp>

namespace palpate {
namespace {

Estimate estimate_at(double time_s, const Vector3d& force_tip_N, unsigned used) {
  Estimate e;
  e.time_s = time_s;
  e.used = used;
  e.R_base_tip << 0, -1, 0, 1, 0, 0, 0, 0, 1;  // a quarter turn about d3: base x is tip -y
  e.force_tip_N = force_tip_N;
  e.force_base_N = e.R_base_tip * force_tip_N;
  e.covariance_tip_N2 = Vector3d(1.0, 4.0, 9.0).asDiagonal();
  return e;
}

TEST(ForceAverage, CountsUpdatedFramesInsideTheStretch) {
  ForceAverage average(1.0, 2.0);
  average.add(estimate_at(0.9, {100, 100, 100}, 3));
  average.add(estimate_at(1.0, {1, 2, 3}, 3));
  average.add(estimate_at(1.5, {100, 100, 100}, 0));
  average.add(estimate_at(2.0, {3, 4, 5}, 1));
  average.add(estimate_at(2.1, {100, 100, 100}, 3));
  ASSERT_EQ(average.frames(), 2);
  EXPECT_EQ(average.force_tip_N(), Vector3d(2, 3, 4));
  EXPECT_EQ(average.force_base_N(), Vector3d(-3, 2, 4));
  EXPECT_EQ(Vector3d(average.covariance_base_N2().diagonal()), Vector3d(4, 1, 9)) << "a frame's, not shrunk";
}

}  // namespace
}  // namespace palpate
