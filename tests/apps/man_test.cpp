// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <regex>
#include <set>
#include <tests/apps/app_fixture.hpp>

namespace palpate {
namespace {

using testing::HasSubstr;
using Words = std::vector<std::string>;

/// The oracle is --help itself, read as text: pages come from the same tree, but another way.
class Man : public test::App {
 protected:
  std::string text(const Words& arguments) const {
    const test::ProgramRun run = palpate(arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return run.out;
  }

  std::string help(Words command) const {
    command.emplace_back("--help");
    return text(command);
  }

  /// Names below "Subcommands:".
  Words commands_below(const Words& command) const {
    Words names;
    std::istringstream lines(help(command));
    bool there = false;
    for (std::string line; std::getline(lines, line); there = there || line == "Subcommands:") {
      if (there && !line.starts_with("  ")) break;
      if (there && line[2] != ' ') names.push_back(line.substr(2, line.find(' ', 2) - 2));
    }
    return names;
  }

  std::vector<Words> all_commands(const Words& from = {}) const {
    std::vector<Words> all{from};
    for (const std::string& name : commands_below(from)) {
      Words below = from;
      below.push_back(name);
      for (const Words& each : all_commands(below)) all.push_back(each);
    }
    return all;
  }

  /// The page as a reader sees it, on lines so long that no word is parted.
  std::string page(const Words& command) const {
    Words arguments{"man"};
    arguments.insert(arguments.end(), command.begin(), command.end());
    const std::filesystem::path source = path("page.1");
    write("page.1", text(arguments));
    const test::ProgramRun run = test::run_program("/usr/bin/mandoc", {"-Tutf8", "-Owidth=1000", source}, path(""));
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return std::regex_replace(run.out, std::regex("[^\n]\b"), "");  // bold and underlined text is overstruck
  }
};

bool mandoc_is_there() { return std::filesystem::exists("/usr/bin/mandoc"); }

TEST_F(Man, EveryCommandHasAPageWithoutWarnings) {
  if (!mandoc_is_there()) GTEST_SKIP() << "mandoc is not installed";
  const std::vector<Words> commands = all_commands();
  ASSERT_GE(commands.size(), 18u);
  text({"man", "--out", "."});
  Words arguments{"-T", "lint", "-W", "warning"};
  for (const Words& command : commands) {
    std::string name = "palpate";
    for (const std::string& word : command) name += "-" + word;
    arguments.push_back(name + ".1");
    EXPECT_TRUE(std::filesystem::exists(path(arguments.back()))) << arguments.back();
  }
  const test::ProgramRun lint = test::run_program("/usr/bin/mandoc", arguments, path(""));
  EXPECT_EQ(lint.exit_code, 0);
  EXPECT_EQ(lint.out + lint.err, "");
}

TEST_F(Man, PagesTellWhatHelpTells) {
  if (!mandoc_is_there()) GTEST_SKIP() << "mandoc is not installed";
  const std::regex option("  (?:-\\w,)?(--[\\w-]+)");
  for (const Words& command : all_commands()) {
    const std::string shown = page(command);
    std::istringstream lines(help(command));
    std::string line;
    std::getline(lines, line);
    EXPECT_THAT(shown, HasSubstr(line));  // what it does
    bool examples = false;
    while (std::getline(lines, line)) {
      std::smatch found;
      if (std::regex_search(line, found, option, std::regex_constants::match_continuous)) {
        EXPECT_THAT(shown, HasSubstr(found[1])) << line;
      }
      examples = line.starts_with("Example: ") || (examples && line.starts_with("         "));
      if (examples) {
        EXPECT_THAT(shown, HasSubstr(line.substr(9))) << line;
      }
    }
  }
}

TEST_F(Man, AnOptionsOwnTextIsThere) {
  if (!mandoc_is_there()) GTEST_SKIP() << "mandoc is not installed";
  const std::string estimate = page({"estimate"});
  EXPECT_THAT(estimate, HasSubstr("palpate estimate [OPTION]... recording..."));
  EXPECT_THAT(estimate, HasSubstr("--method ekf|iekf|iaekf|ukf"));
  EXPECT_THAT(estimate, HasSubstr("catheter file (TOML) (required)"));
  EXPECT_THAT(page({"study"}), HasSubstr("processes; the results do not depend on it"));
  EXPECT_THAT(page({"study", "report"}), HasSubstr("--pictures svg|png"));
  EXPECT_THAT(page({}), HasSubstr("not for clinical use"));
}

TEST_F(Man, DateIsThatOfTheSource) {
  ::setenv("SOURCE_DATE_EPOCH", "86400", 1);
  EXPECT_THAT(text({"man"}), HasSubstr(".TH PALPATE 1 1970-01-02 "));
  ::setenv("SOURCE_DATE_EPOCH", "soon", 1);
  EXPECT_EQ(refusal({"man"}), "SOURCE_DATE_EPOCH = soon: expected seconds since 1970");
  ::unsetenv("SOURCE_DATE_EPOCH");
}

TEST_F(Man, WhatCannotBe) {
  EXPECT_EQ(refusal({"man", "estimat"}), "man estimat: expected a command of palpate, as palpate --help lists them");
  EXPECT_EQ(refusal({"man", "--out", "no"}), "--out no: expected a folder that exists");
}

TEST_F(Man, IsNotShown) {
  EXPECT_THAT(commands_below({}),
              testing::Not(testing::AnyOf(testing::Contains("man"), testing::Contains("completion"))));
}

}  // namespace
}  // namespace palpate
