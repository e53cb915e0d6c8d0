// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <palpate/math/errors.hpp>
#include <palpate/study/scratch_folder.hpp>

namespace palpate::study {

ScratchFolder::ScratchFolder() {
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
  if (error) throw InputError(fmt::format("study: TMPDIR: expected a folder for temporary files: {}", error.message()));
  std::string name = (std::filesystem::absolute(folder) / "palpate-study-XXXXXX").string();  // found from any folder
  if (::mkdtemp(name.data()) == nullptr)
    throw InputError(fmt::format("{}: cannot be made: {}", name, std::strerror(errno)));
  path_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace palpate::study
