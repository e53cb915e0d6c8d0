// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace palpate::store {

/// The sole right to write a file, held by this process until the destructor or its end, however that comes. Kept as
/// a lock (flock) on FILE.lock beside it, for SQLite has locks of its own on the file itself: readers stay welcome.
class FileLock {
 public:
  /// Throws InputError where another process holds it, or the folder cannot be written.
  explicit FileLock(const std::filesystem::path& file);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

  /// In a forked child: lets go of its copy, so that the lock ends with the parent.
  void abandon() noexcept;

 private:
  std::string lock_path_;
  int descriptor_ = -1;
};

}  // namespace palpate::store
