// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <palpate/service/page_schema.hpp>
#include <set>
#include <sstream>
#include <string>

namespace palpate::service {
namespace {

TEST(PageSchema, NamesDifferAndPlacesFollow) {
  std::set<std::string_view> names;
  for (const PageField& field : kPageRow) EXPECT_TRUE(names.insert(field.name).second) << field.name;
  for (const std::string_view name : kPageHistory) EXPECT_TRUE(names.contains(name)) << name;
  EXPECT_EQ(page_place("time_s"), 0U);
  EXPECT_EQ(page_place("sigma_tip_N"), page_place("force_tip_N") + 3);
  EXPECT_EQ(page_place("wall_mm") + 3, page_row_size());
}

/// The reference lists every field with its count and unit.
TEST(PageSchema, IsInTheReference) {
  std::ifstream file(std::string(PALPATE_SOURCE_DIR) + "/docs/reference/dashboard.md");
  const std::string text = (std::ostringstream() << file.rdbuf()).str();
  for (const PageField& field : kPageRow) {
    const std::string row =
        "| `" + std::string(field.name) + "` | " + std::to_string(field.count) + " | " + std::string(field.unit) + " |";
    EXPECT_NE(text.find(row), std::string::npos) << row;
  }
}

}  // namespace
}  // namespace palpate::service
