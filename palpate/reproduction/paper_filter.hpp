// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <palpate/estimation/adaptation.hpp>
#include <palpate/estimation/consistency.hpp>
#include <palpate/estimation/global_update.hpp>
#include <palpate/sensing/shape_model.hpp>

/// The paper's estimators, Eqs. (9)-(19), as it states them: random walk, R and Q given, EKF, IEKF, IAEKF, with or
/// without the stiffness in the state. Two deviations, argued: the orientation's residual lives on SO(3), for Euler
/// angles are singular inside the paper's own range; and Eq. (19) takes the innovation of the nonlinear h.
namespace palpate::reproduction {

/// Diagonal of R in the order of Eq. (11): position [m^2], orientation [rad^2], curvature and torsion [1/m^2].
using PaperNoise = Eigen::Matrix<double, 9, 1>;

/// Section 4.1. "1 mm^-2" is 1e6 m^-2; the other reading, 1 m^-2, goes in as `curvature_per_m2`.
inline PaperNoise paper_noise(double curvature_per_m2 = 1e6) {
  PaperNoise R;
  R << Vector3d::Constant(1e-6), Vector3d::Constant(0.0012), Vector3d::Constant(curvature_per_m2);
  return R;
}

/// Experiments I and II (a): 1000 R; II (a): its last three entries twice that.
inline PaperNoise experiment_noise(double curvature_factor = 1.0) {
  PaperNoise R = 1000.0 * paper_noise();
  R.tail<3>() *= curvature_factor;
  return R;
}

/// h(X) of Eq. (11) with its Jacobian, Eqs. (12), (13), (15), (16), and the paper's diagonal R. State: F, or
/// (F, EI1, EI2) with GJ / (EI1 + EI2) kept (Poisson's ratio). Meets the filters' SeededModel.
class PaperModel {
 public:
  PaperModel(const Catheter& catheter, bool stiffness, const PaperNoise& noise,
             Accuracy accuracy = Accuracy::kReference);

  /// Of this frame; it must outlive the next calls. Without the second sensor no curvature rows, without the tip none.
  void select(const Measurement& measurement) { shape_.select(measurement, ~0U); }

  int states() const { return stiffness_ ? 5 : 3; }
  int rows() const { return shape_.rows(); }
  void set_noise(const PaperNoise& noise) { noise_ = noise; }
  void noise(ResidualMatrix& R) const { R = noise_.head(rows()).asDiagonal(); }
  bool linearize(const StateVector& x, Linearization& at);
  int block_end(int row) const { return row < 6 ? std::min(6, rows()) : rows(); }
  bool seed(int k, StateVector& x, int& evaluations);

 private:
  StateVector shape_state(const StateVector& x) const;

  bool stiffness_;
  Eigen::Vector2d nominal_Nm2_;
  Eigen::Matrix<double, 3, 2> exponent_;  ///< E: F = exp(E log(EI / EI_0)) f
  PaperNoise noise_;
  ShapeModel shape_;
};

enum class PaperMethod {
  kEkf,    ///< Eq. (17), one step
  kIekf,   ///< section 3.3.1
  kIaekf,  ///< the same, and R of the next step by covariance matching, Eq. (19); Q stays (design: not both)
};

/// How the iteration of IEKF and IAEKF goes.
enum class Iteration {
  kPaper,   ///< `iterations` full Gauss-Newton steps
  kDamped,  ///< Levenberg-Marquardt from the prediction: ours, up to 60 steps
  kGlobal,  ///< the same, and from seeds where its end is implausible
};

struct PaperOptions {
  PaperMethod method = PaperMethod::kIekf;
  Iteration iteration = Iteration::kPaper;
  int iterations = 10;  ///< l_i
  int window = 15;      ///< M
  bool stiffness = false;
  PaperNoise R = paper_noise();
  double Q_N2 = 9e-2;            ///< per axis and step
  double Q_stiffness_Nm2 = 0.0;  ///< N^2 m^4, per stiffness and step; section 4.4: 1e-8
  /// Of R_i / R_i,0 as adapted. The paper names neither a floor nor a prior; a floor keeps S regular.
  NoiseAdaptation::Limits adaptation{.prior_samples = 0.0, .least_ratio = 1e-6, .largest_ratio = 1e4};
  double step_tolerance = 1e-7;  ///< in posterior sigmas: the iteration shall not show in the figures; 0: all l_i steps
  Accuracy accuracy = Accuracy::kReference;
};

/// One time step of the filter.
struct PaperStep {
  Update update;         ///< kFailed: no finite answer; the prediction is kept
  Gaussian prior;        ///< X_{k,k-1}, P_{k,k-1}
  PaperNoise R;          ///< used in this step
  ConvergenceIndex rho;  ///< section 4.2: as printed (mixes units) and normalised; r and J post-fit
};

class PaperFilter {
 public:
  PaperFilter(const Catheter& catheter, const PaperOptions& options);

  /// A force, and where it is a state the catheter's stiffness; P0 = Q.
  Gaussian initial(const Vector3d& force_tip_N) const;
  /// Anew, R as given. Sizes: 3, or 5 with the stiffness.
  void start(const Gaussian& state);
  void start(const Vector3d& force_tip_N) { start(initial(force_tip_N)); }
  /// Another state; R stays as adapted.
  void set_state(const Gaussian& state) { state_ = state; }

  /// Eq. (17) with its iterations and adaptation. A frame without the tip sensor leaves the prediction.
  const PaperStep& update(const Measurement& measurement);

  Vector3d force_tip_N() const { return state_.mean.head<3>(); }
  const Gaussian& state() const { return state_; }
  PaperModel& model() { return model_; }

 private:
  void solve();
  void judge();

  PaperOptions options_;
  Eigen::Vector2d nominal_Nm2_;
  PaperModel model_;
  NoiseAdaptation adaptation_;
  GlobalUpdate search_;
  Gaussian state_;
  PaperStep step_;
};

}  // namespace palpate::reproduction
