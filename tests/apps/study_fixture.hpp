// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <palpate/study/results.hpp>
#include <tests/apps/app_fixture.hpp>
#include <thread>

namespace palpate::test {

inline const std::string kStudyOfUpdates =
    "schema = 1\n[study]\nmodel = \"single_update\"\ncatheter = \"c.toml\"\nsamples = 5\nrepeats = 100\nshard_runs = "
    "50\n"
    "[[vary]]\nname = \"catheter.precurvature_per_m[0]\"\nrange = [0.0, 60.0]\n"
    "[[vary]]\nname = \"update.ball_N\"\nvalues = [0.1, 0.2]\n";

/// Tests of `palpate study`, with a study of 1000 updates in 20 shards.
class Study : public App {
 protected:
  void SetUp() override {
    App::SetUp();
    write("s.toml", kStudyOfUpdates);
  }
  nlohmann::json played(const Arguments& more) const {
    Arguments arguments{"study", "s.toml", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramRun run = palpate(arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return nlohmann::json::parse(run.out, nullptr, false);
  }
  std::string hash(const std::string& file) const {
    const ProgramRun run = palpate({"study", "export", file, "--out", file + ".csv", "--json"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return nlohmann::json::parse(run.out, nullptr, false).value("sha256", "");
  }
  std::string refused(const std::string& part, const std::string& by) const {
    std::string text = read_whole(path("s.toml"));
    const std::size_t at = text.find(part);
    EXPECT_NE(at, std::string::npos) << part;
    write("bad.toml", text.replace(at, part.size(), by));
    return refusal({"study", "bad.toml", "--out", "bad.study"});
  }
};

/// Children of a process, of Linux's own list.
inline std::vector<pid_t> children_of(pid_t parent) {
  std::ifstream list("/proc/" + std::to_string(parent) + "/task/" + std::to_string(parent) + "/children");
  std::vector<pid_t> children;
  for (pid_t child = 0; list >> child;) children.push_back(child);
  return children;
}

/// A study that another process plays meanwhile.
class Background {
 public:
  Background(const std::string& folder, const std::vector<std::string>& arguments, const char* program = PALPATE_BINARY)
      : process_(::fork()) {
    if (process_ != 0) return;
    if (::chdir(folder.c_str()) != 0 || std::freopen("bg.txt", "w", stdout) == nullptr ||
        std::freopen("bg.err", "w", stderr) == nullptr)
      ::_exit(3);
    std::vector<char*> argv;
    argv.reserve(arguments.size() + 1);
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    ::execv(program, argv.data());
    ::_exit(3);
  }
  ~Background() {
    if (process_ > 0) kill(SIGKILL);
  }
  void kill(int signal) {
    ::kill(process_, signal);
    wait();
  }
  int wait() {
    int status = 0;
    ::waitpid(process_, &status, 0);
    process_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  pid_t process() const { return process_; }

 private:
  pid_t process_;
};

/// The same with 6 000 updates in 600 shards, which last long enough to be killed.
class KilledStudy : public Study {
 protected:
  void SetUp() override {
    Study::SetUp();
    std::string text = read_whole(path("s.toml"));
    text.replace(text.find("repeats = 100"), 13, "repeats = 600");
    text.replace(text.find("shard_runs = 50"), 15, "shard_runs = 10");
    write("s.toml", text);
  }
  std::uint64_t shards_done(const std::string& file) const {
    try {
      return study::read_head(study::open_results(path(file))).shards_done;
    } catch (const std::exception&) {
      return 0;  // not made yet
    }
  }
  template <typename Ready>
  static void wait_until(const Ready& ready) {
    for (int i = 0; i < 6000 && !ready(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
};

}  // namespace palpate::test
