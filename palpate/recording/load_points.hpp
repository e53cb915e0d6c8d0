// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <palpate/recording/text_table.hpp>
#include <palpate/sensing/catheter.hpp>
#include <string_view>
#include <vector>

namespace palpate {

/// A place on the shaft as it was measured under a known load, in the base frame.
struct LoadPoint {
  double arc_length_m = std::numeric_limits<double>::quiet_NaN();                           ///< NaN: not stated
  Vector3d position_base_m = Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());  ///< NaN: not measured
  std::optional<Matrix3d> R_base_local;  ///< of the shaft's local frame, where it was measured
  double sigma_m = 0.0;                  ///< per axis; 0: not stated
  double sigma_rad = 0.0;                ///< per axis, where the orientation was measured
  std::size_t line = 0;                  ///< in the file
};

/// Which of a file's points are meant, and how they are given.
struct LoadPointOptions {
  std::string_view case_name;  ///< where the file has a column `case`: the rows that bear this name
  bool in_tracker_frame = false;
};

/// Columns, each optional and blank where not known, in any order: `arc_length_mm`, `x_mm`, `y_mm`, `z_mm`,
/// `q0,qx,qy,qz` (scalar first, shaft to frame), `sigma_mm`, `sigma_deg`, `case`. A point without arc length needs z;
/// an orientation needs the arc length and both sigmas; sigma_mm stands in every row or in none. Points in the
/// tracker's frame need all of x, y, z and are turned into the base frame of `catheter`. Throws InputError naming file,
/// line, field and value, also where the numbers do not fit the shaft's length.
std::vector<LoadPoint> parse_load_points(const TextFile& file, const Catheter& catheter,
                                         const LoadPointOptions& options);

}  // namespace palpate
