// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <palpate_ros2/mapping.hpp>
#include <vector>

namespace palpate_ros2 {

/// Makes tracker frames of poses that come one by one: those of one stamp are one frame.
///
/// A frame is ready when every sensor has spoken, or when so many later ones have begun that more than `depth` wait: a
/// sensor that is silent is missing from it. A reading whose frame is gone is dropped and counted; one from more than a
/// second before it is a new start (a bag that is played again), which the observer's clock judges.
class FrameAssembler {
 public:
  struct Frame {
    std::int64_t stamp_ns = 0;
    palpate::TrackerFrame frame;
  };

  explicit FrameAssembler(std::size_t sensors, std::size_t depth = 2) : sensors_(sensors), depth_(depth) {}

  /// The frames that this pose completes, in time order; mostly none or one.
  template <PoseStamped Message>
  std::vector<Frame> add(std::size_t sensor, const Message& message) {
    return add(sensor, nanoseconds(message.header.stamp), to_reading(message));
  }

  std::int64_t late() const { return late_; }

 private:
  static constexpr std::int64_t kRestart_ns = 1'000'000'000;
  using Readings = std::vector<palpate::SensorReading>;

  std::vector<Frame> add(std::size_t sensor, std::int64_t stamp_ns, const palpate::SensorReading& reading) {
    if (number_ > 0 && stamp_ns <= last_ns_) {
      if (last_ns_ - stamp_ns < kRestart_ns) {
        ++late_;
        return {};
      }
      pending_.clear();
      last_ns_ = stamp_ns - 1;
    }
    if (!started_) origin_ns_ = stamp_ns;
    started_ = true;
    Readings& readings = pending_.try_emplace(stamp_ns, sensors_).first->second;
    readings.at(sensor) = reading;
    std::vector<Frame> ready;
    if (is_complete(readings))
      while (!pending_.empty() && pending_.begin()->first <= stamp_ns) ready.push_back(take_oldest());
    while (pending_.size() > depth_) ready.push_back(take_oldest());
    return ready;
  }

  static bool is_complete(const Readings& readings) {
    for (const palpate::SensorReading& reading : readings)
      if (reading.status != palpate::SensorReading::Status::kOk) return false;
    return true;
  }

  Frame take_oldest() {
    const auto oldest = pending_.extract(pending_.begin());
    last_ns_ = oldest.key();
    Frame out;
    out.stamp_ns = last_ns_;
    // From the first stamp on: seconds since 1970 leave a double a quarter of a microsecond.
    out.frame.time_s = 1e-9 * static_cast<double>(last_ns_ - origin_ns_);
    out.frame.number = ++number_;
    out.frame.readings = oldest.mapped();
    return out;
  }

  std::size_t sensors_, depth_;
  std::map<std::int64_t, Readings> pending_;
  bool started_ = false;
  std::int64_t origin_ns_ = 0, last_ns_ = 0, late_ = 0, number_ = 0;
};

}  // namespace palpate_ros2
