// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <palpate/ndi/device.hpp>
#include <palpate/ndi/faults.hpp>
#include <set>
#include <thread>

namespace palpate::ndi {

namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr int kSlow = 9600;           // after a reset, by the guide
constexpr int kNotInThisMode = 0x0C;  // the answer to INIT of a device that still tracks
constexpr auto kSlice = 20ms;         // between two looks at `stopping`
constexpr int kRounds = 4;            // of initialising what initialising has brought up
constexpr double kEachFarewell_s = 0.06;
constexpr const char* kFree = "01";          // PHSR: handles to be freed
constexpr const char* kToInitialise = "02";  // PHSR: occupied, not initialised
constexpr const char* kAll = "00";           // PHSR: every handle
constexpr const char* kWhere = "0020";       // PHINF: where it is plugged in
constexpr const char* kDynamic = "D";        // PENA: a tool that moves
constexpr std::uint16_t kInitialised = 1U << 4;

Clock::duration duration(double seconds) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

/// COMM's parameters: speed, then 8 bits, no parity, 1 stop bit, no handshake. 230400 is A by the guide's second half.
std::string line_parameters(int baud) {
  const char* const digit = baud == 115200 ? "5" : baud == 921600 ? "6" : baud == 230400 ? "A" : "0";
  return fmt::format("{}0000", digit);
}

}  // namespace

Device::Device(const DeviceOptions& options, LineMemory& memory, const std::atomic<bool>& stopping)
    : options_(options), memory_(memory), stopping_(stopping), port_(options.path, kSlow) {}

std::optional<Reply> Device::receive(double seconds, bool heed_stopping) {
  const auto deadline = Clock::now() + duration(seconds);
  for (;;) {
    if (auto reply = buffer_.take()) return reply;
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    if (left <= 0ms) return std::nullopt;
    if (heed_stopping && stopping_.load(std::memory_order_acquire)) throw LinkLost("stopped");
    buffer_.append(port_.read(std::min<std::chrono::milliseconds>(left, kSlice)));
  }
}

/// The next reply in text; what BX still had to say is passed over.
std::optional<TextReply> Device::send(std::string_view name, std::string_view parameters, double seconds,
                                      bool heed_stopping) {
  port_.write(command(name, parameters));
  const auto deadline = Clock::now() + duration(seconds);
  while (auto reply = receive(std::chrono::duration<double>(deadline - Clock::now()).count(), heed_stopping))
    if (auto* const text = std::get_if<TextReply>(&*reply)) return std::move(*text);
  return std::nullopt;
}

TextReply Device::ask(std::string_view name, std::string_view parameters) {
  const std::string what = fmt::format("{}:{}", name, parameters);
  try {
    auto reply = send(name, parameters, options_.setup_timeout_s);
    if (!reply) throw LinkLost(fmt::format("{}: no answer for {} s", what, options_.setup_timeout_s));
    if (reply->kind == TextReply::Kind::kError)
      throw LinkLost(fmt::format("{}: {}", what, error_words(reply->error_code)));
    if (reply->kind == TextReply::Kind::kReset) throw LinkLost("the device was reset");
    return std::move(*reply);
  } catch (const MalformedReply& fault) {
    throw LinkLost(fmt::format("{}: {}", what, fault.what()));
  }
}

void Device::pause(double seconds) {
  for (const auto end = Clock::now() + duration(seconds); Clock::now() < end; std::this_thread::sleep_for(5ms))
    if (stopping_.load(std::memory_order_acquire)) throw LinkLost("stopped");
}

/// True where INIT was answered with OKAY at this speed. At a wrong one comes nothing, or rubbish.
bool Device::initialise_at(int baud) {
  port_.set_baud(baud);
  for (int attempt = 0; attempt < 2; ++attempt) {
    settle();
    try {
      auto reply = send("INIT", {}, options_.setup_timeout_s);
      if (!reply) return false;
      memory_.baud = baud;
      if (reply->kind == TextReply::Kind::kOkay) return true;
      if (reply->kind == TextReply::Kind::kError && reply->error_code != kNotInThisMode)
        throw LinkLost("INIT: " + error_words(reply->error_code));
      if (reply->kind == TextReply::Kind::kError) ask("TSTOP");
    } catch (const MalformedReply&) {  // once more: the rest of what was sent before
    }
  }
  return false;
}

