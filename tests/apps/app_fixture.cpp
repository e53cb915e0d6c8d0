// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <tests/apps/app_fixture.hpp>

namespace palpate::test {

void App::SetUp() {
  TemporaryFolder::SetUp();
  write("c.toml", beating_recording().catheter);
  write("r.csv", beating_recording().tracker.text());
}

ProgramRun App::palpate(const Arguments& arguments) const { return run_program(PALPATE_BINARY, arguments, path("")); }

ProgramRun App::estimate(const Arguments& more) const {
  Arguments arguments{"estimate", "--catheter", "c.toml", "r.csv", "--out", "e.csv"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return palpate(arguments);
}

nlohmann::json App::summary(const Arguments& more) const {
  Arguments arguments{"--json"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const ProgramRun run = estimate(arguments);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  return nlohmann::json::parse(run.out, nullptr, false);
}

EstimateTable App::table(const std::string& name) const {
  std::istringstream lines(contents(path(name)));
  std::string line, field;
  std::getline(lines, line);
  std::vector<std::string> columns;
  for (std::istringstream header(line); std::getline(header, field, ',');) columns.push_back(field);
  EstimateTable rows;
  while (std::getline(lines, line)) {
    auto& row = rows.emplace_back();
    std::istringstream fields(line);
    for (const std::string& column : columns) std::getline(fields, row[column], ',');
  }
  return rows;
}

std::string App::refusal(const Arguments& arguments) const {
  const auto before = files();
  const ProgramRun run = palpate(arguments);
  EXPECT_EQ(run.exit_code, 2) << run.err;
  EXPECT_EQ(run.out, "");
  EXPECT_EQ(count_lines(run.err), 1u) << run.err;
  EXPECT_TRUE(files() == before) << "a file came, went or changed";
  const std::string prefix = "palpate: ";
  EXPECT_TRUE(run.err.starts_with(prefix) && run.err.ends_with('\n')) << run.err;
  return run.err.substr(prefix.size(), run.err.size() - prefix.size() - 1);
}

std::string App::estimate_refusal(const Arguments& more) const {
  Arguments arguments{"estimate", "--catheter", "c.toml", "r.csv", "--out", "e.csv"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  std::filesystem::remove(path("e.csv"));
  const std::string message = refusal(arguments);
  write("e.csv", "older");
  EXPECT_EQ(refusal(arguments), message);
  return message;
}

void App::write_catheter(const std::string& part, const std::string& replacement) const {
  std::string text = beating_recording().catheter;
  const std::size_t at = text.find(part);
  if (at == std::string::npos) throw std::runtime_error("the catheter file has no " + part);
  write("c.toml", text.replace(at, part.size(), replacement));
}

std::map<std::string, std::string> App::files() const {
  std::map<std::string, std::string> found;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path("")))
    found[entry.path().string()] = entry.is_regular_file() ? contents(entry.path()) : "not a file";
  return found;
}

double number(const std::map<std::string, std::string>& row, const std::string& column) {
  return std::stod(row.at(column));
}

std::size_t count_lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace palpate::test
