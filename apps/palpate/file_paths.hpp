// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
}

namespace palpate::app {

/// A file to read, as typed: the flag it stands behind, and the words that messages have for it.
struct InputPath {
  std::string_view flag;
  std::string words, path;
};

/// A file to write, as typed; empty: not asked for. Behind --plot it is a picture.
struct OutputPath {
  std::string_view flag;
  std::string path;
};

/// Throws InputError on what can be told before any file is read: an empty name of an input, an output over an input or
/// over another output, or in a folder that is not there, a picture of unknown kind.
void check_paths(const std::vector<InputPath>& inputs, const std::vector<OutputPath>& outputs);

/// Throws InputError on an option that was given an empty value, as by a shell variable that is not set.
void refuse_empty_values(const CLI::App& verb);

/// `palpate: warning: ...`, a line each, on stderr.
void print_warnings(const std::vector<std::string>& warnings);

}  // namespace palpate::app
