// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <tests/ndi/aurora_simulator.hpp>

namespace palpate::test {

namespace {

std::string hex4(unsigned value) {
  std::array<char, 8> out{};
  std::snprintf(out.data(), out.size(), "%04X", value & 0xFFFFU);
  return out.data();
}

void put16(std::string& out, unsigned value) {
  out.push_back(static_cast<char>(value & 0xFF));
  out.push_back(static_cast<char>(value >> 8 & 0xFF));
}
void put32(std::string& out, std::uint32_t value) {
  put16(out, value & 0xFFFF);
  put16(out, value >> 16);
}
void put_float(std::string& out, double value) {
  const auto narrow = static_cast<float>(value);
  std::uint32_t bits = 0;
  std::memcpy(&bits, &narrow, sizeof bits);
  put32(out, bits);
}

}  // namespace

/// Bits of the remainder from highest to lowest power, message bits from the lowest of each byte: the long division
/// itself by x^16 + x^15 + x^2 + 1, one bit at a time, and the remainder turned round at the end.
std::uint16_t long_division(const std::string& bytes) {
  std::uint32_t remainder = 0;
  for (const char byte : bytes)
    for (int bit = 0; bit < 8; ++bit) {
      const std::uint32_t in = static_cast<unsigned char>(byte) >> bit & 1U, out = remainder >> 15 & 1U;
      remainder = remainder << 1 & 0xFFFFU;
      if ((in ^ out) != 0) remainder ^= 0x8005U;
    }
  std::uint16_t turned = 0;
  for (int bit = 0; bit < 16; ++bit)
    if ((remainder >> bit & 1U) != 0) turned = static_cast<std::uint16_t>(turned | 1U << (15 - bit));
  return turned;
}

AuroraSimulator::AuroraSimulator(std::filesystem::path link, Script script)
    : link_(std::move(link)), script_(std::move(script)), tracking_(script_.tracks_already) {
  master_ = posix_openpt(O_RDWR | O_NOCTTY);
  std::array<char, 128> name{};
  if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0 ||
      ptsname_r(master_, name.data(), name.size()) != 0)
    throw std::runtime_error("no pseudo-terminal");
  slave_ = open(name.data(), O_RDWR | O_NOCTTY);  // kept open: no hang-up while nobody else has it
  termios raw{};
  tcgetattr(slave_, &raw);
  cfmakeraw(&raw);
  tcsetattr(slave_, TCSANOW, &raw);
  std::filesystem::remove(link_);
  std::filesystem::create_symlink(name.data(), link_);
  initialised_ = tracking_;
  if (tracking_) ready_ = enabled_ = {true, true};
  thread_ = std::thread([this] { run(); });
}

AuroraSimulator::~AuroraSimulator() {
  stopping_ = true;
  thread_.join();
  std::filesystem::remove(link_);
  close(slave_);
  close(master_);
}

std::vector<std::string> AuroraSimulator::commands() const {
  const std::lock_guard lock(mutex_);
  return commands_;
}

void AuroraSimulator::run() {
  std::string pending;
  while (!stopping_) {
    pollfd input{master_, POLLIN, 0};
    if (poll(&input, 1, 5) <= 0) continue;
    std::array<char, 256> bytes{};
    const ssize_t count = read(master_, bytes.data(), bytes.size());
    if (count <= 0) continue;
    pending.append(bytes.data(), static_cast<std::size_t>(count));
    for (std::size_t end; (end = pending.find('\r')) != std::string::npos; pending.erase(0, end + 1))
      take(pending.substr(0, end));
  }
}

void AuroraSimulator::take(const std::string& line) {
  if (script_.needs_break) return;
  const std::size_t colon = line.find(':'), space = line.find(' ');
  std::string name, parameters;
  if (colon != std::string::npos) {
    const std::string text = line.substr(0, line.size() - 4);
    if (line.size() < colon + 5 || line.substr(text.size()) != hex4(long_division(text))) return send_text("ERROR04");
    name = text.substr(0, colon);
    parameters = text.substr(colon + 1);
  } else if (space != std::string::npos) {
    name = line.substr(0, space);
    parameters = line.substr(space + 1);
  } else {
    return send_text("ERROR01");
  }
  if (name == "BX" && tracking_) return answer_bx();
  {
    const std::lock_guard lock(mutex_);
    commands_.push_back(name + ":" + parameters);
  }
  if (script_.wrong_init_checksum) {
    script_.wrong_init_checksum = false;
    return send("OKAY0000\r");
  }
  send_text(reply_to(name, parameters));
}

