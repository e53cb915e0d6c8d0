// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <palpate/math/linearization.hpp>
#include <palpate/rod/relaxed_rod.hpp>
#include <palpate/sensing/catheter.hpp>
#include <palpate/sensing/measurement.hpp>

namespace palpate {

/// Tip forces read off one frame, without any memory of the force before: where a search may start. Curve and force are
/// fitted together to the poses (RelaxedRod), by Levenberg-Marquardt on
///
///   sum |pose residual / loosened sigma|^2 + w^2 |defect|^2 + |F / (5 F_E)|^2,     w = 1 -> 30 1/rad
///
/// first a curve through the sensors, then, as w grows, one that a tip force can hold. A coiled shaft has several such
/// curves; each start leads to one. Seed 0 starts from the unloaded shaft, the others from the shapes under forces of
/// 3.3 F_E in 20 directions, the best match of the measured poses first. F_E: buckling load (RelaxedRod).
/// No allocation, no exception. A seed costs at most kMostEvaluations, the second one kDirections more.
class ForceSeeds {
 public:
  static constexpr int kDirections = 20, kMostEvaluations = 15;

  explicit ForceSeeds(const Catheter& catheter);

  /// Speaks of this frame from now on: those of its sensors whose bit is set. `measurement` must outlive the calls.
  /// `load`: the tendon, and the own weight turned into the tip frame as well as that is known.
  void begin(const Measurement& measurement, unsigned sensors, const TipLoad& load);

  /// The k-th seed [N, tip components]; false where there are no more.
  bool seed(int k, Vector3d& force_tip_N);

  std::int64_t evaluations() const { return evaluations_; }  ///< curves integrated since construction

 private:
  using Unknowns = RelaxedRod::Unknowns;
  struct Fit;

  void compare_poses();
  void integrate(const Unknowns& z);
  Fit weigh(const Unknowns& z, double weight) const;
  void rank_directions();
  Unknowns fit(const Unknowns& start);

  std::vector<Sensor> sensors_;
  RelaxedRod rod_;
  TipLoad load_;
  const Measurement* measurement_ = nullptr;
  unsigned selected_ = 0;
  int rows_ = 0;

  RelaxedRod::Shape shape_;  ///< of the latest integration
  Linearization poses_;      ///< its residuals, in loosened sigmas
  struct Start {
    double cost = 0.0;
    Unknowns z;
  };
  std::array<Start, kDirections> starts_;  ///< ranked
  bool ranked_ = false;
  std::int64_t evaluations_ = 0;
};

}  // namespace palpate
