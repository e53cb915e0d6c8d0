// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace palpate::serve_test {

/// The real `palpate serve --json`, as a process of its own that never outlives the test.
class ServeProcess {
 public:
  /// Starts it and waits for the line with its ports. Throws, with what it said, where none comes.
  ServeProcess(const std::filesystem::path& folder, const std::vector<std::string>& arguments);
  ~ServeProcess();
  ServeProcess(const ServeProcess&) = delete;
  ServeProcess& operator=(const ServeProcess&) = delete;

  int link_port() const { return ports_.at("openigtlink_port"); }
  int dashboard_port() const { return ports_.at("dashboard_port"); }
  /// What every request to it must bring.
  std::string token() const { return ports_.at("token"); }
  pid_t pid() const { return pid_; }

  /// GET /api/health; throws where no answer comes within five seconds.
  nlohmann::json health() const;
  nlohmann::json catheter(std::size_t index = 0) const { return health().at("catheters").at(index); }
  /// POST /api/...; the answer, its HTTP status as "http".
  nlohmann::json post(const std::string& path, const nlohmann::json& body) const;

  void signal(int number) const;
  /// Exit code, 128 + signal, or -1 where it still runs after so many seconds.
  int wait(double longest_s);
  bool running();
  /// After wait(): the last line of its output, the health at the end.
  nlohmann::json summary() const;
  std::string err() const;

  std::size_t descriptors() const;
  std::size_t threads() const;
  double memory_MB() const;  ///< resident
  double cpu_s() const;      ///< user and system, all threads

 private:
  std::filesystem::path out_, err_;
  pid_t pid_ = -1;
  int exit_code_ = -1;
  nlohmann::json ports_;
};

}  // namespace palpate::serve_test
