// SPDX-License-Identifier: Apache-2.0
#include <palpate/estimation/motion_state.hpp>

namespace palpate {

Vector3d force_mean(const ComponentRow& map, const MotionVector& mean) {
  Vector3d force = Vector3d::Zero();
  for (Eigen::Index c = 0; c < map.size(); ++c) force += map(c) * mean.segment<3>(3 * c);
  return force;
}

MotionGain times_map(const MotionMatrix& covariance, const ComponentRow& map) {
  MotionGain out = MotionGain::Zero(covariance.rows(), 3);
  for (Eigen::Index c = 0; c < map.size(); ++c)
    if (map(c) != 0.0) out += map(c) * covariance.middleCols<3>(3 * c);
  return out;
}

ForceGaussian force_of(const ComponentRow& map, const MotionState& state) {
  const Matrix3d P = map_times(map, times_map(state.covariance, map));
  return {force_mean(map, state.mean), 0.5 * (P + P.transpose())};
}

}  // namespace palpate
