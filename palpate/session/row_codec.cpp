// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <palpate/session/estimate_numbers.hpp>
#include <palpate/session/row_codec.hpp>
#include <palpate/session/schema.hpp>

namespace palpate::session {

namespace {

constexpr std::int64_t kTendon = 1, kBend = 2, kInside = 4, kLoad = 8, kInBase = 16;
constexpr std::size_t kTendonNumbers = 3, kBendNumbers = 4, kLoadNumbers = 4;

/// Binds from left to right.
class Binder {
 public:
  explicit Binder(store::Statement& row) : row_(row) {}
  /// +0 as an integer: it takes no room in the file, and reads back the same.
  void number(double value) {
    const int parameter = ++at_;
    if (std::bit_cast<std::uint64_t>(value) == 0)
      row_.bind(parameter, std::int64_t{0});
    else
      row_.bind(parameter, value);
  }
  template <typename Numbers>
  void numbers(const Numbers& values) {
    for (const double value : values) number(value);
  }
  void integer(std::int64_t value) { row_.bind(++at_, value); }
  void word(std::string_view value) { row_.bind_word(++at_, value); }
  void skip(std::size_t columns) { at_ += static_cast<int>(columns); }

 private:
  store::Statement& row_;
  int at_ = 0;
};

/// Takes from left to right.
class Taker {
 public:
  explicit Taker(const store::Statement& row) : row_(row) {}
  void number(double& value) { value = row_.number(at_++); }
  template <typename Numbers>
  void numbers(Numbers& values) {
    for (double& value : values) number(value);
  }
  std::int64_t integer() { return row_.integer(at_++); }
  std::string text() { return row_.text(at_++); }

