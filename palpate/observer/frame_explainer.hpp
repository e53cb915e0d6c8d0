// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <palpate/estimation/consistency.hpp>
#include <palpate/estimation/global_update.hpp>
#include <palpate/observer/estimate.hpp>
#include <palpate/observer/frame_model.hpp>
#include <palpate/observer/options.hpp>

namespace palpate {

/// Finds the force behind one frame, and the sensors that speak the truth. A jump of the force is not an outlier: a
/// measurement is judged by whether any force explains it, not by its distance from the prediction.
///
///   1. the filter's own update from the prediction, all sensors
///   2. does not fit: any force whatever may explain them; the search is global (GlobalUpdate)
///   3. none does: the same without each sensor in turn; the best explanation that passes stands, the odd one is
///   refused
///
/// Neither allocates nor throws. Bounded work: most_evaluations().
class FrameExplainer {
 public:
  FrameExplainer(const Catheter& catheter, const ObserverOptions& options, const UncertainParameters& parameters);

  void set_tendon_moment(const Eigen::Vector2d& moment_Nm) { shape_.set_tendon_moment(moment_Nm); }
  void set_bend(const BendReading& bend) { shape_.set_bend(bend); }
  void set_known_load(const KnownLoad& load) { shape_.set_known_load(load); }

  /// `prediction`: of the force that acts on the shaft, and of the parameters. A refused sensor is marked in
  /// `measurement`. Where the status is kUpdated, kReseeded or kAmbiguous, the results below are of the explanation
  /// that stands.
  EstimateStatus explain(Measurement& measurement, const SeenBelief& prediction);

  const Update& update() const { return update_; }
  /// What the frame says about force and parameters, whatever was predicted.
  const FrameLine& line() const { return line_; }
  unsigned used() const { return used_; }
  const ConvergenceIndex& convergence() const { return convergence_; }
  bool jumped() const { return jumped_; }  ///< the prediction was set aside

  /// Orientation of the tip under a force, and with these parameters; costs an evaluation.
  Matrix3d R_base_tip(const StateVector& x);
  int states() const { return shape_.states(); }
  const Matrix3d& R_base_tip() const { return R_base_tip_; }
  std::int64_t evaluations() const { return shape_.evaluations(); }

  /// Model evaluations of one explain() at most, with `sensors` sensors in the frame; each is one integration, with own
  /// weight up to 25. `states`: force and parameters that bend the rod.
  static int most_evaluations(const ObserverOptions& options, int sensors, int states = 3);

 private:
  bool fits_prediction(unsigned sensors);
  double hopeless_cost() const;
  bool fits_prediction_after_all();
  bool fits_any_force(unsigned sensors, GlobalUpdate& search);
  EstimateStatus explain_lone_point(unsigned sensors);
  EstimateStatus explain_without_one_sensor(Measurement& measurement, unsigned present);
  bool agrees_with_prediction() const;
  bool agrees_with_itself() const;
  EstimateStatus take(const FramePrior& prior, unsigned sensors);

  FrameModel model(const FramePrior& prior) { return {shape_, adaptation_ ? &*adaptation_ : nullptr, prior}; }
  int surplus() const { return update_.rows - kForceStates; }

  ObserverOptions options_;
  UpdateOptions local_;
  ChiSquareGate outlier_gate_, jump_gate_;
  GlobalUpdate search_, short_search_;
  ShapeModel shape_;
  std::optional<NoiseAdaptation> adaptation_;

  static constexpr int kForceStates = 3;  ///< the parameters bring a prior of their own

  const Measurement* measurement_ = nullptr;
  FramePrior prediction_, anywhere_;  ///< the usual prior, that of a surprise
  FrameLine line_;
  Update update_, spare_;  ///< of the latest fit; of the best explanation so far
  StateVector start_;      ///< of a search
  Matrix3d R_base_tip_ = Matrix3d::Identity();
  unsigned used_ = 0;
  bool given_up_ = false;       ///< the latest fit from the prediction, before its end
  bool searched_ = false;       ///< not by the filter's own step from the prediction
  bool jumped_ = false;         ///< with the prediction set aside
  int surprises_in_a_row_ = 0;  ///< of a lone point
  ConvergenceIndex convergence_;
};

}  // namespace palpate
