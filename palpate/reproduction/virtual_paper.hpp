// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/reproduction/paper_catheter.hpp>
#include <palpate/reproduction/paper_filter.hpp>
#include <vector>

/// The paper's simulations: a force course, exact measurements of it, a filter run over them.
namespace palpate::reproduction {

/// Force over time in tip components, and what the sensors see of it, noise-free.
struct Course {
  std::vector<Vector3d> force_tip_N;
  std::vector<Measurement> data;

  std::size_t size() const { return data.size(); }
};

/// Figure 3: 100 steps of (0.05, 0.05, 0.1) N sin(2 pi t + (0, 90, 180) deg), then 50 of the constant
/// (0.05, -0.05, -0.1) N. Amplitudes, phases, frequency and length are our reading: the figure cannot be digitised.
Course figure3_course(const Catheter& catheter);
/// Section 4.3: Fx = 0.1 sin(2 pi t), nothing else, `steps` samples.
Course sine_course(const Catheter& catheter, int steps = 150);

/// How a filter begins.
struct Start {
  Vector3d force_tip_N = Vector3d::Zero();
  /// IAEKF alone: samples of the first force, at rest, on which R is adapted before step 0 ("when the filters are tuned
  /// initially", section 4.1); 0: a cold start.
  int tuning_samples = 0;
  double stiffness_factor = 1.0;  ///< CFSE: of EI1, EI2, over the catheter's
  double stiffness_sigma = 0.0;   ///< CFSE: of the start, a share of it; 0: that of Q
};
inline constexpr int kTuningSamples = 150;  ///< ten windows, 10 s

/// What a filter made of a course, step by step.
struct Run {
  std::vector<Vector3d> error_N;               ///< estimated minus true
  std::vector<Eigen::Vector2d> stiffness_Nm2;  ///< CFSE: as estimated
  std::vector<double> rho, rho_normalised;
  std::vector<PaperNoise> R;
  std::vector<double> seconds;  ///< an update
  int unconverged = 0;          ///< updates whose last step was not below the tolerance
  double evaluations = 0.0;     ///< of the model, mean an update
};
Run run_filter(const Catheter& catheter, const PaperOptions& options, const Course& course, const Start& start = {});

struct Statistics {
  Vector3d max_abs, mean, std, rmse;
};
/// Of the steps from `first` on.
Statistics statistics(const std::vector<Vector3d>& errors_N, std::size_t first = 0);
double median(std::vector<double> values);

/// The error that Q and R force on the filter where the data are exact and h is a straight line: with the truth moving
/// by dF a step, e_k = (I - K_k J_k)(e_{k-1} - dF_k), J at the truth. R step by step, as `R` says (one: for all).
std::vector<Vector3d> forced_lag(const Catheter& catheter, const Course& course, double Q_N2,
                                 const std::vector<PaperNoise>& R, const Vector3d& start_N = Vector3d::Zero());

}  // namespace palpate::reproduction
