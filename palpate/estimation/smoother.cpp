// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <palpate/estimation/smoother.hpp>

namespace palpate {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// a x I3.
MatrixXd every_axis(const ComponentMatrix& a) {
  MatrixXd out = MatrixXd::Zero(3 * a.rows(), 3 * a.cols());
  for (Index r = 0; r < a.rows(); ++r)
    for (Index c = 0; c < a.cols(); ++c) out.block<3, 3>(3 * r, 3 * c).diagonal().setConstant(a(r, c));
  return out;
}

MatrixXd every_axis(const ComponentRow& map) {
  ComponentMatrix a = map;
  return every_axis(a);
}

}  // namespace

RecordingSmoother::RecordingSmoother(const MotionModel& model, const ParameterPrior& prior)
    : model_(model), prior_(prior) {
  for (int i = 0; i < prior.size(); ++i) {
    if (prior.estimated(i)) estimated_.push_back(i);
    if (!prior.estimated(i) && prior.memory_s(i) > 0.0) considered_.push_back(i);
  }
  considered_covariance_ = prior.covariance(considered_, considered_);
}

void RecordingSmoother::push(const MotionStep& step, const Belief& posterior) {
  steps_.push_back(step);
  const Index n = model_.states(), all = states();
  State x{Eigen::VectorXd(all), MatrixXd(all, all), MatrixXd(all, static_cast<Index>(considered_.size()))};
  x.mean << posterior.motion.mean, posterior.parameters(estimated_);
  x.noise.topLeftCorner(n, n) = posterior.motion.covariance;
  x.noise.topRightCorner(n, all - n) = posterior.cross(Eigen::all, estimated_);
  x.noise.bottomLeftCorner(all - n, n) = x.noise.topRightCorner(n, all - n).transpose();
  x.noise.bottomRightCorner(all - n, all - n) = posterior.parameter_covariance(estimated_, estimated_);
  if (!considered_.empty()) {
    MatrixXd P_ec(all, x.by_considered.cols());
    P_ec << posterior.cross(Eigen::all, considered_), posterior.parameter_covariance(estimated_, considered_);
    x.by_considered = considered_covariance_.llt().solve(P_ec.transpose()).transpose();
    x.noise -= x.by_considered * P_ec.transpose();
  }
  numbers_.insert(numbers_.end(), x.mean.data(), x.mean.data() + all);
  for (Index j = 0; j < all; ++j) {
    const double* column = x.noise.col(j).data();
    numbers_.insert(numbers_.end(), column + j, column + all);
  }
  numbers_.insert(numbers_.end(), x.by_considered.data(), x.by_considered.data() + x.by_considered.size());
}

void RecordingSmoother::unpack(std::size_t frame, State& state) const {
  const Index n = states(), considered = static_cast<Index>(considered_.size());
  const auto stride = static_cast<std::size_t>(n + n * (n + 1) / 2 + n * considered);
  const double* number = numbers_.data() + frame * stride;
  state.mean = Eigen::Map<const Eigen::VectorXd>(number, n);
  number += n;
  state.noise.resize(n, n);
  for (Index j = 0; j < n; ++j)
    for (Index i = j; i < n; ++i) state.noise(i, j) = state.noise(j, i) = *number++;
  state.by_considered = Eigen::Map<const MatrixXd>(number, n, considered);
}

/// `next` is smoothed, `state` filtered before and smoothed after. False: N- is not positive definite.
bool RecordingSmoother::step_back(const MotionStep& step, const State& next, State& state) const {
  const Index n = model_.states(), all = states();
  ComponentMatrix a;
  model_.transition(step, a);
  MotionMatrix Q = MotionMatrix::Zero(n, n);
  model_.add_noise(step, Q);
  MatrixXd A = MatrixXd::Zero(all, all), predicted_noise = MatrixXd::Zero(all, all);
  A.topLeftCorner(n, n) = every_axis(a);
  predicted_noise.topLeftCorner(n, n) = Q;
  MatrixXd forget = MatrixXd::Zero(all - n, all - n), wander = MatrixXd::Identity(all - n, all - n);
  for (Index i = 0; i < all - n; ++i) forget(i, i) = std::exp(-step.dt_s / prior_.memory_s(estimated_[i]));
  const MatrixXd C = prior_.covariance(estimated_, estimated_);
  MatrixXd Q_p = C - forget * C * forget;
  for (Index i = 0; i < all - n; ++i) {
    const auto rate = std::find(estimated_.begin(), estimated_.end(), prior_.rate(estimated_[i]));
    if (rate != estimated_.end()) wander(i, rate - estimated_.begin()) = step.dt_s;
  }
  Q_p = (wander * Q_p * wander.transpose()).eval();
  for (Index i = 0; i < all - n; ++i)
    Q_p(i, i) += prior_.drive(estimated_[i]) * prior_.drive(estimated_[i]) * step.dt_s;
  A.bottomRightCorner(all - n, all - n) = wander * forget;
  predicted_noise.bottomRightCorner(all - n, all - n) = Q_p;
  const MatrixXd AN = A * state.noise;
  predicted_noise += AN * A.transpose();
  const Eigen::LLT<MatrixXd> factor(predicted_noise);
  if (factor.info() != Eigen::Success) return false;
  const MatrixXd G = factor.solve(AN).transpose();
  state.mean += G * (next.mean - A * state.mean);
  state.noise += G * (next.noise - predicted_noise) * G.transpose();
  state.noise = (0.5 * (state.noise + state.noise.transpose())).eval();
  state.by_considered += G * (next.by_considered - A * state.by_considered);
  return true;
}

