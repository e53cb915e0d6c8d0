// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace palpate::plot {

/// Runs gnuplot on `script` and puts what it prints into `file`, at once or not at all. The script must not set an
/// output: file names never reach gnuplot or a shell.
/// Throws InputError when the file cannot be written, or gnuplot is absent or fails (with what it said).
void run_gnuplot(const std::string& script, const std::filesystem::path& file);

}  // namespace palpate::plot
