// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <palpate/service/link_source.hpp>
#include <palpate/service/pose_message.hpp>

namespace palpate::service {

namespace {

link::ClientOptions client_options(const SourceSettings& source) {
  link::ClientOptions options;
  options.host = source.host;
  options.port = source.port;
  return options;
}

}  // namespace

std::string_view sensor_of_device(std::string_view device) {
  const std::size_t to = device.find("To");
  return to == std::string_view::npos || to == 0 ? device : device.substr(0, to);
}

LinkSource::LinkSource(boost::asio::io_context& io, const HostClock& clock, FrameQueue& queue,
                       const std::vector<Watched>& watched,
                       std::function<void(const std::string& event, const std::string& why)> say)
    : clock_(clock),
      queue_(queue),
      server_(fmt::format("{}:{}", watched.front().settings->source.host, watched.front().settings->source.port)),
      timer_(io),
      client_(io, client_options(watched.front().settings->source),
              {[this](const link::Message& message) { take(message); },
               [say = std::move(say)](bool connected, const std::string& why) {
                 say(connected ? "connected" : "disconnected", why);
               }}) {
  for (const Watched& each : watched) {
    const SourceSettings& source = each.settings->source;
    const auto& names = each.settings->sensor_names;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto device = source.devices.find(names[i]);
      targets_[device == source.devices.end() ? names[i] : device->second].push_back({assemblies_.size(), i});
    }
    assemblies_.push_back({each.index, each.counters, LiveAssembler(names.size(), nanoseconds(source.hold_s))});
  }
}

void LinkSource::stop() {
  timer_.cancel();
  client_.stop();
}

/// By its whole name, else as PLUS builds it: `TipToTracker` is the sensor Tip.
const std::vector<LinkSource::Target>* LinkSource::find(std::string_view device) {
  auto found = targets_.find(device);
  if (found == targets_.end()) found = targets_.find(sensor_of_device(device));
  if (found != targets_.end()) return &found->second;
  if (unknown_device_ != device) unknown_device_ = device;
  return nullptr;
}

void LinkSource::take(const link::Message& message) {
  const std::int64_t now_ns = clock_.now_ns();
  // Without a time of its own, a message is of the time at which it came.
  const double time_s = message.time_s == 0.0 ? kSecondsPerNanosecond * static_cast<double>(now_ns) : message.time_s;
  for_each_pose(message, [&](std::string_view device, const SensorReading& reading) {
    if (const std::vector<Target>* const targets = find(device))
      for (const Target& target : *targets) put(target, time_s, reading, now_ns);
  });
  // TDATA is whole: what is not in it will not come.
  if (std::holds_alternative<link::TrackingData>(message.body) ||
      std::holds_alternative<link::QuaternionTrackingData>(message.body))
    for (Assembly& assembly : assemblies_) send(assembly, assembly.frames.close_now());
  arm();
}

void LinkSource::put(const Target& target, double time_s, const SensorReading& reading, std::int64_t now_ns) {
  Assembly& assembly = assemblies_[target.catheter];
  send(assembly, assembly.frames.close_before(time_s));
  send(assembly, assembly.frames.put(target.sensor, time_s, reading, now_ns));
  assembly.counters->late_readings.set(assembly.frames.late_readings());
}

void LinkSource::send(Assembly& assembly, const TrackerFrame* frame) {
  if (frame != nullptr && !queue_.put(assembly.index, assembly.frames.opened_ns(), *frame))
    assembly.counters->queue_dropped.add();
}

void LinkSource::close_overdue() {
  const std::int64_t now_ns = clock_.now_ns();
  for (Assembly& assembly : assemblies_) send(assembly, assembly.frames.close_overdue(now_ns));
  arm();
}

void LinkSource::arm() {
  if (armed_) return;
  const auto open = std::find_if(assemblies_.begin(), assemblies_.end(),
                                 [](const Assembly& assembly) { return assembly.frames.open(); });
  if (open == assemblies_.end()) return;
  armed_ = true;
  timer_.expires_after(
      std::chrono::nanoseconds(std::max<std::int64_t>(open->frames.deadline_ns() - clock_.now_ns(), 0)));
  timer_.async_wait([this](const boost::system::error_code& error) {
    armed_ = false;
    if (!error) close_overdue();
  });
}

}  // namespace palpate::service
