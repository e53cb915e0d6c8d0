// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <limits>
#include <palpate/estimation/motion_filter.hpp>
#include <tests/random_draws.hpp>
#include <vector>

/// Moving forces whose law is known, and what sensors of known noise would say of them.
namespace palpate::test {

/// map x I3: 3 x n.
inline Eigen::MatrixXd dense_map(const ComponentRow& map) {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(3, 3 * map.size());
  for (Eigen::Index c = 0; c < map.size(); ++c) out.block<3, 3>(0, 3 * c) = map(c) * Matrix3d::Identity();
  return out;
}

/// a x I3: n x n.
inline Eigen::MatrixXd dense_transition(const MotionModel& model, const MotionStep& step) {
  ComponentMatrix a;
  model.transition(step, a);
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(model.states(), model.states());
  for (int r = 0; r < model.components(); ++r)
    for (int c = 0; c < model.components(); ++c) out.block<3, 3>(3 * r, 3 * c) = a(r, c) * Matrix3d::Identity();
  return out;
}

inline Eigen::MatrixXd dense_noise(const MotionModel& model, const MotionStep& step) {
  MotionMatrix Q = MotionMatrix::Zero(model.states(), model.states());
  model.add_noise(step, Q);
  return Q;
}

/// A draw from N(0, P), P possibly semidefinite.
inline Eigen::VectorXd draw(const Eigen::MatrixXd& P, Draws& draws) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> spectrum(P);
  const Eigen::VectorXd sigma = spectrum.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  return spectrum.eigenvectors() *
         sigma.cwiseProduct(Eigen::VectorXd::NullaryExpr(P.rows(), [&] { return draws.normal(); }));
}

/// As the tip frame's: sigmas of 0.5, 4 and 9 mN along axes that are turned a little, so that the errors are
/// correlated.
inline Matrix3d tip_noise_N2() {
  const Matrix3d turn = Draws::turn(Vector3d(0.01, 0.02, 0.7));
  return turn * Vector3d(0.5e-3, 4e-3, 9e-3).cwiseAbs2().asDiagonal() * turn.transpose();
}

/// The frame that measures `force_N` with noise of covariance R.
inline ForceLikelihood measure(const Vector3d& force_N, const Matrix3d& R, Draws& draws) {
  ForceLikelihood out;
  out.information_per_N2 = R.inverse();
  out.information_mean_per_N = out.information_per_N2 * (force_N + Vector3d(draw(R, draws)));
  return out;
}

/// The truth of a model's law: its state moves as the model says.
class DrawnMotion {
 public:
  DrawnMotion(const MotionModel& model, Draws& draws) : model_(model), draws_(draws) {
    state_ = Eigen::VectorXd::Zero(model.states());
  }
  void advance(const MotionStep& step) {
    state_ = dense_transition(model_, step) * state_ + draw(dense_noise(model_, step), draws_);
  }
  Vector3d seen_N() const { return dense_map(model_.seen()) * state_; }
  Vector3d reported_N() const { return dense_map(model_.reported()) * state_; }

 private:
  const MotionModel& model_;
  Draws& draws_;
  Eigen::VectorXd state_;
};

inline Rhythm some_rhythm() {
  Rhythm out;
  out.heart_Hz = 1.3;
  out.breathing_Hz = 0.3;
  out.heart_sigma_N = {Vector3d(0.01, 0.02, 0.04), Vector3d(0.01, 0.01, 0.02), Vector3d(0.002, 0.003, 0.01)};
  out.breathing_sigma_N = {Vector3d(0.03, 0.01, 0.02), Vector3d(0.01, 0.01, 0.01)};
  return out;
}

/// Every law, with and without disturbance, at its usual and at extreme memories.
inline std::vector<MotionOptions> all_motions() {
  std::vector<MotionOptions> out;
  for (const ForceMotion motion :
       {ForceMotion::kRandomWalk, ForceMotion::kConstantVelocity, ForceMotion::kGaussMarkov, ForceMotion::kRhythm})
    for (const double disturbance_N : {0.0, 0.02}) {
      MotionOptions options;
      options.motion = motion;
      options.disturbance_rms_N = disturbance_N * Vector3d(1.0, 2.0, 0.5);
      out.push_back(options);
    }
  out.push_back(out[2]);
  out.back().rate_memory_s = std::numeric_limits<double>::infinity();
  return out;
}

}  // namespace palpate::test
