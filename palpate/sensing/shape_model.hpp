// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <palpate/math/linearization.hpp>
#include <palpate/rod/base_loads.hpp>
#include <palpate/sensing/force_seeds.hpp>
#include <palpate/sensing/measurement.hpp>
#include <palpate/sensing/sensor_model.hpp>

namespace palpate {

/// What enters the filter, of the same frame.
enum class MeasurementKind {
  kPoses,            ///< raw poses of all sensors: statistically the better one, the default
  kTipAndCurvature,  ///< the paper's Eq. (11): tip pose, and curvature and torsion between the last two sensors
};

/// h(x) of the whole catheter: from the tip force to what the sensors of one frame see, with exact Jacobian and noise.
/// Meets the filters' MeasurementModel, BlockModel and SeededModel. State: x = F, the tip force in the tip frame [N].
/// One object a thread; linearize() and the rest neither allocate nor throw.
class ShapeModel {
 public:
  ShapeModel(const Catheter& catheter, MeasurementKind kind, Accuracy accuracy = Accuracy::kRealtime);

  /// Tendon moment (about d1, d2) of this frame; acts as the catheter file's tendon model says.
  void set_tendon_moment(const Eigen::Vector2d& moment_Nm);

  /// Selects what the next calls speak of: the sensors of `measurement` whose bit in `mask` is set. The measurement
  /// must outlive them. The paper's vector needs the tip sensor; without the second one it is the tip pose alone.
  void select(const Measurement& measurement, unsigned mask);

  int rows() const { return rows_; }
  unsigned used() const { return used_; }  ///< bit i: Catheter::sensors[i] contributes rows
  const Channels& channels() const { return channels_; }
  static constexpr int kChannels = 6 * kMaxSensors + 3;

  void noise(ResidualMatrix& R) const;
  bool linearize(const StateVector& x, Linearization& at);
  int block_end(int row) const;  ///< behind the rows of the sensor (or of the curvature) that `row` belongs to

  /// The k-th force that the selected poses suggest by themselves; false where there are no more. Adds the curves
  /// integrated for it to `evaluations`. In rising order of k.
  bool seed(int k, StateVector& x, int& evaluations);

  /// Tip frame in the base frame at the last linearization: turns F into base components.
  const Pose& T_base_tip() const { return solution_.T_base_tip; }
  std::int64_t evaluations() const { return evaluations_; }  ///< rods and curves integrated since construction

 private:
  struct Row {
    const Measurement::SensorPose* measured = nullptr;
    int first = 0;
  };

  void add_sensor(const Measurement::SensorPose& pose);
  void select_tip_and_curvature(const Measurement& measurement, unsigned mask);
  void add_base_noise(ResidualMatrix& R) const;
  void curvature_rows(Linearization& at) const;
  void curvature_noise(ResidualMatrix& R) const;
  double segment_m() const;

  Catheter catheter_;
  MeasurementKind kind_;
  RodSolver solver_;
  TipLoad load_;
  LoadDirections<3> directions_;
  RodSolution<3> solution_;
  WeightWorkspace<3> workspace_;
  ForceSeeds seeds_;
  const Measurement* measurement_ = nullptr;
  int tip_ = 0, behind_ = -1;  ///< the two most distal pose sensors: the paper's vector

  std::array<Row, kMaxSensors> selected_;
  int selected_count_ = 0, rows_ = 0;
  std::int64_t evaluations_ = 0;
  bool curvature_ = false;
  unsigned used_ = 0;
  Channels channels_{};
};

}  // namespace palpate
