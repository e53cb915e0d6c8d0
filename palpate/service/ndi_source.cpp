// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <palpate/service/ndi_source.hpp>

namespace palpate::service {

NdiSource::NdiSource(const HostClock& clock, FrameQueue& queue, const std::vector<Watched>& watched,
                     std::function<void(const std::string& event, const std::string& why)> say)
    : queue_(queue),
      port_(watched.front().settings->source.path.string()),
      tracker_(tracker_options(watched),
               {[&clock] { return clock.now_ns(); },
                [this](const TrackerFrame& frame, std::int64_t received_ns) { take(frame, received_ns); },
                [say = std::move(say)](bool connected, const std::string& why) {
                  say(connected ? "connected" : "disconnected", why);
                }}) {
  std::size_t first = 0;
  for (const Watched& each : watched) {
    Target& target = targets_.emplace_back(Target{each.index, first, each.counters, {}});
    target.frame.readings.resize(each.settings->sensor_names.size());
    first += target.frame.readings.size();
  }
}

ndi::TrackerOptions NdiSource::tracker_options(const std::vector<Watched>& watched) {
  ndi::TrackerOptions options;
  options.device.path = watched.front().settings->source.path.string();
  options.sensors = 0;
  for (const Watched& each : watched) {
    options.sensors += each.settings->sensor_names.size();
    const auto& tools = each.settings->source.tools;
    for (const std::string& sensor : each.settings->sensor_names)
      if (const auto tool = tools.find(sensor); tool != tools.end())
        options.tools.push_back(ndi::parse_tool_name(tool->second).value());
  }
  return options;
}

void NdiSource::take(const TrackerFrame& frame, std::int64_t received_ns) {
  for (Target& target : targets_) {
    target.frame.time_s = frame.time_s;
    target.frame.number = frame.number;
    std::copy_n(frame.readings.begin() + static_cast<std::ptrdiff_t>(target.first), target.frame.readings.size(),
                target.frame.readings.begin());
    if (!queue_.put(target.index, received_ns, target.frame)) target.counters->queue_dropped.add();
  }
}

}  // namespace palpate::service
