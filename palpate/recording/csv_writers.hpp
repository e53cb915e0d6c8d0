// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <palpate/recording/output_file.hpp>
#include <palpate/sensing/catheter.hpp>
#include <palpate/sensing/tracker_frame.hpp>
#include <span>

namespace palpate {

/// Writes frames as tracker CSV (formats: micrometres, 1e-6 in the quaternion), sensors named as in the catheter; one
/// that is absent from a frame gets no row there.
/// Throws InputError where the file cannot be written.
void write_tracker_csv(const std::filesystem::path& path, const Catheter& catheter,
                       std::span<const TrackerFrame> frames);
/// The same into a file that the caller commits.
void write_tracker_csv(OutputFile& file, const Catheter& catheter, std::span<const TrackerFrame> frames);

/// Writes true forces as force CSV. The spans are of one size. Throws InputError where the file cannot be written.
void write_force_csv(const std::filesystem::path& path, std::span<const TrackerFrame> frames,
                     std::span<const Vector3d> force_tip_N, std::span<const Vector3d> force_base_N);

}  // namespace palpate
