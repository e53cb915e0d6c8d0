// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/estimation/belief.hpp>
#include <vector>

namespace palpate {

/// One frame in the light of a whole recording.
struct SmoothedFrame {
  ForceGaussian force;                   ///< of the tissue
  Eigen::VectorXd parameters;            ///< the estimated ones
  Eigen::MatrixXd parameter_covariance;  ///< theirs
  Eigen::MatrixXd force_by_considered;   ///< D [N / unit of p]: how the force would move if a considered parameter did
};

/// Rauch-Tung-Striebel over a whole recording: what the frames to come say about each force.
///
///   x-_(k+1) = A x+_k,  N-_(k+1) = A N+_k A^T + Q,  G = N+_k A^T (N-_(k+1))^-1
///   x^s_k = x+_k + G (x^s_(k+1) - x-_(k+1)),   N^s_k = N+_k + G (N^s_(k+1) - N-_(k+1)) G^T
///   D^s_k = D+_k + G (D^s_(k+1) - A D+_k),     P^s_k = N^s_k + D^s_k C D^s_k^T
///
/// x: motion state and estimated parameters. N: their covariance if the considered parameters were known, D: how they
/// move with them. These are taken as constant while the smoother looks ahead, some tenths of a second for a force.
/// What is drawn anew at every frame counts as noise.
///
/// Stores of each frame its step, x+, half of N+ and D+, from which the rest is computed again: 0.4 kB a frame for
/// constant velocity, 7 kB for a full rhythm, 50 bytes more for each state and considered parameter.
class RecordingSmoother {
 public:
  explicit RecordingSmoother(const MotionModel& model, const ParameterPrior& prior = {});

  /// Frames in time order: the step that led to the frame, as it was used in the end, and the belief after its update.
  void push(const MotionStep& step, const Belief& posterior);

  std::size_t size() const { return steps_.size(); }

  /// Every frame, smoothed. Where a N- is not positive definite, the smoothing starts anew before it: the frame keeps
  /// its filtered estimate. About 4 n^3 operations a frame.
  std::vector<SmoothedFrame> smooth() const;

 private:
  struct State {
    Eigen::VectorXd mean;
    Eigen::MatrixXd noise, by_considered;  ///< N, D
  };
  Eigen::Index states() const { return model_.states() + static_cast<Eigen::Index>(estimated_.size()); }
  void unpack(std::size_t frame, State& state) const;
  bool step_back(const MotionStep& step, const State& next, State& state) const;
  SmoothedFrame report(const State& state) const;

  MotionModel model_;
  ParameterPrior prior_;
  std::vector<int> estimated_, considered_;  ///< parameters by what is done with them; those that last
  Eigen::MatrixXd considered_covariance_;    ///< C
  std::vector<MotionStep> steps_;
  std::vector<double> numbers_;  ///< a frame: x+, the columns of N+'s lower triangle, D+
};

/// The force some frames ago in the light of all frames since: the same numbers as RTS over the data so far, by keeping
/// the covariances X_j of each of the last forces with motion state and parameters of now.
///
///   predict: X_j <- A X_j.   update: L_j = J X_j,  K_j = L_j^T S^-1,  F_j <- F_j + K_j nu,  P_j <- P_j - K_j L_j,
///   X_j <- X_j - K L_j, but for considered parameters X_j - cov(p, nu) K_j^T
///
/// Bounded work, lag x 30 n products a frame; allocates at construction only. Source: state augmentation; Simon,
/// Optimal State Estimation (2006), section 9.3.
class FixedLagSmoother {
 public:
  /// lag: in frames, at least 1.
  FixedLagSmoother(const MotionModel& model, int lag, const ParameterPrior& prior = {});

  /// One frame: the step that led to it, what its update did, the belief after it.
  void push(const MotionStep& step, const Correction& correction, const Belief& posterior);

  int lag() const { return static_cast<int>(slots_.size()) - 1; }
  /// Frames that can be asked for: ages 0 (the latest) to available() - 1, at most lag() + 1.
  int available() const { return count_; }
  /// Force of the tissue `age` frames ago, `now` being the belief last pushed. 0 <= age < available().
  ForceGaussian force(int age, const Belief& now) const;

 private:
  struct Slot {
    ForceGaussian force;
    MotionGain with_motion;           ///< cov(s, F_j): n x 3
    Eigen::MatrixXd with_parameters;  ///< cov(p, F_j): q x 3
  };
  void correct(const Correction& correction, Slot& slot) const;
  Slot& slot(int age) { return slots_[static_cast<std::size_t>((latest_ + lag() + 1 - age) % (lag() + 1))]; }

  MotionModel model_;
  ParameterPrior prior_;
  ComponentRow seen_;
  std::vector<Slot> slots_;  ///< a ring
  int latest_ = 0, count_ = 0;
};

}  // namespace palpate