void Device::wake() {
  const int other = memory_.baud == kSlow ? options_.baud : kSlow;
  if (initialise_at(memory_.baud) || (other != memory_.baud && initialise_at(other))) return;
  port_.set_baud(kSlow);
  port_.set_break(true);
  try {
    pause(options_.break_s);
  } catch (const LinkLost&) {
    port_.set_break(false);
    throw;
  }
  port_.set_break(false);
  try {
    receive(options_.setup_timeout_s);  // RESET, or whatever the break made of the line
  } catch (const MalformedReply&) {
  }
  if (!initialise_at(kSlow))
    throw LinkLost(fmt::format("{}: no answer at {} or {} baud, nor to a break", options_.path, kSlow, options_.baud));
}

void Device::speed_up() {
  if (memory_.baud != kSlow || options_.baud == kSlow || memory_.slow) return;
  const auto reply = send("COMM", line_parameters(options_.baud), options_.setup_timeout_s);
  if (!reply) throw LinkLost("COMM: no answer");
  if (reply->kind != TextReply::Kind::kOkay) return;  // it stays at the speed at which it is heard
  pause(options_.after_comm_s);
  port_.set_baud(options_.baud);
  memory_.baud = options_.baud;
  memory_.slow = true;  // until it is heard there
  handles(kAll);
  memory_.slow = false;
}

std::vector<PortHandle> Device::handles(std::string_view which) {
  try {
    return decode_port_handles(ask("PHSR", which).text);
  } catch (const MalformedReply& fault) {
    throw LinkLost(fault.what());
  }
}

/// A device that does not tell is no reason to stop: tools may be named by handle.
std::optional<PortLocation> Device::location(std::uint8_t handle) {
  const auto reply = send("PHINF", hex_handle(handle) + kWhere, options_.setup_timeout_s);
  if (!reply) throw LinkLost("PHINF: no answer");
  if (reply->kind != TextReply::Kind::kData) return std::nullopt;
  return decode_port_location(reply->text);
}

/// One that cannot be initialised may be one that nobody wants.
void Device::initialise_tools() {
  std::set<std::uint8_t> tried;
  for (int round = 0; round < kRounds; ++round) {
    const std::size_t before = tried.size();
    for (const PortHandle& each : handles(kToInitialise)) {
      if (!tried.insert(each.handle).second) continue;
      const auto reply = send("PINIT", hex_handle(each.handle), options_.setup_timeout_s);
      if (!reply) throw LinkLost("PINIT: no answer");
      if (reply->kind == TextReply::Kind::kError)
        refused_ += fmt::format("; {}: {}", hex_handle(each.handle), error_words(reply->error_code));
    }
    if (tried.size() == before) break;
  }
}

std::vector<Tool> Device::prepare() try {
  wake();
  speed_up();
  for (const PortHandle& each : handles(kFree)) ask("PHF", hex_handle(each.handle));
  initialise_tools();
  std::vector<Tool> out;
  for (const PortHandle& each : handles(kAll))
    if ((each.status & kInitialised) != 0) out.push_back({each.handle, location(each.handle)});
  return out;
} catch (const MalformedReply& fault) {
  throw LinkLost(fault.what());
}

void Device::track(const std::vector<std::uint8_t>& handles) {
  for (const std::uint8_t handle : handles) ask("PENA", hex_handle(handle) + kDynamic);
  ask("TSTART");
}

std::optional<BxReply> Device::poll() {
  port_.write(command("BX", kBxOptions));
  auto reply = receive(options_.reply_timeout_s);
  if (!reply) return std::nullopt;
  if (auto* const poses = std::get_if<BxReply>(&*reply)) return std::move(*poses);
  const auto& text = std::get<TextReply>(*reply);
  if (text.kind == TextReply::Kind::kError) throw LinkLost("BX: " + error_words(text.error_code));
  if (text.kind == TextReply::Kind::kReset) {
    memory_.baud = kSlow;
    throw LinkLost("the device was reset");
  }
  throw MalformedReply("BX: an answer in text");
}

void Device::settle(double most_s) {
  buffer_.clear();
  const auto end = Clock::now() + duration(most_s);
  while (Clock::now() < end && !port_.read(kSlice).empty()) {
  }
}

void Device::stop() noexcept {
  try {
    settle(2 * std::chrono::duration<double>(kSlice).count());
    const auto stopped = send("TSTOP", {}, kEachFarewell_s, false);
    if (stopped && memory_.baud != kSlow && send("COMM", line_parameters(kSlow), kEachFarewell_s, false))
      memory_.baud = kSlow;
  } catch (const std::exception&) {  // it is gone: the next connection finds out
  }
}

}  // namespace palpate::ndi
