// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <palpate/math/errors.hpp>
#include <palpate/store/file_lock.hpp>

namespace palpate::store {

namespace {

/// False where the lock file was removed, by a holder that ended, between open and lock.
bool still_there(int descriptor, const std::string& path) {
  struct stat ours {
  }, theirs{};
  return ::fstat(descriptor, &ours) == 0 && ::stat(path.c_str(), &theirs) == 0 && ours.st_ino == theirs.st_ino &&
         ours.st_dev == theirs.st_dev;
}

}  // namespace

FileLock::FileLock(const std::filesystem::path& file) {
  std::error_code failed;
  const std::filesystem::path real = std::filesystem::weakly_canonical(file, failed);  // a link has another name
  lock_path_ = (failed ? file : real).string() + ".lock";
  for (;;) {
    descriptor_ = ::open(lock_path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor_ < 0)
      throw InputError(fmt::format("{}: cannot be written: {}", file.string(), std::strerror(errno)));
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      const int error = errno;
      ::close(descriptor_);
      if (error != EWOULDBLOCK)
        throw InputError(fmt::format("{}: cannot be locked: {}", lock_path_, std::strerror(error)));
      throw InputError(fmt::format("{}: another process is writing it: expected one at a time", file.string()));
    }
    if (still_there(descriptor_, lock_path_)) return;
    ::close(descriptor_);
  }
}

FileLock::~FileLock() {
  if (descriptor_ < 0) return;
  ::unlink(lock_path_.c_str());  // before it is let go, so that nobody locks a file that goes
  ::close(descriptor_);
}

void FileLock::abandon() noexcept {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
}

}  // namespace palpate::store
