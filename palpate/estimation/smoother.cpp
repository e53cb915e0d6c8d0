// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cassert>
#include <palpate/estimation/smoother.hpp>

namespace palpate {
namespace {

void apply_transition_to_gain(const ComponentMatrix& a, MotionGain& X) {
  const MotionGain before = X;
  X.setZero();
  for (Eigen::Index r = 0; r < a.rows(); ++r)
    for (Eigen::Index c = 0; c < a.cols(); ++c)
      if (a(r, c) != 0.0) X.middleRows<3>(3 * r) += a(r, c) * before.middleRows<3>(3 * c);
}

/// One step back: `next` is smoothed, `state` filtered before and smoothed after. False: P- is not positive definite.
bool step_back(const MotionModel& model, const MotionStep& step, const MotionState& next, MotionState& state) {
  MotionState predicted = state;
  model.predict(step, predicted);
  const Eigen::LLT<MotionMatrix> factor(predicted.covariance);
  if (factor.info() != Eigen::Success) return false;
  ComponentMatrix a;
  model.transition(step, a);
  MotionMatrix AP = state.covariance;
  apply_transition(a, AP);
  const MotionMatrix G = factor.solve(AP).transpose();
  state.mean += G * (next.mean - predicted.mean);
  const MotionMatrix change = next.covariance - predicted.covariance;
  const MotionMatrix GD = G * change;
  state.covariance += GD * G.transpose();
  state.covariance = (0.5 * (state.covariance + state.covariance.transpose())).eval();
  return true;
}

}  // namespace

void RecordingSmoother::push(const MotionStep& step, const MotionState& posterior) {
  steps_.push_back(step);
  const Eigen::Index n = posterior.mean.size();
  numbers_.insert(numbers_.end(), posterior.mean.data(), posterior.mean.data() + n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const double* column = posterior.covariance.col(j).data();
    numbers_.insert(numbers_.end(), column + j, column + n);
  }
}

void RecordingSmoother::unpack(std::size_t frame, MotionState& state) const {
  const Eigen::Index n = model_.states();
  const auto stride = static_cast<std::size_t>(n + n * (n + 1) / 2);
  const double* number = numbers_.data() + frame * stride;
  state.mean = Eigen::Map<const Eigen::VectorXd>(number, n);
  number += n;
  state.covariance.resize(n, n);
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = j; i < n; ++i) state.covariance(i, j) = state.covariance(j, i) = *number++;
}

std::vector<ForceGaussian> RecordingSmoother::smooth() const {
  std::vector<ForceGaussian> out(size());
  MotionState next, state;
  for (std::size_t frame = size(); frame-- > 0;) {
    unpack(frame, state);
    if (frame + 1 < size()) step_back(model_, steps_[frame + 1], next, state);
    out[frame] = force_of(model_.reported(), state);
    std::swap(next, state);
  }
  return out;
}

FixedLagSmoother::FixedLagSmoother(const MotionModel& model, int lag)
    : model_(model), slots_(static_cast<std::size_t>(std::max(lag, 1)) + 1) {
  assert(lag >= 1);
}

void FixedLagSmoother::push(const MotionStep& step, const ForceCorrection& correction, const MotionState& posterior) {
  ComponentMatrix a;
  model_.transition(step, a);
  for (int age = 0; age < count_; ++age) {
    Slot& slot = slots_[static_cast<std::size_t>((latest_ + lag() + 1 - age) % (lag() + 1))];
    apply_transition_to_gain(a, slot.cross);
    const Matrix3d HX = map_times(correction.seen, slot.cross);
    const Matrix3d K = correction.seen_covariance.solve(HX).transpose(), KD = K * correction.change_N2;
    slot.force.mean_N += K * correction.shift_N;
    const Matrix3d P = slot.force.covariance_N2 + KD * K.transpose();
    slot.force.covariance_N2 = 0.5 * (P + P.transpose());
    slot.cross += correction.gain * KD.transpose();
  }
  latest_ = count_ == 0 ? 0 : (latest_ + 1) % (lag() + 1);
  count_ = std::min(count_ + 1, lag() + 1);
  Slot& slot = slots_[static_cast<std::size_t>(latest_)];
  slot.force = force_of(model_.reported(), posterior);
  slot.cross = times_map(posterior.covariance, model_.reported());
}

const ForceGaussian& FixedLagSmoother::force(int age) const {
  assert(age >= 0 && age < count_);
  return slots_[static_cast<std::size_t>((latest_ + lag() + 1 - age) % (lag() + 1))].force;
}

}  // namespace palpate
