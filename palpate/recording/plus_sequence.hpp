// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <palpate/recording/text_table.hpp>
#include <palpate/recording/tracker_recording.hpp>

namespace palpate {

/// MetaImage sequence of the PLUS toolkit (.igs.mha). Only the text header is read, never the pixels.
/// A sensor is a field `Seq_FrameNNNN_<From>To<To>Transform` (row-major 4x4, mm); its name is `<From>` where `<To>` is
/// Tracker. INVALID and all-zero transforms are missing. Rotations are rounded in the file: the nearest rotation is
/// taken; a matrix more than 1 % away from one keeps a zero quaternion, so that screening refuses it.
/// Throws InputError on text that is no number, a transform without 16 numbers, and a frame without Timestamp.
TrackerRecording read_plus_sequence(const std::filesystem::path& path);
TrackerRecording parse_plus_sequence(const TextFile& file);

}  // namespace palpate
