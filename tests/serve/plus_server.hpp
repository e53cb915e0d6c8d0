// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <igtlServerSocket.h>

#include <span>
#include <tests/serve/eventually.hpp>
#include <tests/serve/wire_frames.hpp>

namespace palpate::serve_test {

/// A PLUS server made of Debian's libopenigtlink, which shares no line with the program. It does what it is told, when
/// it is told: whoever wants it beside something else gives it a thread.
class PlusServer {
 public:
  /// Listens on any free port, or on this one. Throws where it cannot.
  explicit PlusServer(int port = 0);
  ~PlusServer();
  PlusServer(const PlusServer&) = delete;
  PlusServer& operator=(const PlusServer&) = delete;

  int port() const { return port_; }
  /// Waits for the program, and reads what it asks for; a connection before this one is closed then, not earlier.
  /// False: nobody came, or did not ask for STT_TDATA.
  [[nodiscard]] bool accept(double longest_s = 10.0);
  bool connected() const { return socket_.IsNotNull(); }

  /// One TRANSFORM a sensor, all with the frame's time stamp; false where the peer is gone.
  bool send(const WireFrame& frame);
  /// The same as one TDATA.
  bool send_tracking_data(const WireFrame& frame);
  bool send_raw(std::span<const std::byte> bytes);
  /// One frame after another by the clock, as long after the first as its number says. When each was sent.
  std::vector<Clock::time_point> play(const WireFrames& frames, double rate_hz, std::size_t from = 0,
                                      std::size_t to = std::size_t(-1));

  /// The connection alone.
  void hang_up();
  /// The connection is reset, as when the server crashes: the port is free again at once.
  void crash();
  /// Nobody listens on port() any more; until listen().
  void close();
  void listen();

 private:
  igtl::ServerSocket::Pointer server_;
  igtl::ClientSocket::Pointer socket_;
  int port_ = 0;
};

}  // namespace palpate::serve_test
