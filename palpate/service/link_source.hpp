// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <map>
#include <palpate/link/client.hpp>
#include <palpate/service/frame_queue.hpp>
#include <palpate/service/host_clock.hpp>
#include <palpate/service/live_assembler.hpp>
#include <palpate/service/live_catheter.hpp>
#include <palpate/service/settings.hpp>
#include <string>
#include <vector>

namespace palpate::service {

/// Poses from one OpenIGTLink server, for all catheters that it watches. Lives on the io_context's thread.
class LinkSource {
 public:
  /// A catheter of this server; its index and where its frames are counted.
  struct Watched {
    int index = 0;
    const CatheterSettings* settings = nullptr;
    CatheterCounters* counters = nullptr;
  };
  /// `say`: an event, "connected" or "disconnected", with the reason.
  LinkSource(boost::asio::io_context& io, const HostClock& clock, FrameQueue& queue,
             const std::vector<Watched>& watched,
             std::function<void(const std::string& event, const std::string& why)> say);

  void start() { client_.start(); }
  void stop();
  const link::ClientHealth& health() const { return client_.health(); }
  const std::string& server() const { return server_; }
  /// A device that no catheter knows, the latest; empty: none. A wrong name in the settings shows here.
  const std::string& unknown_device() const { return unknown_device_; }

 private:
  struct Target {
    std::size_t catheter, sensor;
  };
  struct Assembly {
    int index;
    CatheterCounters* counters;
    LiveAssembler frames;
  };

  void take(const link::Message& message);
  const std::vector<Target>* find(std::string_view device);
  void put(const Target& target, double time_s, const SensorReading& reading, std::int64_t now_ns);
  void send(Assembly& assembly, const TrackerFrame* frame);
  void close_overdue();
  void arm();

  const HostClock& clock_;
  FrameQueue& queue_;
  std::string server_, unknown_device_;
  std::vector<Assembly> assemblies_;
  std::map<std::string, std::vector<Target>, std::less<>> targets_;
  boost::asio::steady_timer timer_;
  bool armed_ = false;
  link::Client client_;
};

/// The sensor of a PLUS device name: `Tip` of `TipToTracker`.
std::string_view sensor_of_device(std::string_view device);

}  // namespace palpate::service
