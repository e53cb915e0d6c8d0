// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <map>
#include <palpate/ndi/faults.hpp>
#include <palpate/ndi/serial_port.hpp>
#include <system_error>

namespace palpate::ndi {

namespace {

constexpr int kWriteWait_ms = 100;  // 20 bytes at 9600 baud take 21 ms

speed_t speed(int baud) {
  static const std::map<int, speed_t> speeds{{9600, B9600},     {19200, B19200},   {38400, B38400},  {57600, B57600},
                                             {115200, B115200}, {230400, B230400}, {921600, B921600}};
  const auto found = speeds.find(baud);
  if (found == speeds.end()) throw LinkLost(fmt::format("{} baud: expected 9600 to 921600", baud));
  return found->second;
}

std::string reason(int error) { return std::error_code(error, std::generic_category()).message(); }

}  // namespace

SerialPort::SerialPort(const std::string& path, int baud)
    : path_(path), descriptor_(open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
  if (descriptor_ < 0) {
    const bool forbidden = errno == EACCES || errno == EPERM;
    throw LinkLost(fmt::format("{}: {}{}", path_, reason(errno), forbidden ? " (is the user in group dialout?)" : ""));
  }
  try {
    if (isatty(descriptor_) == 0) throw LinkLost(path_ + ": no serial port");
    if (ioctl(descriptor_, TIOCEXCL) != 0) fail("open");
    set_baud(baud);
    forget_input();
  } catch (...) {
    close(descriptor_);
    throw;
  }
}

SerialPort::~SerialPort() {
  ioctl(descriptor_, TIOCNXCL);
  close(descriptor_);
}

void SerialPort::fail(std::string_view action) const {
  throw LinkLost(fmt::format("{}: {}: {}", path_, action, reason(errno)));
}

void SerialPort::set_baud(int baud) {
  termios settings{};
  if (tcgetattr(descriptor_, &settings) != 0) fail("read its settings");
  cfmakeraw(&settings);
  settings.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
  cfsetispeed(&settings, speed(baud));
  cfsetospeed(&settings, speed(baud));
  if (tcsetattr(descriptor_, TCSANOW, &settings) != 0) fail("set its speed");
}

void SerialPort::set_break(bool on) {
  // A pseudo-terminal knows no break; that a device does not hear it shows in that no reset is told.
  [[maybe_unused]] const int ignored = ioctl(descriptor_, on ? TIOCSBRK : TIOCCBRK);
}

void SerialPort::forget_input() { tcflush(descriptor_, TCIFLUSH); }

void SerialPort::write(std::string_view text) {
  while (!text.empty()) {
    const ssize_t count = ::write(descriptor_, text.data(), text.size());
    if (count > 0) {
      text.remove_prefix(static_cast<std::size_t>(count));
      continue;
    }
    if (count < 0 && errno != EAGAIN && errno != EINTR) fail("write");
    pollfd output{descriptor_, POLLOUT, 0};
    if (poll(&output, 1, kWriteWait_ms) == 0) throw LinkLost(path_ + ": takes no bytes");
    if ((output.revents & (POLLERR | POLLHUP)) != 0) throw LinkLost(path_ + ": the port is gone");
  }
}

std::span<const std::byte> SerialPort::read(std::chrono::milliseconds wait) {
  pollfd input{descriptor_, POLLIN, 0};
  const int ready = poll(&input, 1, static_cast<int>(wait.count()));
  if (ready == 0 || (ready < 0 && errno == EINTR)) return {};
  const ssize_t count = ::read(descriptor_, bytes_.data(), bytes_.size());
  if (count > 0) return std::span(bytes_).first(static_cast<std::size_t>(count));
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return {};
  throw LinkLost(path_ + ": the port is gone");
}

}  // namespace palpate::ndi
