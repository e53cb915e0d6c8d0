// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <palpate/math/rotation.hpp>
#include <string>
#include <vector>

namespace palpate {

/// Force of the tissue on the tip over time, from a force sensor or a simulation.
struct ForceTrace {
  struct Sample {
    Vector3d force_tip_N = Vector3d::Zero();
    bool inside = false;  ///< false: the time lies outside the trace, the nearest sample is given
  };

  std::string source;
  std::vector<double> times_s;         ///< strictly increasing, at least one
  std::vector<Vector3d> force_tip_N;   ///< components along d1, d2, d3 at the flexible end
  std::vector<Vector3d> force_base_N;  ///< components in the base frame; empty where the file has none

  /// Linear between samples.
  Sample interpolate(double time_s) const;
};

/// `time_s,fx_tip_N,fy_tip_N,fz_tip_N[,fx_base_N,fy_base_N,fz_base_N]`; other columns are ignored.
/// Throws InputError on a value that is not a finite number and a time that does not increase.
ForceTrace read_force_csv(const std::filesystem::path& path);

}  // namespace palpate
