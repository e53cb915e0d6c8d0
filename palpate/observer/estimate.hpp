// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <palpate/estimation/consistency.hpp>
#include <palpate/estimation/force_gaussian.hpp>
#include <palpate/observer/frame_clock.hpp>
#include <palpate/observer/observability.hpp>
#include <palpate/sensing/screening.hpp>
#include <string_view>

namespace palpate {

/// What became of a frame, and of the state.
enum class EstimateStatus : std::uint8_t {
  kUpdated,       ///< the frame was used; state updated
  kReseeded,      ///< used, after the search was restarted elsewhere; state updated
  kAmbiguous,     ///< used; another force explains the frame as well; state updated with the nearer one
  kRejected,      ///< the frame contradicts itself or its time is impossible; state held
  kHeld,          ///< no usable sensor in the frame; state held
  kNotConverged,  ///< no answer within the bounded work; state held
  kStale,         ///< live only: nothing has come for too long
};
inline constexpr std::size_t kEstimateStatuses = 7;

/// "UPDATED", "RESEEDED", ...: the words of the estimate CSV.
std::string_view describe(EstimateStatus status);

/// An earlier force, with what the frames since have said about it.
struct LaggedForce {
  int age_frames = -1;  ///< -1: none yet, or not asked for (ObserverOptions::smoothing_lag_frames)
  double time_s = 0.0;
  ForceGaussian force;  ///< tip axes
};

/// What the observer knows after a frame. Held states carry the predicted force with its grown covariance.
struct Estimate {
  double time_s = 0.0;
  EstimateStatus status = EstimateStatus::kHeld;
  FrameTime time = FrameTime::kFirst;
  Vector3d force_tip_N = Vector3d::Zero();        ///< of the tissue on the tip, axes d1, d2, d3 at the flexible end
  Matrix3d covariance_tip_N2 = Matrix3d::Zero();  ///< of all that is not known exactly, not of the noise alone
  SigmaBudget sigma_by_source_N = zero_budget();  ///< what it is made of
  ShaftEstimate shaft;                            ///< stiffness and precurvature, estimated or stated
  Observability observability;                    ///< of the latest frame that was used
  Vector3d force_base_N = Vector3d::Zero();       ///< the same force in the clamp's frame
  Matrix3d R_base_tip = Matrix3d::Identity();     ///< turns one into the other: R P R^T is the covariance in the base
  unsigned used = 0;                              ///< bit i: Catheter::sensors[i] was used
  int sensors_used = 0;
  double nis = 0.0;              ///< normalised innovation squared, at the posterior's optimum
  int dof = 0;                   ///< its degrees of freedom; 0 where nothing was used
  bool jumped = false;           ///< the prediction was set aside: this frame alone speaks
  ResidualVector innovation;     ///< y (-) h(prediction): rows as sensing/sensor_model.hpp; empty if unused
  int evaluations = 0;           ///< integrations of the rod
  ConvergenceIndex convergence;  ///< where ObserverOptions asks for it
  ForceGaussian forecast;        ///< of the force ObserverOptions::forecast_s from now, tip axes; where asked for
  LaggedForce lagged;            ///< where asked for
  std::array<Rejection, kMaxSensors + 1> rejections{};  ///< of each reading; the base sensor's last
};

}  // namespace palpate
