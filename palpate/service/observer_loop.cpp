// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <palpate/service/observer_loop.hpp>
#include <utility>

namespace palpate::service {

namespace {

constexpr std::int64_t kLongestWait_ns = 100'000'000;
constexpr std::int64_t kLeastPeriod_ns = 500'000;  // what comes faster is no tracker, but a file as fast as it goes
constexpr std::size_t kTextBytes = 4096;           // of an event's data, without an allocation

}  // namespace

ObserverLoop::ObserverLoop(const HostClock& clock, std::vector<LiveCatheter*> catheters, std::vector<RecordSink*> sinks)
    : clock_(clock), catheters_(std::move(catheters)), sinks_(std::move(sinks)) {
  record_.frame.readings.reserve(kMaxSensors + 1);
  event_.kind = session::LiveRecord::Kind::kEvent;
  event_.event.reserve(kTextBytes);
  event_.data.reserve(kTextBytes);
}

FrameQueue& ObserverLoop::add_source(std::size_t readings) { return sources_.emplace_back(wakeup_, readings); }

bool ObserverLoop::command(Command command) {
  while (retired_.front() != nullptr) {
    retired_.front()->reset();
    retired_.pop();
  }
  Command* const slot = commands_.free_slot();
  if (slot == nullptr) return false;
  *slot = std::move(command);
  commands_.push();
  wakeup_.notify();
  return true;
}

void ObserverLoop::run() {
  while (true) {
    busy_.store(true, std::memory_order_release);
    const bool stopping = stopping_.load(std::memory_order_acquire);
    const bool commanded = take_commands(), fed = take_frames();
    look_for_silence();
    if (commanded || fed) continue;
    busy_.store(false, std::memory_order_release);
    if (stopping) return;
    wakeup_.wait(std::min(next_look_ns() - clock_.now_ns(), kLongestWait_ns));
  }
}

void ObserverLoop::stop() noexcept {
  stopping_.store(true, std::memory_order_release);
  wakeup_.notify();
}

bool ObserverLoop::idle() const {
  return !busy_.load(std::memory_order_acquire) && commands_.size() == 0 &&
         std::all_of(sources_.begin(), sources_.end(), [](const FrameQueue& source) { return source.empty(); });
}

/// One frame of each source in turn, so that none keeps another waiting.
bool ObserverLoop::take_frames() {
  bool any = false;
  for (FrameQueue& source : sources_) {
    const ArrivedFrame* const arrived = source.front();
    if (arrived == nullptr) continue;
    any = true;
    LiveCatheter& catheter = *catheters_[static_cast<std::size_t>(arrived->catheter)];
    catheter.take(arrived->frame, arrived->received_ns, record_);
    source.pop();
    deliver();
    for (const char* const change : catheter.changes()) say(record_.catheter, change);

    const std::int64_t now_ns = clock_.now_ns(), latency_ns = now_ns - record_.received_ns;
    const std::int64_t age_ns = latency_ns + nanoseconds(record_.late_s);
    latency_.add(latency_ns);
    CatheterCounters& counters = catheter.counters();
    const auto period_ns = static_cast<std::int64_t>(counters.period_ns.get());
    if ((period_ns > kLeastPeriod_ns && latency_ns > period_ns) || 2 * age_ns > catheter.stale_after_ns()) {
      counters.misses.add();
      counters.last_miss_ns.set(static_cast<std::uint64_t>(now_ns));
    }
  }
  return any;
}

bool ObserverLoop::take_commands() {
  Command* const command = commands_.front();
  if (command == nullptr) return false;
  if (command->catheter >= 0) {
    LiveCatheter& catheter = *catheters_[static_cast<std::size_t>(command->catheter)];
    if (command->sets_tendon) catheter.set_tendon(command->tendon);
    // The list of retired observers is as long as that of commands, and emptied before every one of them.
    if (std::unique_ptr<ForceObserver>* const retired = retired_.free_slot(); command->observer && retired) {
      *retired = catheter.exchange(std::move(command->observer));
      retired_.push();
    }
  }
  event_.catheter = command->catheter;
  event_.event = command->event;
  event_.data = command->data;
  commands_.pop();
  event_.received_ns = clock_.now_ns();
  for (RecordSink* const sink : sinks_) sink->offer(event_);
  return true;
}

void ObserverLoop::look_for_silence() {
  const std::int64_t now_ns = clock_.now_ns();
  for (std::size_t i = 0; i < catheters_.size(); ++i)
    if (now_ns >= catheters_[i]->next_look_ns() && !waits(static_cast<int>(i)) && catheters_[i]->look(now_ns, record_))
      deliver();
}

/// A frame of it is the next to be taken: it is not silent, the observer is late.
bool ObserverLoop::waits(int catheter) {
  return std::any_of(sources_.begin(), sources_.end(), [&](FrameQueue& source) {
    const ArrivedFrame* const next = source.front();
    return next != nullptr && next->catheter == catheter;
  });
}

void ObserverLoop::say(int catheter, const char* event) {
  event_.catheter = catheter;
  event_.event = event;
  event_.data.clear();
  event_.received_ns = record_.received_ns;
  for (RecordSink* const sink : sinks_) sink->offer(event_);
}

void ObserverLoop::deliver() {
  for (RecordSink* const sink : sinks_) sink->offer(record_);
}

std::int64_t ObserverLoop::next_look_ns() const {
  std::int64_t next = clock_.now_ns() + kLongestWait_ns;
  for (const LiveCatheter* const catheter : catheters_) next = std::min(next, catheter->next_look_ns());
  return next;
}

}  // namespace palpate::service
