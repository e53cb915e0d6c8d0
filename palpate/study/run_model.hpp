// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <palpate/recording/text_table.hpp>
#include <palpate/study/measures.hpp>
#include <palpate/study/plan.hpp>

namespace palpate::study {

/// Plays runs of a plan, in any order; what one gives depends on its key alone.
class RunModel {
 public:
  virtual ~RunModel() = default;
  /// Throws InputError where the run cannot be played or judged: a number that its point makes impossible, a load
  /// without an equilibrium.
  virtual Figures run(const RunKey& key) = 0;
  /// The same of the beginning of the run, where the whole may be long: enough to tell two programs apart.
  virtual Figures probe(const RunKey& key) { return run(key); }
};

/// `scratch`: a folder of its own, for files on the way. The plan must outlive the model.
std::unique_ptr<RunModel> make_model(const Plan& plan, const std::filesystem::path& scratch);

std::unique_ptr<RunModel> make_scenario_model(const Plan& plan, const std::filesystem::path& scratch);
std::unique_ptr<RunModel> make_update_model(const Plan& plan);

/// Reads the documents of a point as their model does, and throws where it would.
void check_documents(const Plan& plan, const Documents& documents, const std::filesystem::path& scratch);
void check_scenario_documents(const Plan& plan, const Documents& documents, const std::filesystem::path& scratch);
void check_update_documents(const Plan& plan, const Documents& documents);

/// A message without the "FILE:LINE: " in front: the file is one that the study has changed, its lines are not those
/// that the user sees, and where the files stand is nothing that results should depend on.
std::string without_place(const Plan& plan, std::string message);

/// The document as text, and as lines under the name of the file it came from.
std::string toml_text(const toml::table& document);
TextFile toml_lines(const toml::table& document, const std::string& name);

}  // namespace palpate::study
