// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cmath>
#include <limits>
#include <palpate/session/estimate_numbers.hpp>
#include <palpate/session/row_codec.hpp>
#include <palpate/session/schema.hpp>

namespace palpate::session {

namespace {

/// FNV-1a over words of 64 bits, the high half folded down after each so that every bit counts.
class Checksum {
 public:
  void add(std::uint64_t word) {
    sum_ = (sum_ ^ word) * 0x100000001b3U;
    sum_ ^= sum_ >> 32U;
  }
  void add(std::int64_t word) { add(static_cast<std::uint64_t>(word)); }
  void add(double number) {
    add(std::bit_cast<std::uint64_t>(std::isnan(number) ? std::numeric_limits<double>::quiet_NaN() : number));
  }
  void add(std::string_view text) {
    add(static_cast<std::uint64_t>(text.size()));
    for (const char c : text) add(static_cast<std::uint64_t>(static_cast<unsigned char>(c)));
  }
  std::int64_t sum() const { return static_cast<std::int64_t>(sum_); }

 private:
  std::uint64_t sum_ = 0xcbf29ce484222325U;
};

template <typename Numbers>
void add_all(Checksum& sum, const Numbers& numbers) {
  for (const double number : numbers) sum.add(number);
}

void add_frame(Checksum& sum, const TrackerFrame& frame) {
  sum.add(frame.number);
  sum.add(frame.time_s);
  sum.add(given_bits(frame));
  LoadNumbers loads{};
  load_numbers_of(frame, loads);
  add_all(sum, loads);
  for (std::size_t i = 0; i < frame.readings.size(); ++i) {
    const SensorReading& reading = frame.readings[i];
    if (reading.status == SensorReading::Status::kAbsent) continue;
    sum.add(static_cast<std::uint64_t>(i));
    sum.add(static_cast<std::int64_t>(reading.status) + (reading.has_orientation ? 16 : 0));
    add_all(sum, reading.quaternion_wxyz);
    add_all(sum, reading.position_m);
    sum.add(reading.error_m);
  }
}

void add_estimate(Checksum& sum, const Estimate& e) {
  EstimateNumbers numbers{};
  numbers_of(e, numbers);
  add_all(sum, numbers);
  sum.add(static_cast<std::int64_t>(e.status));
  sum.add(static_cast<std::int64_t>(e.time));
  sum.add(static_cast<std::int64_t>(e.used));
  for (const int count : {e.sensors_used, e.dof, e.jumped ? 1 : 0, e.evaluations})
    sum.add(static_cast<std::int64_t>(count));
  sum.add(packed_rejections(e));
  sum.add(observability_bits(e.observability));
  if (!has_extra(e)) return;
  ExtraNumbers extra{};
  extra_numbers_of(e, extra);
  add_all(sum, extra);
  sum.add(static_cast<std::int64_t>(e.lagged.age_frames));
}

}  // namespace

std::int64_t checksum(const LiveRecord& record, std::int64_t id) {
  Checksum sum;
  sum.add(id);
  sum.add(static_cast<std::int64_t>(record.catheter));
  sum.add(record.received_ns);
  sum.add(record.output_time_s);
  if (record.kind == LiveRecord::Kind::kFrame) {
    add_frame(sum, record.frame);
  } else {
    sum.add(std::string_view(record.event));
    sum.add(std::string_view(record.data));
  }
  return sum.sum();
}

std::int64_t checksum(const Estimate& estimate, std::int64_t id) {
  Checksum sum;
  sum.add(id);
  add_estimate(sum, estimate);
  return sum.sum();
}

std::int64_t checksum(const SessionCatheter& catheter, std::int64_t id) {
  Checksum sum;
  sum.add(id);
  sum.add(std::string_view(catheter.name));
  sum.add(std::string_view(catheter.file));
  sum.add(std::string_view(catheter.toml));
  for (const std::string_view name : catheter.sensor_names) sum.add(name);
  return sum.sum();
}

}  // namespace palpate::session
