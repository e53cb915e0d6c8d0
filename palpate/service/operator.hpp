// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/thread_pool.hpp>
#include <functional>
#include <nlohmann/json.hpp>
#include <palpate/identification/tare.hpp>
#include <palpate/service/board.hpp>
#include <palpate/service/observer_loop.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::service {

/// What a person at the table does while it runs: tare, register the base anew, say what the tendon pulls, take a note.
/// Each becomes an event of the recording, at its place between two frames. Lives on the network's thread; what takes
/// long (a tare, a new observer) is made on another.
class Operator {
 public:
  struct Answer {
    int http_status = 200;
    nlohmann::json body;
  };
  using Reply = std::function<void(const Answer&)>;

  /// `changed`: this catheter is another from now on.
  Operator(boost::asio::io_context& io, const HostClock& clock, ObserverLoop& loop, std::vector<CatheterView>& views,
           std::function<void(std::size_t catheter)> changed);

  /// `path` behind /api: "/catheters/NAME/tare", "/notes", ...; the answer comes by `reply`, once.
  void take(std::string_view path, const std::string& body, const Reply& reply);

  /// The [reference] of a catheter file, where its time has come.
  void look_for_reference();
  /// No work is left on the other thread.
  void finish() { pool_.join(); }

 private:
  void tare(std::size_t index, const TareInterval& interval, const Reply& reply);
  void base(std::size_t index, const nlohmann::json& body, const Reply& reply);
  void tendon(std::size_t index, const nlohmann::json& body, const Reply& reply);
  void note(const nlohmann::json& body, const Reply& reply);
  void exchange(std::size_t index, const std::string& event, const Catheter& catheter, nlohmann::json data,
                const Reply& reply);

  boost::asio::io_context& io_;
  const HostClock& clock_;
  boost::asio::thread_pool pool_{1};
  ObserverLoop& loop_;
  std::vector<CatheterView>& views_;
  std::function<void(std::size_t)> changed_;
};

}  // namespace palpate::service