 private:
  const store::Statement& row_;
  int at_ = 0;
};

/// The code whose word this is; false where there is none.
template <typename Code>
bool find_word(std::string_view word, std::size_t codes, Code& code) {
  for (std::size_t i = 0; i < codes; ++i)
    if (word == describe(static_cast<Code>(i))) {
      code = static_cast<Code>(i);
      return true;
    }
  return false;
}

template <typename Visit>
void visit_loads(auto& frame, const Visit& visit) {
  const auto all = [&](auto& vector) {
    for (auto& value : vector) visit(value);
  };
  all(frame.tendon.moment_Nm);
  visit(frame.tendon.sigma_Nm);
  all(frame.bend.change_per_m);
  all(frame.bend.sigma_per_m);
  all(frame.known_load.force_N);
  visit(frame.known_load.sigma_N);
}

/// What is not given is as in a frame that was never told of it, whatever lies in the numbers.
void take_loads(std::int64_t given, const LoadNumbers& numbers, TrackerFrame& frame) {
  std::size_t i = 0;
  visit_loads(frame, [&](double& value) { value = numbers[i++]; });
  frame.tendon.present = (given & kTendon) != 0;
  frame.bend.present = (given & kBend) != 0;
  frame.bend.inside = (given & kInside) != 0;
  frame.known_load.present = (given & kLoad) != 0;
  frame.known_load.in_base = (given & kInBase) != 0;
  if (!frame.tendon.present) frame.tendon = {};
  if (!frame.bend.present) frame.bend = {};
  if (!frame.known_load.present) frame.known_load = {};
}

}  // namespace

std::int64_t given_bits(const TrackerFrame& frame) {
  std::int64_t bits = frame.tendon.present ? kTendon : 0;
  if (frame.bend.present) bits |= kBend | (frame.bend.inside ? kInside : 0);
  if (frame.known_load.present) bits |= kLoad | (frame.known_load.in_base ? kInBase : 0);
  return bits;
}

void load_numbers_of(const TrackerFrame& frame, LoadNumbers& numbers) {
  std::size_t i = 0;
  visit_loads(frame, [&](const double& value) { numbers[i++] = value; });
  const auto clear = [&](bool given, std::size_t first, std::size_t count) {
    for (std::size_t k = first; !given && k < first + count; ++k) numbers[k] = 0.0;
  };
  clear(frame.tendon.present, 0, kTendonNumbers);
  clear(frame.bend.present, kTendonNumbers, kBendNumbers);
  clear(frame.known_load.present, kTendonNumbers + kBendNumbers, kLoadNumbers);
}

void bind_frame(store::Statement& row, const LiveRecord& record, std::int64_t id, std::int64_t checksum) {
  const TrackerFrame& frame = record.frame;
  Binder bind(row.clear());
  bind.integer(id);
  bind.integer(record.catheter);
  bind.integer(frame.number);
  bind.number(frame.time_s);
  bind.integer(record.received_ns);
  bind.number(record.output_time_s);
  bind.integer(given_bits(frame));
  LoadNumbers loads{};
  load_numbers_of(frame, loads);
  const auto group = [&](bool given, std::size_t first, std::size_t count) {
    if (!given) return bind.skip(count);  // NULL
    for (std::size_t i = first; i < first + count; ++i) bind.number(loads[i]);
  };
  group(frame.tendon.present, 0, kTendonNumbers);
  group(frame.bend.present, kTendonNumbers, kBendNumbers);
  group(frame.known_load.present, kTendonNumbers + kBendNumbers, kLoadNumbers);
  bind.integer(checksum);
}

bool take_frame(const store::Statement& row, LiveRecord& record, std::int64_t& checksum) {
  Taker take(row);
  take.integer();
  record.kind = LiveRecord::Kind::kFrame;
  record.catheter = static_cast<int>(take.integer());
  record.frame.number = take.integer();
  take.number(record.frame.time_s);
  record.received_ns = take.integer();
  take.number(record.output_time_s);
  const std::int64_t given = take.integer();
  LoadNumbers loads{};
  take.numbers(loads);
  take_loads(given, loads, record.frame);
  checksum = take.integer();
  return given == given_bits(record.frame);
}

void bind_reading(store::Statement& row, const SensorReading& reading, std::int64_t id) {
  Binder bind(row);
  bind.integer(id);
  bind.word(reading.status == SensorReading::Status::kOk ? "OK" : "MISSING");
  bind.integer(reading.has_orientation ? 1 : 0);
  bind.numbers(reading.quaternion_wxyz);
  bind.numbers(reading.position_m);
  bind.number(reading.error_m);
}

bool take_reading(const store::Statement& row, SensorReading& reading) {
  Taker take(row);
  take.integer();
  const std::string status = take.text();
  reading.status = status == "OK" ? SensorReading::Status::kOk : SensorReading::Status::kMissing;
  reading.has_orientation = take.integer() != 0;
  take.numbers(reading.quaternion_wxyz);
  take.numbers(reading.position_m);
  take.number(reading.error_m);
  return status == "OK" || status == "MISSING";
}

void bind_estimate(store::Statement& row, const Estimate& e, std::int64_t id, std::int64_t checksum) {
  Binder bind(row);
  bind.integer(id);
  bind.word(describe(e.status));
  bind.word(describe(e.time));
  for (const std::int64_t value :
       {static_cast<std::int64_t>(e.used), static_cast<std::int64_t>(e.sensors_used), static_cast<std::int64_t>(e.dof),
        std::int64_t{e.jumped ? 1 : 0}, static_cast<std::int64_t>(e.evaluations), packed_rejections(e)})
    bind.integer(value);
  bind.integer(observability_bits(e.observability));
  bind.integer(checksum);
  EstimateNumbers numbers{};
  numbers_of(e, numbers);
  bind.numbers(numbers);
}

bool take_estimate(const store::Statement& row, Estimate& e, std::int64_t& checksum) {
  Taker take(row);
  take.integer();
  const bool known = find_word(take.text(), kEstimateStatuses, e.status);
  const bool known_time = find_word(take.text(), kFrameTimes, e.time);
  e.used = static_cast<unsigned>(take.integer());
  e.sensors_used = static_cast<int>(take.integer());
  e.dof = static_cast<int>(take.integer());
  e.jumped = take.integer() != 0;
  e.evaluations = static_cast<int>(take.integer());
  set_packed_rejections(take.integer(), e);
  set_observability_bits(take.integer(), e.observability);
  checksum = take.integer();
  EstimateNumbers numbers{};
  take.numbers(numbers);
  set_numbers(numbers, e);
  bool reasons = true;
  for (const Rejection reason : e.rejections) reasons = reasons && static_cast<std::size_t>(reason) < kRejections;
  return known && known_time && reasons;
}

void bind_extra(store::Statement& row, const Estimate& estimate, std::int64_t id) {
  Binder bind(row);
  bind.integer(id);
  bind.integer(estimate.lagged.age_frames);
  ExtraNumbers numbers{};
  extra_numbers_of(estimate, numbers);
  bind.numbers(numbers);
}

void take_extra(const store::Statement& row, Estimate& estimate) {
  Taker take(row);
  take.integer();
  estimate.lagged.age_frames = static_cast<int>(take.integer());
  ExtraNumbers numbers{};
  take.numbers(numbers);
  set_extra_numbers(numbers, estimate);
}

void bind_event(store::Statement& row, const LiveRecord& record, std::int64_t id, std::int64_t after_frame,
                std::int64_t checksum) {
  Binder bind(row);
  bind.integer(id);
  bind.integer(after_frame);
  bind.integer(record.catheter);
  bind.integer(record.received_ns);
  bind.number(record.output_time_s);
  bind.word(record.event);
  bind.word(record.data);
  bind.integer(checksum);
}

void take_event(const store::Statement& row, LiveRecord& record, std::int64_t& after_frame, std::int64_t& checksum) {
  Taker take(row);
  take.integer();
  after_frame = take.integer();
  record.kind = LiveRecord::Kind::kEvent;
  record.catheter = static_cast<int>(take.integer());
  record.received_ns = take.integer();
  take.number(record.output_time_s);
  record.event = take.text();
  record.data = take.text();
  checksum = take.integer();
}

}  // namespace palpate::session
