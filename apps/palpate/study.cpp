// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstring>
#include <memory>
#include <palpate/math/errors.hpp>
#include <thread>

#include "study_files.hpp"
#include "study_run.hpp"
#include "verbs.hpp"

namespace palpate::app {

namespace {

struct Options : StudyOptions {
  bool mpi = false;
};

/// Under mpirun this process becomes the program that speaks MPI and stands beside it: who runs one command on one
/// computer loads no MPI.
[[noreturn]] void become_mpi_program(const Options& options) {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error).parent_path() / "palpate-study-mpi";
  std::vector<std::string> words{program.string(), options.study, "--out", options.out};
  if (!options.shard.empty()) words.insert(words.end(), {"--shard", options.shard});
  if (options.json) words.emplace_back("--json");
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  if (!error && std::filesystem::exists(program, error)) ::execv(program.c_str(), arguments.data());
  throw InputError(
      fmt::format("study: --mpi: expected a build with MPI: {}: {}", program.string(), std::strerror(errno)));
}

int run(const Options& options) {
  if (options.mpi) become_mpi_program(options);
  return run_study(options, [&](const study::Plan& plan, study::Results& results) {
    return study::fork_workers(plan, options.workers, [&results] { results.abandon(); });
  });
}

}  // namespace

void add_study(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  options->workers = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  CLI::App* verb = app.add_subcommand("study", "A Monte-Carlo campaign over scenarios, parameters and filter settings");
  add_study_options(*verb, *options);
  CLI::Option* workers = verb->add_option("--workers", options->workers, "processes; the results do not depend on it")
                             ->check(CLI::Range(1, 1024))
                             ->capture_default_str();
  verb->add_flag("--mpi", options->mpi, "under mpirun: rank 0 keeps the results, the others play")->excludes(workers);
  verb->require_subcommand(0, 1);
  verb->footer(
      "Example: palpate study examples/studies/error_sources.toml --out error.study\n"
      "         palpate study report error.study --out error.md\n"
      "         palpate study big.toml --out part3.study --shard 3/8\n"
      "         palpate study merge part*.study --out big.study\n"
      "         palpate study export big.study --out big.csv\n"
      "         mpirun -n 65 palpate study big.toml --out big.study --mpi\n"
      "Exit code 1: stopped, or shards given up; the same command goes on.");
  add_study_files(*verb, exit_code);
  verb->callback([options, verb, &exit_code] {
    if (verb->get_subcommands().empty()) exit_code = run(*options);
  });
}

}  // namespace palpate::app
