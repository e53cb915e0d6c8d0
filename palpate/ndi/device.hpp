// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <palpate/ndi/reply_buffer.hpp>
#include <palpate/ndi/serial_port.hpp>
#include <palpate/ndi/tools.hpp>
#include <string>

namespace palpate::ndi {

struct DeviceOptions {
  std::string path;               ///< of the serial port
  int baud = 115200;              ///< while tracking; 9600, 115200, 230400 or 921600
  double setup_timeout_s = 5.0;   ///< of a command that prepares; INIT and PINIT read the tools
  double reply_timeout_s = 0.25;  ///< of BX
  double break_s = 0.1;           ///< how long the line is held down for a reset
  double after_comm_s = 0.1;      ///< from COMM's reply to the first command at the new speed
};

/// What one connection leaves for the next.
struct LineMemory {
  int baud = 9600;    ///< at which the device was heard last: tried first
  bool slow = false;  ///< the faster line did not work: stay at 9600
};

/// The device at the other end: from its reset to tracking, one command at a time. Whatever cannot be throws LinkLost
/// with the reason; so does every wait once `stopping` is true, within 20 ms.
class Device {
 public:
  Device(const DeviceOptions& options, LineMemory& memory, const std::atomic<bool>& stopping);

  /// INIT (after TSTOP where it still tracks, after a break where it does not answer), the faster line, PHSR, PHF of
  /// handles that are free, PINIT of new ones until no more appear (a plug may carry two sensors, and the second
  /// appears once the first is initialised), PHINF. What it has then.
  std::vector<Tool> prepare();
  /// Handles that prepare() could not initialise, with the device's own words; empty: none.
  const std::string& refused() const { return refused_; }
  /// PENA (dynamic) of these, TSTART.
  void track(const std::vector<std::uint8_t>& handles);
  /// BX, once; nothing where no answer comes in time. Throws MalformedReply too.
  std::optional<BxReply> poll();
  /// Everything away that still comes, until the line has been quiet for 20 ms, or `most_s` are over.
  void settle(double most_s = 0.1);
  /// TSTOP, and back to 9600 baud so that whoever comes next is heard. At most 0.17 s, throws nothing.
  void stop() noexcept;

 private:
  std::optional<Reply> receive(double seconds, bool heed_stopping = true);
  std::optional<TextReply> send(std::string_view name, std::string_view parameters, double seconds,
                                bool heed_stopping = true);
  TextReply ask(std::string_view name, std::string_view parameters = {});
  void pause(double seconds);
  bool initialise_at(int baud);
  void wake();
  void speed_up();
  void initialise_tools();
  std::vector<PortHandle> handles(std::string_view which);
  std::optional<PortLocation> location(std::uint8_t handle);

  DeviceOptions options_;
  LineMemory& memory_;
  const std::atomic<bool>& stopping_;
  SerialPort port_;
  ReplyBuffer buffer_;
  std::string refused_;
};

}  // namespace palpate::ndi
