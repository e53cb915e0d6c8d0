// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <palpate/store/database.hpp>
#include <string>
#include <vector>

namespace palpate::session {

/// A folder that goes with the object.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// A session's file, open for reading whatever state it was left in: with its log where it was not closed, from a copy
/// where the folder is read-only and the log has to be brought in.
struct OpenSession {
  std::filesystem::path path;             ///< as given
  std::filesystem::path main_file;        ///< what is really read
  std::unique_ptr<ScratchFolder> folder;  ///< of the copy, where there is one
  std::unique_ptr<store::Database> database;
  std::vector<std::string> damage;  ///< what of it cannot be had, one line each
};

/// Throws InputError where the file is no session, or of a later program.
OpenSession open_session(const std::filesystem::path& path);

}  // namespace palpate::session
