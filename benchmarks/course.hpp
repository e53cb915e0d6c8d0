// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <benchmarks/paper_catheter.hpp>
#include <palpate/sensing/shape_model.hpp>
#include <palpate/simulation/virtual_tracker.hpp>
#include <vector>

namespace palpate {

inline const Matrix3d kWalk_N2 = 4e-4 * Matrix3d::Identity();  // 20 mN a frame: the beating wall's fastest

/// Registered frames of the beating wall, and the model that has seen the first of them.
struct Course {
  Catheter catheter = paper_catheter();
  std::vector<Measurement> frames;
  ShapeModel model;

  explicit Course(MeasurementKind kind) : model(catheter, kind) {
    const VirtualRecording recording =
        simulate_tracker(catheter, beating_wall_force, {.rate_hz = 40.0, .duration_s = 20.0});
    for (const TrackerFrame& frame : recording.frames) register_frame(catheter, frame, frames.emplace_back());
    model.select(frames.front(), ~0U);
  }
};

}  // namespace palpate
