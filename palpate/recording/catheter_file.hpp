// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <palpate/observer/options.hpp>
#include <palpate/sensing/catheter.hpp>
#include <string>
#include <vector>

namespace palpate {

/// [reference]: part of a recording in which the shaft's state is known.
struct ReferenceInterval {
  bool given = false;
  double from_s = 0.0;
  double to_s = 0.0;
  bool straight = false;  ///< held straight; otherwise unloaded, in its own precurvature
};

/// A catheter file: one catheter in one setup, and how to estimate with it.
struct CatheterFile {
  Catheter catheter;
  ObserverOptions observer;
  std::vector<std::string> ignore_sensors;  ///< sensors of the recording that are not on this catheter
  ReferenceInterval reference;
  std::vector<std::string> warnings;  ///< keys that are read but not acted on yet, one line each
};

/// Reads TOML as formats/catheter.toml shows it. Keys beyond those: sensor.markers, delay_s,
/// base_quaternion_wxyz, base_position_mm; estimator.force_rate_N_per_sqrt_s,
/// initial_force_sigma_N, max_iterations, adaptation_window, outlier_probability; recording.ignore_sensors;
/// reference.from_s, to_s, shape ("unloaded" | "straight").
/// Throws InputError `FILE:LINE: KEY = VALUE: expected ...` on anything unknown, missing, mistyped or out of range.
CatheterFile read_catheter_file(const std::filesystem::path& path);

}  // namespace palpate
