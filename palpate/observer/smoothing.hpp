// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/estimation/smoother.hpp>
#include <palpate/observer/force_observer.hpp>
#include <vector>

namespace palpate {

/// The estimates of a recording in the light of all of it (RecordingSmoother). Status, sensors and innovation of a
/// frame stay those of the observer; force, covariance and base components are the smoothed ones. Frames whose time was
/// impossible keep what the observer said.
class SmoothingPass {
 public:
  explicit SmoothingPass(const ForceObserver& observer)
      : smoother_(observer.motion().model(), observer.motion().parameters().prior()) {}

  /// Right after observer.update(frame) gave `estimate`. About 2 kB a frame (8 kB with rhythm).
  void add(const ForceObserver& observer, const TrackerFrame& frame, const Estimate& estimate);

  /// All frames added, in order; the pass is spent. A rod solution a frame, for the tip's orientation.
  std::vector<Estimate> finish(ForceObserver& observer);

 private:
  RecordingSmoother smoother_;
  std::vector<Estimate> estimates_;
  std::vector<TendonReading> tendons_;
  std::vector<BendReading> bends_;
};

}  // namespace palpate
