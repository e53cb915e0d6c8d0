// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/estimation/frame_line.hpp>
#include <palpate/estimation/motion_model.hpp>
#include <palpate/math/linearization.hpp>

/// What is believed of a moving force and of the parameters that the sensors' model depends on, and how one frame
/// changes it. Parameters are either estimated or only considered: the latter widen every covariance, but no frame
/// corrects them (Schmidt 1966; Jazwinski 1970, section 8.4).
namespace palpate {

/// Parameters p, zero-mean: p' = -p / memory + w, of spread C where they forget; those that do not may wander, driven
/// by white noise and by another parameter, their rate, p_i' = p_rate(i) + drive_i w.
struct ParameterPrior {
  Eigen::MatrixXd covariance;                       ///< C, q x q: before any frame
  Eigen::VectorXd memory_s;                         ///< inf: constant; 0: drawn anew at every frame
  Eigen::VectorXd drive;                            ///< unit of p / sqrt(s)
  Eigen::VectorXi rate;                             ///< index of the parameter that is its rate; -1: none
  Eigen::Array<bool, Eigen::Dynamic, 1> estimated;  ///< otherwise considered
  /// E, 3 x q: what is followed, and called force here, is f, with F = exp(E p) f axis by axis (in_newtons).
  Eigen::Matrix<double, 3, Eigen::Dynamic> force_exponents;

  Eigen::Index size() const { return memory_s.size(); }
};

/// Motion state s, parameters p, and what the errors of the two have in common.
struct Belief {
  MotionState motion;
  Eigen::VectorXd parameters;            ///< q
  Eigen::MatrixXd cross;                 ///< n x q
  Eigen::MatrixXd parameter_covariance;  ///< q x q
};

/// The same of the seen force F = H s and p: (F, p).
struct SeenBelief {
  Eigen::VectorXd mean;        ///< 3 + q
  Eigen::MatrixXd covariance;  ///< (3 + q) x (3 + q)
};

/// Covariance of a force with the parameters, 3 x q.
using ParameterCross = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, kMaxParameters>;

/// What a frame did to a belief; whatever has a covariance with s and p is corrected by it alike (FixedLagSmoother).
/// Gains of considered parameters are zero.
struct Correction {
  template <int Max>
  using Columns = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, Max, kMaxResiduals>;

  Eigen::Index rows = 0;                                          ///< 0: the frame changed nothing
  ResidualVector shift;                                           ///< nu, the innovation
  Eigen::LLT<ResidualMatrix> innovation;                          ///< factor of S = J P J^T + R
  FrameLine::Rows<3> by_force;                                    ///< J_F
  FrameLine::Rows<Eigen::Dynamic, kMaxParameters> by_parameters;  ///< J_p
  Columns<kMaxMotionStates> motion_gain;                          ///< K_s, n x m
  Columns<kMaxParameters> parameter_gain;                         ///< K_p, q x m
  Columns<kMaxMotionStates> motion_surplus;      ///< K_s S - (P J^T)_s: zero but for hidden directions of the force
  Columns<kMaxMotionStates> motion_covariance;   ///< cov(s, nu) = (P J^T)_s, n x m
  Columns<kMaxParameters> parameter_covariance;  ///< cov(p, nu) = (P J^T)_p, q x m
};

/// Joint belief of a motion model's force and some parameters. The calls neither allocate nor throw.
///
///   predict    s- = A s,  P_ss- = A P_ss A^T + Q,  P_sp- = A P_sp Phi^T,  P_pp- = Phi P_pp Phi^T + Q_p
///   update     nu = r(F-, p-),  S = J P J^T + R,  K = P J^T S^-1 with the rows of considered parameters set to zero
///              x+ = x- + K nu,  P+ = (I - K J) P (I - K J)^T + K R K^T
///
/// A parameter is not believed to be farther from zero than C says: a variance that has grown beyond it is conditioned
/// on p_i = 0 with the noise that brings it back, so that what nothing observes keeps the sigma of the prior. The
/// update comes to P_ee - K_e S K_e^T and P_ec - K_e (P J^T)_c^T, with P_cc left as it was.
class BeliefModel {
 public:
  explicit BeliefModel(ParameterPrior prior) : prior_(std::move(prior)) {}

  const ParameterPrior& prior() const { return prior_; }
  Eigen::Index parameters() const { return prior_.size(); }
  /// Of a parameter that is drawn anew at every frame: its sigma in the frames to come.
  void set_sigma(Eigen::Index parameter, double sigma) { prior_.covariance(parameter, parameter) = sigma * sigma; }

  void initial(const MotionModel& motion, Belief& belief) const;
  void predict(const MotionModel& motion, const MotionStep& step, Belief& belief) const;
  /// Cost about m (n + q)^2 products, m rows. False, and the belief as it was, where S is not positive definite or a
  /// variance would be lost.
  bool update(const ComponentRow& seen, const FrameLine& line, Belief& belief, Correction& correction) const;

  /// `out` is to have its size from an earlier call, else this allocates.
  static void see(const ComponentRow& seen, const Belief& belief, SeenBelief& out);

 private:
  bool weigh(const ComponentRow& seen, const FrameLine& line, const Belief& belief, Correction& correction) const;
  void correct_parameters(const Correction& correction, Belief& belief) const;
  void wander(double dt_s, Belief& belief) const;
  void hold_within_prior(Belief& belief) const;

  ParameterPrior prior_;
};

/// No force is believed to be larger than N(0, limit^2) says (within_belief), and the parameters follow.
void limit_force(double limit_N, SeenBelief& seen);

/// F of f = N(mean, covariance), where cov(f, p) = `cross`, to first order: dF = exp(E p) df + diag(F) E dp.
ForceGaussian in_newtons(const ParameterPrior& prior, const ForceGaussian& force, const ParameterCross& cross,
                         const Eigen::VectorXd& parameters, const Eigen::MatrixXd& parameter_covariance);

/// What the frame alone says about the force, whatever was predicted. The rows are weighed by all that is uncertain
/// (noise and parameters, of covariance P_pp), the covariance is that of the white noise alone, of the sensors and of
/// the parameters that are drawn anew: this is what changes between frames. With W = (R + J_p P_pp J_p^T)^-1:
///
///   N = J^T W J,  M = J^T W R_white W J,   Lambda = N M^+ N,  eta = N M^+ J^T W (r + J F_0)
ForceLikelihood force_likelihood(const FrameLine& line, const ParameterPrior& prior, const Belief& belief);

}  // namespace palpate
