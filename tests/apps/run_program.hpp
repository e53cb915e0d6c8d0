// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::test {

struct ProgramRun {
  int exit_code = -1;  ///< -1: killed by a signal
  std::string out, err;
  double peak_memory_MB = 0.0;
};

/// Runs a program in `folder` until it ends; its standard output and error are files there while it runs, no terminals.
ProgramRun run_program(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                       const std::filesystem::path& folder);

std::string read_whole(const std::filesystem::path& file);

}  // namespace palpate::test
