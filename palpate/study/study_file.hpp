// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <palpate/study/plan.hpp>

namespace palpate::study {

/// Reads a study file (docs/howto/study.md) and the scenario and catheter files that it names, found from its folder,
/// and tries every value of every parameter by itself: what cannot be set is said before the first run.
/// Throws InputError `FILE:LINE: KEY = VALUE: expected ...`.
Plan read_study_file(const std::filesystem::path& path);

}  // namespace palpate::study
