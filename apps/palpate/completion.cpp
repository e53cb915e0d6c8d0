// SPDX-License-Identifier: Apache-2.0
#include "completion.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <palpate/recording/output_file.hpp>

#include "file_paths.hpp"
#include "verbs.hpp"

namespace palpate::app {

namespace {

struct Options {
  std::string shell, out;
};

std::string script(const std::string& shell, const CommandInfo& palpate) {
  if (shell == "bash") return bash_completion(palpate);
  return shell == "zsh" ? zsh_completion(palpate) : fish_completion(palpate);
}

int run(const Options& options, const CommandInfo& palpate) {
  if (options.out.empty()) {
    fmt::print("{}", script(options.shell, palpate));
    return 0;
  }
  OutputFile file(options.out);
  file.write(script(options.shell, palpate));
  file.commit();
  return 0;
}

}  // namespace

void add_completion(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("completion", "The script by which a shell completes palpate");
  verb->group("");
  verb->add_option("SHELL", options->shell, "which shell")->required()->check(CLI::IsMember({"bash", "zsh", "fish"}));
  verb->add_option("--out", options->out, "file to write, instead of standard output")->type_name("FILE");
  verb->footer("Example: source <(palpate completion bash)");
  verb->callback([options, verb, &app, &exit_code] {
    refuse_empty_values(*verb);
    exit_code = run(*options, command_tree(app));
  });
}

}  // namespace palpate::app
