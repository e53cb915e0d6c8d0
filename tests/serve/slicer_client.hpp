// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <igtlClientSocket.h>

#include <array>
#include <atomic>
#include <chrono>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

namespace palpate::serve_test {

/// 3D Slicer as far as the program can tell: a client made of Debian's libopenigtlink, with a thread that takes what
/// comes and keeps it by device.
class SlicerClient {
 public:
  struct Force {
    double time_s = 0.0;
    std::chrono::steady_clock::time_point received;
    std::array<double, 6> values{};  ///< force and its sigma [N]
    bool live() const { return values[0] == values[0]; }
  };

  /// Throws where nobody listens.
  explicit SlicerClient(int port);
  ~SlicerClient();
  SlicerClient(const SlicerClient&) = delete;
  SlicerClient& operator=(const SlicerClient&) = delete;

  std::vector<Force> forces(const std::string& device = "cForce") const;
  /// How many messages of this type have come: "SENSOR", "POLYDATA", ...
  std::size_t count(const std::string& type) const;
  nlohmann::json health(const std::string& device = "cHealth") const;  ///< the latest
  std::string fault() const;  ///< what the library could not read; empty: nothing
  bool closed() const { return closed_; }

  /// False where it does not happen within so many seconds.
  [[nodiscard]] bool wait_for(std::size_t forces, double longest_s, const std::string& device = "cForce") const;
  [[nodiscard]] bool wait_for_live(double longest_s) const;

 private:
  void receive();
  bool read_exactly(std::byte* to, std::size_t count);
  void take(const std::vector<std::byte>& message);

  igtl::ClientSocket::Pointer socket_;
  mutable std::mutex mutex_;
  std::map<std::string, std::vector<Force>> forces_;
  std::map<std::string, std::size_t> counts_;
  std::map<std::string, std::string> texts_;
  std::string fault_;
  std::atomic<bool> stopping_{false}, closed_{false};
  std::thread thread_;
};

}  // namespace palpate::serve_test