std::string AuroraSimulator::reply_to(const std::string& name, const std::string& parameters) {
  const int index = parameters.size() >= 2 && parameters[0] == '0' ? parameters[1] - 'A' : -1;
  const bool handle = index >= 0 && index < script_.handles;
  if (name == "TSTOP") return tracking_ ? (tracking_ = false, "OKAY") : "ERROR0C";
  if (name == "BX" || tracking_) return "ERROR0C";
  if (name == "INIT") {
    initialised_ = true;
    ready_ = enabled_ = {};
    return "OKAY";
  }
  if (!initialised_) return "ERROR10";
  if (name == "COMM") return script_.refuses_fast_line ? "ERROR06" : "OKAY";
  if (name == "PHSR") return port_list(parameters);
  if (name == "TSTART") return (tracking_ = enabled_[0] || enabled_[1]) ? "OKAY" : "ERROR12";
  if (!handle) return "ERROR08";
  const auto i = static_cast<std::size_t>(index);
  if (name == "PINIT") return ready_[i] = true, "OKAY";
  if (name == "PHINF") return parameters.substr(2) == "0020" ? fmt::format("3A12345610010{}", i) : "ERROR09";
  if (name == "PENA")
    return !ready_[i] ? "ERROR0E" : parameters.substr(2) != "D" ? "ERROR09" : (enabled_[i] = true, "OKAY");
  return "ERROR01";
}

std::string AuroraSimulator::port_list(const std::string& which) const {
  std::string entries;
  int count = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(script_.handles); ++i) {
    if (which == "01" || (i == 1 && !ready_[0]) || (which == "02" && ready_[i])) continue;
    entries += std::string("0") + static_cast<char>('A' + i) + (enabled_[i] ? "031" : ready_[i] ? "011" : "001");
    ++count;
  }
  return fmt::format("0{}{}", count, entries);
}

void AuroraSimulator::answer_bx() {
  const int question = questions_++;
  const int last = static_cast<int>(script_.frames.size()) - 1;
  std::string bytes = bx(std::min(question / script_.questions_a_frame, last));
  const auto fault = script_.faults.find(question);
  if (fault == script_.faults.end()) return send(bytes);
  switch (fault->second) {
    case Fault::kDroppedByte:
      return send(bytes.erase(20, 1));
    case Fault::kFlippedBit:
      bytes[20] = static_cast<char>(bytes[20] ^ 0x10);
      return send(bytes);
    case Fault::kError:
      return send_text("ERROR0C");
    case Fault::kRubbish:
      return send("\xC4\xA5\xFF\xFF\x01\x02 rubbish \r\r");
    case Fault::kReset:
      tracking_ = initialised_ = false;
      ready_ = enabled_ = {};
      return send_text("RESET");
    case Fault::kSplit:
      for (const char byte : bytes) send(std::string(1, byte));
      return;
    case Fault::kSilent:
      return;
  }
}

std::string AuroraSimulator::bx(int frame) const {
  const TrackerFrame& now = script_.frames[static_cast<std::size_t>(frame)];
  std::string body(1, '\x02');
  for (std::size_t i = 0; i < 2; ++i) {
    body.push_back(static_cast<char>(0x0A + i));
    if (!enabled_[i] || (i == 1 && script_.unplugged.contains(frame))) {
      body.push_back('\x04');
      continue;
    }
    const SensorReading& reading = now.readings[i];
    const bool seen = reading.status == SensorReading::Status::kOk;
    body.push_back(seen ? '\x01' : '\x02');
    if (seen) {
      for (Eigen::Index k = 0; k < 4; ++k) put_float(body, reading.quaternion_wxyz(k));
      for (Eigen::Index k = 0; k < 3; ++k) put_float(body, 1000.0 * reading.position_m(k));
      put_float(body, 0.25 + 0.5 * static_cast<double>(i));
    }
    put32(body, i == 1 && script_.outside.contains(frame) ? 0x71 : 0x31);
    put32(body, script_.first_number + static_cast<std::uint32_t>(frame) -
                    (i == 1 && script_.behind.contains(frame) ? 1 : 0));
  }
  put16(body, script_.port_occupied_from >= 0 && questions_ > script_.port_occupied_from ? 0x40 : 0);
  std::string out("\xC4\xA5");
  put16(out, static_cast<unsigned>(body.size()));
  put16(out, long_division(out));
  out += body;
  put16(out, long_division(body));
  return out;
}

void AuroraSimulator::send(const std::string& bytes) {
  [[maybe_unused]] const ssize_t count = write(master_, bytes.data(), bytes.size());
}

void AuroraSimulator::send_text(const std::string& text) { send(text + hex4(long_division(text)) + "\r"); }

}  // namespace palpate::test
