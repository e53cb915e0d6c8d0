// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <tests/apps/recording_text.hpp>
#include <tests/apps/run_program.hpp>
#include <tests/recording/temporary_folder.hpp>

namespace palpate::test {

/// One row of an estimate CSV, by column name.
using EstimateTable = std::vector<std::map<std::string, std::string>>;

/// Tests of the real `palpate`, each in a folder of its own, with a good catheter c.toml and a good recording r.csv.
class App : public TemporaryFolder {
 protected:
  void SetUp() override;

  using Arguments = std::vector<std::string>;
  /// `palpate` with these arguments, in this test's folder.
  ProgramRun palpate(const Arguments& arguments) const;
  /// `palpate estimate` of r.csv with c.toml into e.csv.
  ProgramRun estimate(const Arguments& more = {}) const;
  /// The same, expected to succeed: its summary.
  nlohmann::json summary(const Arguments& more = {}) const;
  EstimateTable table(const std::string& name = "e.csv") const;

  /// What the program says where it refuses: exit code 2, one line on stderr and nothing else, and no file came, went
  /// or changed. "palpate: " is cut off.
  std::string refusal(const Arguments& arguments) const;
  /// The same of `palpate estimate`, over an older e.csv and where there is none.
  std::string estimate_refusal(const Arguments& more = {}) const;

  /// Writes c.toml with one part of its text replaced; the part must be there.
  void write_catheter(const std::string& part, const std::string& replacement) const;

 private:
  std::map<std::string, std::string> files() const;
};

double number(const std::map<std::string, std::string>& row, const std::string& column);
std::size_t count_lines(const std::string& text);

}  // namespace palpate::test
