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

Matrix3d map_times(const ComponentRow& map, const MotionGain& columns) {
  Matrix3d out = Matrix3d::Zero();
  for (Eigen::Index c = 0; c < map.size(); ++c) out += map(c) * columns.middleRows<3>(3 * c);
  return out;
}

ForceGaussian force_of(const ComponentRow& map, const MotionState& state) {
  const Matrix3d P = map_times(map, times_map(state.covariance, map));
  return {force_mean(map, state.mean), 0.5 * (P + P.transpose())};
}

ForceCorrection ForceCorrection::none(const ComponentRow& seen) {
  ForceCorrection out;
  out.seen_covariance.compute(Matrix3d::Identity());
  out.gain.setZero(3 * seen.size(), 3);
  out.seen = seen;
  return out;
}

bool condition(const ComponentRow& seen, const ForceGaussian& posterior, MotionState& state,
               ForceCorrection& correction) {
  const MotionGain PH = times_map(state.covariance, seen);
  const Matrix3d HPH = map_times(seen, PH), S = 0.5 * (HPH + HPH.transpose());
  correction.seen = seen;
  correction.seen_covariance.compute(S);
  if (correction.seen_covariance.info() != Eigen::Success) return false;
  correction.gain = correction.seen_covariance.solve(PH.transpose()).transpose();
  correction.shift_N = posterior.mean_N - force_mean(seen, state.mean);
  correction.change_N2 = posterior.covariance_N2 - S;

  const MotionGain KD = correction.gain * correction.change_N2;
  MotionMatrix P = state.covariance;
  P.noalias() += KD.lazyProduct(correction.gain.transpose());
  P = (0.5 * (P + P.transpose())).eval();
  // Written so that NaN is refused as well. A component known exactly may keep its zero.
  const bool sound = ((P.diagonal().array() > 0.0) || (state.covariance.diagonal().array() == 0.0)).all();
  if (!sound || !correction.shift_N.allFinite()) return false;
  state.mean += correction.gain * correction.shift_N;
  state.covariance = P;
  return true;
}

}  // namespace palpate
