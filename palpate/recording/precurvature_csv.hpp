// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <palpate/math/rotation.hpp>
#include <palpate/sensing/tendon_map.hpp>
#include <vector>

/// Tables behind `palpate identify precurvature`.
namespace palpate {

/// A marker on the centre line of the unloaded shaft; NaN: that component has no column.
struct ShaftPointRow {
  double arc_length_m = 0.0;
  Vector3d position_m = Vector3d::Zero();
};

/// True where the first line that is not blank names a column arc_length_mm.
bool is_shaft_point_csv(const std::filesystem::path& path);

/// `arc_length_mm` and two or three of `x_mm,y_mm,z_mm`, one row a point, any order; other columns are passed over.
/// `length_m`: of the shaft with its rigid tip. Throws InputError on anything else, and arc lengths outside the shaft.
std::vector<ShaftPointRow> read_shaft_point_csv(const std::filesystem::path& path, double length_m);

/// The unloaded shaft with the handle at rest.
struct HandleRow {
  double position = 0.0;  ///< rad, m or N
  bool release = false;
  Eigen::Vector2d precurvature_per_m = Eigen::Vector2d::Zero(), sigma_per_m = Eigen::Vector2d::Zero();
};
struct HandleTable {
  TendonInput input = TendonInput::kKnob;
  bool has_k2 = false;
  std::vector<HandleRow> rows;
};

/// One of `knob_rad`, `knob_deg`, `displacement_mm`, `tension_N` (the one asked for, where there are several),
/// `k1_per_m`, and where known `k2_per_m`, `sigma_k1_per_m`, `sigma_k2_per_m`, `direction` (pull or release; a blank
/// one goes by the order of the rows, the first by the row after it). Without k2_per_m it is `k2_otherwise`.
HandleTable read_handle_table_csv(const std::filesystem::path& path, std::optional<TendonInput> asked,
                                  double k2_otherwise_per_m);

/// False where the position rises from the sample before (pull), true where it falls; one that stands still goes as
/// the one before, the first as the second.
std::vector<bool> releases_by_order(const std::vector<double>& position);

/// The input of that name ("knob_rad", ...); none where there is none.
std::optional<TendonInput> tendon_input(std::string_view name);

}  // namespace palpate
