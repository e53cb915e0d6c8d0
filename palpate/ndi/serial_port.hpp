// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace palpate::ndi {

/// A serial port, raw, 8 data bits, no parity, 1 stop bit, no handshake; ours alone while it is open. A pseudo-terminal
/// is one too: it takes any speed. Everything that fails throws LinkLost, which says what to do where that is known.
class SerialPort {
 public:
  SerialPort(const std::string& path, int baud);
  ~SerialPort();
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  /// 9600, 19200, 38400, 57600, 115200, 230400 or 921600.
  void set_baud(int baud);
  /// The line held down, by which the device is reset.
  void set_break(bool on);
  void forget_input();
  void write(std::string_view text);
  /// What has come, or comes first, within `wait`; empty: nothing. Valid until the next call.
  std::span<const std::byte> read(std::chrono::milliseconds wait);

 private:
  [[noreturn]] void fail(std::string_view action) const;

  std::string path_;
  int descriptor_;
  std::array<std::byte, 4096> bytes_{};
};

}  // namespace palpate::ndi
