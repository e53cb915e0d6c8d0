// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <palpate/math/errors.hpp>
#include <palpate/recording/tracker_csv.hpp>
#include <palpate/service/standard_input.hpp>

namespace palpate::service {

namespace {

constexpr const char* kName = "standard input";
constexpr std::size_t kLongestLine = 4096;
constexpr int kLook_ms = 5;  // for a frame that waits for a sensor, and for stop()

}  // namespace

StandardInput::StandardInput(const HostClock& clock, FrameQueue& queue, int catheter, const CatheterSettings& settings,
                             CatheterCounters& counters, std::function<void(const std::string&)> say, int descriptor)
    : clock_(clock),
      queue_(queue),
      catheter_(catheter),
      settings_(settings),
      counters_(counters),
      say_(std::move(say)),
      descriptor_(descriptor),
      frames_(settings.sensor_names.size(), nanoseconds(settings.source.hold_s)) {}

void StandardInput::run() {
  std::array<char, 65536> buffer{};
  while (!stopping_.load(std::memory_order_acquire)) {
    pollfd input{descriptor_, POLLIN, 0};
    if (poll(&input, 1, kLook_ms) > 0) {
      const ssize_t count = read(descriptor_, buffer.data(), buffer.size());
      if (count <= 0) break;
      pending_.append(buffer.data(), static_cast<std::size_t>(count));
      take_lines();
    }
    send(frames_.close_overdue(clock_.now_ns()));
  }
  send(frames_.close_now());
}

void StandardInput::take_lines() {
  std::size_t begin = 0;
  for (std::size_t end = pending_.find('\n'); end != std::string::npos; end = pending_.find('\n', begin)) {
    line_ = trim(std::string_view(pending_).substr(begin, end - begin));
    if (line_.ends_with('\r')) line_.pop_back();
    begin = end + 1;
    ++line_number_;
    if (!line_.empty()) take_line();
  }
  pending_.erase(0, begin);
  if (pending_.size() > kLongestLine)
    throw InputError(fmt::format("{}:{}: line '{}': expected at most {} characters", kName, line_number_ + 1,
                                 printable(pending_), kLongestLine));
}

void StandardInput::take_line() {
  if (header_.empty()) {
    if (!looks_like_tracker_csv(line_))
      throw InputError(fmt::format("{}:{}: line '{}': expected the header of a tracker CSV: time_s,frame,sensor,...",
                                   kName, line_number_, printable(line_)));
    header_ = line_;
    return;
  }
  try {
    const TrackerRecording row = parse_tracker_csv({.name = kName, .lines = {header_, line_}});
    const auto& names = settings_.sensor_names;
    const auto sensor = std::find(names.begin(), names.end(), row.sensor_names.front());
    if (sensor == names.end()) {
      const auto& ignored = settings_.settings.ignore_sensors;
      if (std::find(ignored.begin(), ignored.end(), row.sensor_names.front()) != ignored.end()) return;
      throw InputError(fmt::format("{}:2: field sensor: value '{}': expected a sensor of {}", kName,
                                   printable(row.sensor_names.front()), settings_.file));
    }
    const TrackerFrame& frame = row.frames.front();
    const std::int64_t now_ns = clock_.now_ns();
    send(frames_.close_before(frame.time_s));
    send(frames_.put(static_cast<std::size_t>(sensor - names.begin()), frame.time_s, frame.readings.front(), now_ns));
  } catch (const InputError& error) {
    const std::string here = fmt::format("{}:2:", kName);
    std::string what = error.what();
    if (what.starts_with(here)) what.replace(0, here.size(), fmt::format("{}:{}:", kName, line_number_));
    say_(what);
  }
}

void StandardInput::send(const TrackerFrame* frame) {
  if (frame != nullptr && !queue_.put(catheter_, frames_.opened_ns(), *frame)) counters_.queue_dropped.add();
}

}  // namespace palpate::service
