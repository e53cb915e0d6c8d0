// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <palpate/math/errors.hpp>
#include <palpate/plot/gnuplot.hpp>
#include <system_error>

extern char** environ;

namespace palpate::plot {
namespace {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

/// Anonymous, gone when closed. Files instead of pipes: neither side can block on the other.
File scratch_file() {
  File file(std::tmpfile());
  if (!file) throw InputError(fmt::format("cannot make a temporary file: {}", std::strerror(errno)));
  return file;
}

/// New file beside its later place. Removed unless it is moved there.
class PartialFile {
 public:
  explicit PartialFile(const std::filesystem::path& final_place) : final_place_(final_place), place_(final_place) {
    static std::atomic<int> count = 0;
    place_ += fmt::format(".{}-{}.partial", ::getpid(), count++);
    descriptor_ = ::open(place_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0) fail("cannot be written", errno);
  }
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;
  ~PartialFile() {
    ::close(descriptor_);
    std::error_code ignored;
    if (!moved_) std::filesystem::remove(place_, ignored);
  }

  int descriptor() const { return descriptor_; }

  void move_into_place() {
    std::error_code error;
    std::filesystem::rename(place_, final_place_, error);
    if (error) fail("cannot be written", error.value());
    moved_ = true;
  }

 private:
  [[noreturn]] void fail(const char* what, int error) const {
    throw InputError(fmt::format("{}: {}: {}", final_place_.string(), what, std::strerror(error)));
  }

  std::filesystem::path final_place_, place_;
  int descriptor_ = -1;
  bool moved_ = false;
};

/// Exit status as of waitpid.
int spawn_and_wait(int in, int out, int err) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, in, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, out, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, err, STDERR_FILENO);
  std::array<char, 8> name = {"gnuplot"};
  std::array<char, 3> ignore_user_settings = {"-d"};
  const std::array<char*, 3> arguments = {name.data(), ignore_user_settings.data(), nullptr};
  pid_t child = 0;
  const int error = posix_spawnp(&child, name.data(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    throw InputError(fmt::format("cannot start gnuplot, which draws the pictures (Debian package gnuplot-nox): {}",
                                 std::strerror(error)));
  }
  int status = 0;
  while (::waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) throw InputError(fmt::format("lost track of gnuplot: {}", std::strerror(errno)));
  }
  return status;
}

std::string contents(std::FILE* file) {
  std::string text(4000, '\0');
  std::rewind(file);
  text.resize(std::fread(text.data(), 1, text.size(), file));
  return text;
}

}  // namespace

void run_gnuplot(const std::string& script, const std::filesystem::path& file) {
  const File input = scratch_file();
  const File complaints = scratch_file();
  PartialFile picture(file);
  if (std::fwrite(script.data(), 1, script.size(), input.get()) != script.size() || std::fflush(input.get()) != 0) {
    throw InputError(fmt::format("cannot write a temporary file: {}", std::strerror(errno)));
  }
  std::rewind(input.get());

  const int status = spawn_and_wait(fileno(input.get()), picture.descriptor(), fileno(complaints.get()));
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw InputError(fmt::format("{}: gnuplot failed: {}", file.string(), contents(complaints.get())));
  }
  picture.move_into_place();
}

}  // namespace palpate::plot
