// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <tests/apps/app_fixture.hpp>

namespace palpate {
namespace {

using testing::HasSubstr;

class Reproduce : public test::App {};

TEST_F(Reproduce, PrintsATableAndTheSameOneAgain) {
  const test::ProgramRun first = palpate({"reproduce", "table3"}), second = palpate({"reproduce", "table3"});
  EXPECT_EQ(first.exit_code, 0);
  EXPECT_THAT(first.out, HasSubstr("## Table 3"));
  EXPECT_THAT(first.out, HasSubstr("3.24e-04"));
  EXPECT_EQ(first.err, "") << "silent in a pipe";
  EXPECT_EQ(first.out, second.out);
}

TEST_F(Reproduce, WritesPageAndPictures) {
  const test::ProgramRun run = palpate({"reproduce", "figure6", "--out", "page"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const std::string page = test::read_whole(path("page/paper.md")),
                    picture = test::read_whole(path("page/figure6.svg"));
  EXPECT_THAT(page, HasSubstr("[Figure 6: convergence indices](#figure6)"));
  EXPECT_THAT(page, HasSubstr("(figure6.svg)"));
  EXPECT_THAT(picture, HasSubstr("<svg"));
}

TEST_F(Reproduce, JsonHoldsTheCurves) {
  const test::ProgramRun run = palpate({"reproduce", "figure3", "--json"});
  const nlohmann::json parts = nlohmann::json::parse(run.out);
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0]["name"], "figure3");
  EXPECT_EQ(parts[0]["figures"][0]["panels"][0]["series"][2]["y"].size(), 150U);
}

TEST_F(Reproduce, NamesTheNearest) {
  EXPECT_THAT(refusal({"reproduce", "tabel3"}), HasSubstr("did you mean table3?"));
  EXPECT_THAT(refusal({"reproduce", "al", "--out", "page"}), HasSubstr("did you mean all?"));
}

TEST_F(Reproduce, RefusesAFolderThatCannotBe) {
  EXPECT_THAT(refusal({"reproduce", "table2", "--out", "c.toml"}), HasSubstr("--out c.toml: expected a folder"));
  EXPECT_THAT(refusal({"reproduce", "table2", "--out", "no/page"}), HasSubstr("the folder no does not exist"));
  EXPECT_THAT(refusal({"reproduce", "table2", "--out", ""}), HasSubstr("--out: expected a value"));
}

TEST_F(Reproduce, MakesAFolderWithAStrokeBehindIt) {
  const test::ProgramRun run = palpate({"reproduce", "table2", "--out", "page/"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(std::filesystem::exists(path("page/paper.md")));
}

/// The pictures come first in the list of files, and are not left alone.
TEST_F(Reproduce, PutsAllInPlaceOrNothing) {
  std::filesystem::create_directories(path("page/paper.md"));
  const test::ProgramRun run = palpate({"reproduce", "figure5", "--out", "page"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("page/paper.md: is a directory"));
  EXPECT_FALSE(std::filesystem::exists(path("page/figure5.svg")));
}

}  // namespace
}  // namespace palpate
