// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <palpate/recording/tracker_recording.hpp>

namespace palpate {

/// True for the file name `cathcoords-coil<K>-<REC>.txt`.
bool is_mr_coil_name(const std::filesystem::path& path);

/// MR-tracked coils: lines `X Y Z` (mm), SNR, time (ms since epoch), trigger (ms), respiration. `path` is one coil's
/// file, and every coil of the same REC beside it is read, or the folder of a single REC. Sensors are `coil<K>`,
/// positions only; rows of equal time form a frame; times are relative to the first row of all coils.
/// Throws InputError on a line without 7 numbers, and where a folder holds no REC or several.
TrackerRecording read_mr_coil_text(const std::filesystem::path& path);

}  // namespace palpate
