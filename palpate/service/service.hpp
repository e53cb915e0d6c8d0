// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <palpate/service/settings.hpp>

namespace palpate::service {

/// The running instrument: sources -> observer -> recording, OpenIGTLink, dashboard.
///
///   network thread    OpenIGTLink in and out, what the dashboard is told and asks for; the one that calls run()
///   web thread        the dashboard's connections (http::Server), behind all others: a flood costs nobody else
///   player, reader    recordings and simulations by the clock; standard input; one for each serial port
///   observer thread   every frame of every catheter (ObserverLoop); waits for nobody
///   recorder thread   SQLite (SessionWriter)
///   a worker          tares, beside the network
class Service {
 public:
  /// Reads what is to be played, binds the ports, opens the recording. Throws InputError where something cannot be;
  /// nothing has then been begun.
  explicit Service(Settings settings);
  ~Service();
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  /// Until SIGINT or SIGTERM, or until every source has ended and all it brought has been delivered. `look`, if given,
  /// is called twice a second, from this thread. Throws InputError where standard input is no tracker CSV.
  void run(const std::function<void()>& look = {});

  /// Once run() is over: the recording is closed, no thread is left. The health at the very end.
  nlohmann::json finish();

  /// From run()'s thread, or while nothing runs. Ports: 0 where there is no such server.
  nlohmann::json health() const;
  std::uint16_t link_port() const;
  std::uint16_t dashboard_port() const;
  /// What every request to the dashboard's port must bring.
  const std::string& token() const;
  /// What a person opens in a browser, token included; empty where there is no dashboard.
  std::string dashboard_address() const;
  const std::vector<std::string>& warnings() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace palpate::service
