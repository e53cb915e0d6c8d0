// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace palpate::serve_test {

class ServeProcess;

/// What the dashboard's page is to the program: a WebSocket that reads everything, on a thread of its own.
class PageClient {
 public:
  /// Throws where it is not let in.
  explicit PageClient(const ServeProcess& program);
  ~PageClient();
  PageClient(const PageClient&) = delete;
  PageClient& operator=(const PageClient&) = delete;

  void say(const nlohmann::json& data);

  bool closed() const;
  nlohmann::json hello() const;
  std::size_t rows() const;
  /// Field of the latest row by its name in the greeting.
  double latest(const std::string& field) const;
  /// From received_ms to the clock when each row was here [s].
  std::vector<double> latencies_s() const;
  std::vector<nlohmann::json> texts(const std::string& type) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace palpate::serve_test
