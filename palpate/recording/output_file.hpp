// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

namespace palpate {

/// A file that is there whole or not at all: written to a temporary beside the target, renamed by commit(). Without
/// commit() the destructor removes the temporary and the target stays as it was. A target that is no regular file
/// (/dev/stdout, a pipe) is written directly. Every failure throws InputError with the path and the system's reason.
class OutputFile {
 public:
  explicit OutputFile(const std::filesystem::path& target);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view text);
  /// Flushes to the disk and puts the file in place. Once.
  void commit();

 private:
  [[noreturn]] void fail(int error) const;
  void discard() noexcept;

  std::string name_;  ///< the path as given
  std::filesystem::path target_;
  std::filesystem::path temporary_;  ///< empty: the target is written directly
  std::FILE* stream_ = nullptr;
};

}  // namespace palpate
