// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <palpate/recording/catheter_file.hpp>
#include <palpate/simulation/scenario.hpp>
#include <string>

namespace palpate {

/// A virtual experiment as its file tells it: what truly is, and what the operator believes.
struct ScenarioFile {
  Scenario scenario;
  std::filesystem::path catheter_path;
  CatheterFile believed;      ///< the catheter file, with the noise, kind of sensor and flow that the scenario states
  std::string believed_text;  ///< the same as TOML: what `palpate estimate --catheter` reads
};

/// What a user asks for in place of the file's.
struct ScenarioChanges {
  std::optional<std::uint64_t> seed = {};
  std::optional<double> duration_s = {}, rate_hz = {};
  bool noise_free = false;  ///< the tracker and the tendon's channel make no error at all
};

/// Reads TOML as docs/reference/formats.md lists it; the catheter file is found from the scenario's folder.
/// Throws InputError `FILE:LINE: KEY = VALUE: expected ...` on anything unknown, missing, mistyped or out of range,
/// here or in the catheter file.
ScenarioFile read_scenario_file(const std::filesystem::path& path, const ScenarioChanges& changes = {});

}  // namespace palpate
