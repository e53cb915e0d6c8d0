// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <palpate/math/linearization.hpp>
#include <palpate/rod/base_loads.hpp>
#include <palpate/sensing/force_seeds.hpp>
#include <palpate/sensing/measurement.hpp>
#include <palpate/sensing/sensor_model.hpp>
#include <palpate/sensing/uncertain_parameters.hpp>
#include <variant>

namespace palpate {

/// What enters the filter, of the same frame.
enum class MeasurementKind {
  kPoses,            ///< raw poses of all sensors: statistically the better one, the default
  kTipAndCurvature,  ///< the paper's Eq. (11): tip pose, and curvature and torsion between the last two sensors
};

/// Rows of a frame by the parameters behind those that bend the rod: six of the base, nine a sensor, and the
/// stiffness's rate, which moves nothing.
inline constexpr int kMaxPoseParameters = 6 + 9 * kMaxSensors + 1;
using PoseErrorMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxResiduals, kMaxPoseParameters>;

/// h(x) of the whole catheter: from the tip force to what the sensors of one frame see, with exact Jacobian and noise.
/// Meets the filters' MeasurementModel, BlockModel and SeededModel. State: x = (f, p_rod), the tip force in the tip
/// frame [N] and the uncertain parameters that bend the rod (UncertainParameters; none by default: then f = F,
/// otherwise see force_exponent()). Those that move the measured poses enter the residual linearly: pose_errors(). One
/// object a thread; linearize() and the rest neither allocate nor throw. A rod solution carries 3, 6, 9 or 12
/// sensitivities, the least that will do.
class ShapeModel {
 public:
  ShapeModel(const Catheter& catheter, MeasurementKind kind, const UncertainParameters& parameters = {},
             Accuracy accuracy = Accuracy::kRealtime);

  /// Tendon moment (about d1, d2) of this frame; acts as the catheter file's tendon model says.
  void set_tendon_moment(const Eigen::Vector2d& moment_Nm) { tendon_Nm_ = {moment_Nm.x(), moment_Nm.y(), 0.0}; }
  /// What the handle does to the precurvature of this frame; `bend.present`. Its sigma scales the effect of a
  /// precurvature error that is only considered: the same error, larger or smaller from frame to frame. An estimated
  /// one deviates from this bend.
  void set_bend(const BendReading& bend);
  /// Three more rows, F = what is known of it; from the next select() on. Not present: none.
  void set_known_load(const KnownLoad& load) { known_load_ = load; }

  /// Selects what the next calls speak of: the sensors of `measurement` whose bit in `mask` is set. The measurement
  /// must outlive them. The paper's vector needs the tip sensor; without the second one it is the tip pose alone.
  void select(const Measurement& measurement, unsigned mask);

  int states() const { return 3 + parameters_.rod_count; }
  int rows() const { return rows_; }
  unsigned used() const { return used_; }  ///< bit i: Catheter::sensors[i] contributes rows
  const Channels& channels() const { return channels_; }
  static constexpr int kChannels = 6 * kMaxSensors + 6;

  void noise(ResidualMatrix& R) const;
  bool linearize(const StateVector& x, Linearization& at);
  int block_end(int row) const;  ///< behind the rows of the sensor (or of the curvature) that `row` belongs to

  /// B, with r(x, b) = r(x) - B b for the parameters b behind p_rod: rows x pose_count. Taken at the measured poses, so
  /// it does not depend on x.
  void pose_errors(PoseErrorMatrix& B) const;

  /// The k-th force that the selected poses suggest by themselves, the parameters being those in x, which stay; false
  /// where there are no more. Adds the curves integrated for it to `evaluations`. In rising order of k.
  bool seed(int k, StateVector& x, int& evaluations);

  /// Tip frame in the base frame at the last linearization: turns F into base components.
  const Pose& T_base_tip() const { return T_base_tip_; }
  const StateVector& linearized_at() const { return x_; }
  /// Orientation of the tip at a state near linearized_at(), to first order.
  Matrix3d R_base_tip_near(const StateVector& x) const;
  std::int64_t evaluations() const { return evaluations_; }  ///< rods and curves integrated since construction

 private:
  struct Row {
    const Measurement::SensorPose* measured = nullptr;
    int first = 0;
  };

  /// A rod solution with N sensitivities, and what it takes.
  template <int N>
  struct Solver {
    LoadDirections<N> directions;
    RodSolution<N> solution;
    WeightWorkspace<N> workspace;
  };

  void choose_solver();
  void set_load(const StateVector& x);
  template <int N>
  void set_directions(Solver<N>& solver) const;
  template <int N>
  bool linearize(Solver<N>& solver, Linearization& at);
  void add_sensor(const Measurement::SensorPose& pose);
  void select_tip_and_curvature(const Measurement& measurement, unsigned mask);
  void add_base_noise(ResidualMatrix& R) const;
  template <int N>
  void curvature_rows(const RodSolution<N>& solution, Linearization& at) const;
  template <int N>
  void known_load_rows(const Solver<N>& solver, Linearization& at) const;
  void curvature_noise(ResidualMatrix& R) const;
  double segment_m() const;
  struct CurvatureErrors;
  CurvatureErrors curvature_errors() const;
  struct SensorErrors;
  SensorErrors errors_of(const Row& row) const;
  int known_row() const { return rows_ - 3; }

  Catheter catheter_;
  MeasurementKind kind_;
  UncertainParameters parameters_;
  RodSolver rod_;
  TipLoad load_;
  Vector3d force_scale_ = Vector3d::Ones();                       ///< F / f
  Vector3d tendon_Nm_ = Vector3d::Zero();                         ///< as read
  Vector3d bend_per_m_ = Vector3d::Zero();                        ///< added to the catheter's precurvature
  Vector3d bend_spread_ = Vector3d::Ones();                       ///< sigma of this frame's bend over the catheter's
  double tendon_scale_ = 1.0;                                     ///< of reading and noise: exp(c)
  Eigen::Vector2d torsion_by_bending_ = Eigen::Vector2d::Zero();  ///< d log GJ by d log EI1, d log EI2, where tied
  KnownLoad known_load_;
  std::variant<Solver<3>, Solver<6>, Solver<9>, Solver<12>> solver_;
  Pose T_base_tip_;
  StateVector x_;  ///< of the last linearization
  ForceSeeds seeds_;
  const Measurement* measurement_ = nullptr;
  int tip_ = 0, behind_ = -1;  ///< the two most distal pose sensors: the paper's vector

  std::array<Row, kMaxSensors> selected_;
  int selected_count_ = 0, rows_ = 0;
  std::int64_t evaluations_ = 0;
  bool curvature_ = false, known_ = false;
  unsigned used_ = 0;
  Channels channels_{};
};

}  // namespace palpate
