// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <palpate/math/errors.hpp>
#include <palpate/recording/output_file.hpp>
#include <system_error>

namespace palpate {
namespace {

std::filesystem::path temporary_beside(const std::filesystem::path& target) {
  static std::atomic<unsigned> counter{0};
  const std::string name = fmt::format(".{}.{}.{}.tmp", target.filename().string(), ::getpid(), counter++);
  return target.parent_path() / name;
}

/// Renaming over a symbolic link would replace the link, not what it points to.
std::filesystem::path behind_links(const std::filesystem::path& target) {
  std::error_code error;
  const auto real = std::filesystem::canonical(target, error);
  return error ? target : real;
}

}  // namespace

OutputFile::OutputFile(const std::filesystem::path& target) : name_(target.string()), target_(behind_links(target)) {
  std::error_code ignored;
  const auto status = std::filesystem::status(target_, ignored);
  const bool in_place = std::filesystem::exists(status) && !std::filesystem::is_regular_file(status);
  if (in_place) {
    stream_ = std::fopen(target_.c_str(), "w");
  } else {
    temporary_ = temporary_beside(target_);
    const int descriptor = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0) stream_ = ::fdopen(descriptor, "w");
  }
  if (stream_ == nullptr) fail(errno);
}

OutputFile::~OutputFile() { discard(); }

void OutputFile::write(std::string_view text) {
  if (stream_ == nullptr) fail(EBADF);
  if (std::fwrite(text.data(), 1, text.size(), stream_) != text.size()) fail(errno);
}

void OutputFile::commit() {
  if (stream_ == nullptr) fail(EBADF);
  if (std::fflush(stream_) != 0) fail(errno);
  if (!temporary_.empty() && ::fsync(::fileno(stream_)) != 0) fail(errno);
  std::FILE* const finished = stream_;
  stream_ = nullptr;
  const bool closed = std::fclose(finished) == 0;
  const bool placed = closed && (temporary_.empty() || std::rename(temporary_.c_str(), target_.c_str()) == 0);
  if (!placed) {
    const int error = errno;
    discard();
    fail(error);
  }
  temporary_.clear();
}

void OutputFile::fail(int error) const {
  throw InputError(fmt::format("{}: cannot be written: {}", name_, std::strerror(error)));
}

void OutputFile::discard() noexcept {
  if (stream_ != nullptr) std::fclose(stream_);
  stream_ = nullptr;
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
  temporary_.clear();
}

}  // namespace palpate
