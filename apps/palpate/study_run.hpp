// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <palpate/study/results.hpp>
#include <palpate/study/workers.hpp>
#include <string>

namespace CLI {
class App;
}

namespace palpate::app {

struct StudyOptions {
  std::string study, out, shard;
  int workers = 1;
  bool json = false;
};

/// STUDY, --out, --shard and --json: what a study needs however its workers are made.
void add_study_options(CLI::App& verb, StudyOptions& options);

using MakeWorkers = std::function<std::unique_ptr<study::Workers>(const study::Plan& plan, study::Results& results)>;

/// Plays what is missing of a study and tells what was done. Exit code: 0 complete, 1 not. Throws InputError.
int run_study(const StudyOptions& options, const MakeWorkers& make_workers);

/// Title, id and counts.
nlohmann::json as_json(const study::StudyHead& head);
std::string json_text(const nlohmann::json& json);

}  // namespace palpate::app