/// F = exp(E p) f: of motion state and estimated parameters, and of those only considered, to first order.
SmoothedFrame RecordingSmoother::report(const State& state) const {
  const Index n = model_.states(), all = states();
  SmoothedFrame out;
  out.parameters = state.mean.tail(all - n);
  MatrixXd by_state = MatrixXd::Zero(3, all);  // dF / dx
  by_state.leftCols(n) = every_axis(model_.reported());
  out.force.mean_N = by_state.leftCols(n) * state.mean.head(n);
  MatrixXd by_considered = MatrixXd::Zero(3, state.by_considered.cols());
  if (prior_.force_exponents.cols() > 0) {
    const MatrixXd E = prior_.force_exponents(Eigen::all, estimated_);
    const Vector3d scale = (E * out.parameters).array().exp();
    out.force.mean_N = scale.cwiseProduct(out.force.mean_N);
    by_state.leftCols(n) = scale.asDiagonal() * by_state.leftCols(n);
    by_state.rightCols(all - n) = out.force.mean_N.asDiagonal() * E;
    by_considered = out.force.mean_N.asDiagonal() * prior_.force_exponents(Eigen::all, considered_);
  }
  out.force_by_considered = by_considered + by_state * state.by_considered;
  const Matrix3d P = by_state * state.noise * by_state.transpose() +
                     out.force_by_considered * considered_covariance_ * out.force_by_considered.transpose();
  out.force.covariance_N2 = 0.5 * (P + P.transpose());
  const MatrixXd D = state.by_considered.bottomRows(all - n);
  out.parameter_covariance =
      state.noise.bottomRightCorner(all - n, all - n) + D * considered_covariance_ * D.transpose();
  return out;
}

std::vector<SmoothedFrame> RecordingSmoother::smooth() const {
  std::vector<SmoothedFrame> out(size());
  State next, state;
  for (std::size_t frame = size(); frame-- > 0;) {
    unpack(frame, state);
    if (frame + 1 < size()) step_back(steps_[frame + 1], next, state);
    out[frame] = report(state);
    std::swap(next, state);
  }
  return out;
}

FixedLagSmoother::FixedLagSmoother(const MotionModel& model, int lag, const ParameterPrior& prior)
    : model_(model), prior_(prior), seen_(model.seen()), slots_(static_cast<std::size_t>(std::max(lag, 1)) + 1) {
  assert(lag >= 1);
  for (Slot& slot : slots_) slot.with_parameters.setZero(prior.size(), 3);
}

void FixedLagSmoother::correct(const Correction& c, Slot& slot) const {
  FrameLine::Rows<3> L = c.by_force * map_times(seen_, slot.with_motion);
  if (prior_.size() > 0) L += c.by_parameters.lazyProduct(slot.with_parameters);
  const FrameLine::Rows<3> K = c.innovation.solve(L);  // transposed
  slot.force.mean_N += K.transpose() * c.shift;
  const Matrix3d P = slot.force.covariance_N2 - K.transpose() * L;
  slot.force.covariance_N2 = 0.5 * (P + P.transpose());
  slot.with_motion -= c.motion_gain.lazyProduct(L);
  slot.with_motion += c.motion_surplus.lazyProduct(K);
  for (Index i = 0; i < prior_.size(); ++i) {
    if (prior_.estimated(i))
      slot.with_parameters.row(i) -= c.parameter_gain.row(i).lazyProduct(L);
    else
      slot.with_parameters.row(i) -= c.parameter_covariance.row(i).lazyProduct(K);
  }
}

void FixedLagSmoother::push(const MotionStep& step, const Correction& correction, const Belief& posterior) {
  ComponentMatrix a;
  model_.transition(step, a);
  for (int age = 0; age < count_; ++age) {
    Slot& past = slot(age);
    apply_transition(a, past.with_motion);
    for (Index i = 0; i < prior_.size(); ++i)
      past.with_parameters.row(i) *= prior_.memory_s(i) > 0.0 ? std::exp(-step.dt_s / prior_.memory_s(i)) : 0.0;
    for (Index i = 0; i < prior_.size(); ++i)
      if (prior_.rate(i) >= 0) past.with_parameters.row(i) += step.dt_s * past.with_parameters.row(prior_.rate(i));
    if (correction.rows > 0) correct(correction, past);
  }
  latest_ = count_ == 0 ? 0 : (latest_ + 1) % (lag() + 1);
  count_ = std::min(count_ + 1, lag() + 1);
  Slot& now = slot(0);
  now.force = force_of(model_.reported(), posterior.motion);
  now.with_motion = times_map(posterior.motion.covariance, model_.reported());
  if (prior_.size() > 0) now.with_parameters = map_times(model_.reported(), posterior.cross).transpose();
}

ForceGaussian FixedLagSmoother::force(int age, const Belief& now) const {
  assert(age >= 0 && age < count_);
  const Slot& slot = slots_[static_cast<std::size_t>((latest_ + lag() + 1 - age) % (lag() + 1))];
  if (prior_.size() == 0) return slot.force;
  return in_newtons(prior_, slot.force, slot.with_parameters.transpose(), now.parameters, now.parameter_covariance);
}

}  // namespace palpate
