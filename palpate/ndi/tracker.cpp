// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <palpate/ndi/faults.hpp>
#include <palpate/ndi/tracker.hpp>
#include <thread>

namespace palpate::ndi {

namespace {

using namespace std::chrono_literals;

constexpr int kMostUnanswered = 3, kMostMalformed = 10;  // one after the other
constexpr double kSecondsPerNanosecond = 1e-9;

/// By how much a 32-bit counter went on; negative: back.
std::int64_t step(std::uint32_t from, std::uint32_t to) { return static_cast<std::int32_t>(to - from); }

const HandleReading* find(const BxReply& reply, std::uint8_t handle) {
  const auto found = std::find_if(reply.handles.begin(), reply.handles.end(),
                                  [handle](const HandleReading& each) { return each.handle == handle; });
  return found == reply.handles.end() || found->status == HandleReading::Status::kDisabled ? nullptr : &*found;
}

/// Of these handles; nothing where none is enabled.
std::optional<std::uint32_t> newest_number(const BxReply& reply, const std::vector<std::uint8_t>& handles) {
  std::optional<std::uint32_t> newest;
  for (const std::uint8_t handle : handles)
    if (const HandleReading* const reading = find(reply, handle))
      if (!newest || step(*newest, reading->frame_number) > 0) newest = reading->frame_number;
  return newest;
}

}  // namespace

Tracker::Tracker(TrackerOptions options, Handlers handlers)
    : options_(std::move(options)),
      handlers_(std::move(handlers)),
      clock_(options_.period_s),
      wait_s_(options_.first_wait_s) {
  frame_.readings.resize(options_.sensors);
}

void Tracker::run() {
  while (!stopping()) {
    try {
      connect_and_track();
    } catch (const LinkLost& lost) {
      if (stopping()) break;
      say(false, lost.what());
      wait(wait_s_);
      wait_s_ = std::min(2.0 * wait_s_, options_.longest_wait_s);
    }
  }
  const std::lock_guard lock(mutex_);
  health_.connected = false;
}

TrackerHealth Tracker::health() const {
  const std::lock_guard lock(mutex_);
  return health_;
}

void Tracker::connect_and_track() {
  Device device(options_.device, memory_, stopping_);
  try {
    const std::vector<Tool> tools = device.prepare();
    try {
      handles_ = choose_tools(tools, options_.tools, options_.sensors);
    } catch (const LinkLost& lost) {
      throw LinkLost(lost.what() + device.refused());
    }
    device.track(handles_);
    say(true, {});
    follow(device);
  } catch (const LinkLost&) {
    if (stopping()) device.stop();
    throw;
  }
  device.stop();
}

/// Asks until stop(). Throws LinkLost.
void Tracker::follow(Device& device) {
  int unanswered = 0, malformed = 0;
  std::optional<std::uint16_t> system_status;
  while (!stopping()) {
    const auto next = std::chrono::steady_clock::now() + std::chrono::duration<double>(options_.least_poll_s);
    try {
      if (const auto reply = device.poll()) {
        take(*reply, handlers_.now_ns());
        unanswered = malformed = 0;
        // A bit that was there when tracking began says nothing new.
        const auto risen = static_cast<std::uint16_t>(reply->system_status & ~system_status.value_or(0xFFFF));
        if ((risen & system_bits::kPortOccupied) != 0) throw LinkLost("a tool was plugged in");
        system_status = reply->system_status;
      } else {
        device.settle();
        const std::lock_guard lock(mutex_);
        ++health_.unanswered;
        if (++unanswered >= kMostUnanswered) throw LinkLost("the device is silent");
      }
    } catch (const MalformedReply& fault) {
      device.settle();
      const std::lock_guard lock(mutex_);
      ++health_.malformed;
      if (++malformed >= kMostMalformed) throw LinkLost(fault.what());
    }
    std::this_thread::sleep_until(next);
  }
}

void Tracker::take(const BxReply& reply, std::int64_t now_ns) {
  const auto number = newest_number(reply, handles_);
  if (!number) return;  // every tool is unplugged: nobody measures
  const std::int64_t frames = any_frame_ ? step(last_number_, *number) : 0;
  if (any_frame_ && frames == 0) {
    const std::lock_guard lock(mutex_);
    ++health_.repeats;
    return;
  }
  frame_.time_s = clock_.stamp(frames, kSecondsPerNanosecond * static_cast<double>(now_ns));
  frame_.number = any_frame_ ? frame_.number + std::max<std::int64_t>(frames, 1) : std::int64_t{*number};
  last_number_ = *number;
  any_frame_ = true;
  fill(reply, *number);
  handlers_.frame(frame_, now_ns);
  wait_s_ = options_.first_wait_s;
}

void Tracker::fill(const BxReply& reply, std::uint32_t number) {
  std::uint64_t outside = 0;
  for (std::size_t i = 0; i < handles_.size(); ++i) {
    const HandleReading* const reading = find(reply, handles_[i]);
    frame_.readings[i] = reading != nullptr ? sensor_reading(*reading) : SensorReading{};
    if (reading == nullptr) continue;
    if (reading->frame_number != number && frame_.readings[i].status == SensorReading::Status::kOk)
      frame_.readings[i].status = SensorReading::Status::kAbsent;
    outside += (reading->port_status & port_bits::kOutOfVolume) != 0 ? 1 : 0;
  }
  const std::lock_guard lock(mutex_);
  ++health_.frames;
  health_.out_of_volume += outside;
}

void Tracker::say(bool connected, const std::string& why) {
  {
    const std::lock_guard lock(mutex_);
    if (said_ && health_.connected == connected && health_.error == why) return;
    said_ = true;
    health_.connections += connected ? 1 : 0;
    health_.connected = connected;
    health_.error = why;
  }
  handlers_.state(connected, why);
}

void Tracker::wait(double seconds) const {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!stopping() && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(5ms);
}

}  // namespace palpate::ndi
