// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace palpate::study {

/// A new folder for files on the way, removed with all that is in it.
class ScratchFolder {
 public:
  /// Throws InputError where the system's folder for temporary files cannot be written.
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace palpate::study
