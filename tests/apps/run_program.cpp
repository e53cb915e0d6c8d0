// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <tests/apps/run_program.hpp>

namespace palpate::test {
namespace {

/// Never returns: between fork and exec only calls that are safe there.
[[noreturn]] void become(const char* program, char* const* arguments, const char* folder, const char* out,
                         const char* err) {
  constexpr int kFlags = O_WRONLY | O_CREAT | O_TRUNC;
  const int out_descriptor = ::open(out, kFlags, 0600), err_descriptor = ::open(err, kFlags, 0600);
  const bool ready = ::dup2(out_descriptor, 1) >= 0 && ::dup2(err_descriptor, 2) >= 0 && ::chdir(folder) == 0;
  if (ready) ::execv(program, arguments);
  ::_exit(127);
}

}  // namespace

std::string read_whole(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return (std::ostringstream() << stream.rdbuf()).str();
}

ProgramRun run_program(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                       const std::filesystem::path& folder) {
  std::vector<std::string> words{program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const auto stream_file = [](const std::string& name) {
    return (std::filesystem::temp_directory_path() / ("palpate-" + std::to_string(::getpid()) + name)).string();
  };
  const std::string out = stream_file(".out"), err = stream_file(".err");

  const pid_t child = ::fork();
  if (child == 0) become(words[0].c_str(), pointers.data(), folder.c_str(), out.c_str(), err.c_str());
  int status = 0;
  rusage usage{};
  if (child < 0 || ::wait4(child, &status, 0, &usage) != child) throw std::runtime_error("cannot run " + words[0]);
  ProgramRun run{.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1,
                 .out = read_whole(out),
                 .err = read_whole(err),
                 .peak_memory_MB = static_cast<double>(usage.ru_maxrss) * 1024.0 / 1e6};
  std::filesystem::remove(out);
  std::filesystem::remove(err);
  return run;
}

}  // namespace palpate::test
