// SPDX-License-Identifier: Apache-2.0
#include "file_paths.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <palpate/math/errors.hpp>

namespace palpate::app {

namespace {

void refuse_same_file(const OutputPath& output, const std::string& other, std::string_view words) {
  std::error_code ignored;
  const std::filesystem::path path(output.path);
  const bool same = path.lexically_normal() == std::filesystem::path(other).lexically_normal();
  if (!same && !std::filesystem::equivalent(path, other, ignored)) return;
  throw InputError(fmt::format("{} {}: expected another file than {}", output.flag, output.path, words));
}

void refuse_absent_folder(const OutputPath& output) {
  std::error_code ignored;
  const std::filesystem::path folder = std::filesystem::path(output.path).parent_path();
  if (folder.empty() || std::filesystem::is_directory(folder, ignored)) return;
  throw InputError(fmt::format("{} {}: expected the folder {} to exist", output.flag, output.path, folder.string()));
}

void refuse_unknown_picture(const OutputPath& output) {
  const std::string extension = std::filesystem::path(output.path).extension().string();
  if (output.flag == "--plot" && extension != ".svg" && extension != ".png")
    throw InputError(fmt::format("--plot {}: expected a file name that ends in .svg or .png", output.path));
}

}  // namespace

void check_paths(const std::vector<InputPath>& inputs, const std::vector<OutputPath>& outputs) {
  for (const InputPath& input : inputs)
    if (input.path.empty())
      throw InputError(fmt::format("{}: expected the name of a file, found an empty one", input.flag));
  for (auto output = outputs.begin(); output != outputs.end(); ++output) {
    if (output->path.empty()) continue;
    for (const InputPath& input : inputs) refuse_same_file(*output, input.path, input.words);
    refuse_absent_folder(*output);
    for (auto other = outputs.begin(); other != output; ++other)
      if (!other->path.empty()) refuse_same_file(*output, other->path, other->flag);
  }
  for (const OutputPath& output : outputs)
    if (!output.path.empty()) refuse_unknown_picture(output);
}

void refuse_empty_values(const CLI::App& verb) {
  for (const CLI::Option* option : verb.get_options())
    for (const std::string& value : option->results())
      if (value.empty()) throw InputError(fmt::format("{}: expected a value, found an empty one", option->get_name()));
}

void print_warnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) fmt::print(stderr, "palpate: warning: {}\n", warning);
}

}  // namespace palpate::app
