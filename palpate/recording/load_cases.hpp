// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <palpate/recording/catheter_file.hpp>
#include <palpate/recording/load_points.hpp>
#include <string>
#include <vector>

/// Load-case files: which known loads a shaft bore, and where its shape under each was measured.
namespace palpate {

/// The shaft at rest under one dead load: its shape as points, or as a stretch of a recording of the catheter's
/// sensors.
struct LoadCaseEntry {
  std::string name;
  Vector3d force_base_N = Vector3d::Zero();
  std::vector<LoadPoint> points;      ///< empty where the shape is in a recording
  std::filesystem::path points_file;  ///< empty likewise
  std::filesystem::path recording;    ///< empty where the shape is points
  double from_s = 0.0, to_s = 0.0;    ///< the shaft rests under the load; both ends included
  double reference_sigma_m = 0.0;     ///< how well the reference holds what it claims, at each sensor and axis
  ReferenceInterval reference;        ///< zero-force tare of this recording, where given

  bool recorded() const { return !recording.empty(); }
};

struct LoadCaseFile {
  std::string source;                  ///< the path as given
  bool own_weight_subtracted = false;  ///< of every point; otherwise the shapes are as they hang
  bool clamp_fixed = false;            ///< the clamp stands alike in all recordings; otherwise each tare has its own
  std::vector<LoadCaseEntry> cases;    ///< at least one, each name once
};

/// Reads TOML as docs/reference/formats.md shows it, and the files with points that it names; paths are relative to it.
/// Recordings are only named: reading them needs the catheter's sensors. `catheter` says how long the shaft is and
/// where its base stands. Throws InputError naming file, line, key and value.
LoadCaseFile read_load_cases(const std::filesystem::path& path, const Catheter& catheter);

}  // namespace palpate
