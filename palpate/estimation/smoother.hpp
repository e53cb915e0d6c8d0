// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/estimation/motion_model.hpp>
#include <vector>

namespace palpate {

/// Rauch-Tung-Striebel over a whole recording: what the frames to come say about each force.
///
///   x-_(k+1) = A x+_k,  P-_(k+1) = A P+_k A^T + Q,  G = P+_k A^T (P-_(k+1))^-1
///   x^s_k = x+_k + G (x^s_(k+1) - x-_(k+1)),   P^s_k = P+_k + G (P^s_(k+1) - P-_(k+1)) G^T
///
/// Stores of each frame its step and the state after it (x+, and half of P+), from which A, x-, P- are computed again:
/// 0.4 kB a frame for constant velocity, 7 kB for a full rhythm.
class RecordingSmoother {
 public:
  explicit RecordingSmoother(const MotionModel& model) : model_(model) {}

  /// Frames in time order: the step that led to the frame, as it was used in the end, and the state after its update.
  void push(const MotionStep& step, const MotionState& posterior);

  std::size_t size() const { return steps_.size(); }

  /// Smoothed force of the tissue of every frame. Where a P- is not positive definite, the smoothing starts anew before
  /// it: the frame keeps its filtered estimate. About 4 n^3 operations a frame.
  std::vector<ForceGaussian> smooth() const;

 private:
  void unpack(std::size_t frame, MotionState& state) const;

  MotionModel model_;
  std::vector<MotionStep> steps_;
  std::vector<double> numbers_;  ///< a frame: x+, then the columns of P+'s lower triangle
};

/// The force some frames ago in the light of all frames since: the same numbers as RTS over the data so far, by keeping
/// the covariance X_j of each of the last forces with the state of now.
///
///   predict: X_j <- X_j A^T.   condition: K_j = X_j H^T S^-1,  F_j <- F_j + K_j (F+ - F-),
///   P_j <- P_j + K_j (P_F+ - S) K_j^T,  X_j <- X_j + K_j (P_F+ - S) K^T
///
/// Bounded work, lag x 30 n products a frame; allocates at construction only. Source: state augmentation; Simon,
/// Optimal State Estimation (2006), section 9.3.
class FixedLagSmoother {
 public:
  /// lag: in frames, at least 1.
  FixedLagSmoother(const MotionModel& model, int lag);

  /// One frame: the step that led to it, what its update did, the state after it.
  void push(const MotionStep& step, const ForceCorrection& correction, const MotionState& posterior);

  int lag() const { return static_cast<int>(slots_.size()) - 1; }
  /// Frames that can be asked for: ages 0 (the latest) to available() - 1, at most lag() + 1.
  int available() const { return count_; }
  /// Force of the tissue `age` frames ago. 0 <= age < available().
  const ForceGaussian& force(int age) const;

 private:
  struct Slot {
    ForceGaussian force;
    MotionGain cross;  ///< X_j^T: n x 3
  };

  MotionModel model_;
  std::vector<Slot> slots_;  ///< a ring
  int latest_ = 0, count_ = 0;
};

}  // namespace palpate
