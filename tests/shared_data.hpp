// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace palpate::test {

/// Reference solutions, recordings and measurements live outside the project; tests that need them skip without.
inline std::filesystem::path shared_data(const char* relative) {
  return std::filesystem::path(PALPATE_SHARED_DIR) / relative;
}

}  // namespace palpate::test

/// First line of a test that needs a file or folder of the shared data.
#define PALPATE_NEEDS_SHARED(relative)                                \
  if (!std::filesystem::exists(palpate::test::shared_data(relative))) \
  GTEST_SKIP() << "shared data absent: " << palpate::test::shared_data(relative)
