// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <deque>
#include <memory>
#include <palpate/service/counters.hpp>
#include <palpate/service/frame_queue.hpp>
#include <palpate/service/host_clock.hpp>
#include <palpate/service/live_catheter.hpp>
#include <palpate/service/record_sink.hpp>
#include <string>
#include <vector>

namespace palpate::service {

/// What an operator, a source or the service itself wants done or said between two frames. It is recorded at its place.
struct Command {
  int catheter = -1;
  std::string event = {}, data = {};             ///< as LiveRecord's
  std::unique_ptr<ForceObserver> observer = {};  ///< replaces the catheter's; comes back with the one before
  bool sets_tendon = false;
  TendonReading tendon = {};
};

/// The one thread that estimates. Frames come in through bounded queues, records go out to sinks that never make it
/// wait; in between it takes no lock, allocates nothing and looks at the clock alone. Every catheter in one thread: an
/// update takes some ten microseconds, so that 64 catheters at 250 Hz need a fifth of a core.
class ObserverLoop {
 public:
  ObserverLoop(const HostClock& clock, std::vector<LiveCatheter*> catheters, std::vector<RecordSink*> sinks);

  /// Before run(): one for each thread that brings frames.
  FrameQueue& add_source(std::size_t readings);
  /// From one other thread. False: too many wait.
  [[nodiscard]] bool command(Command command);

  /// Until stop() and every queue is empty.
  void run();
  void stop() noexcept;
  /// All that came before has left: a finished file is finished here as well.
  bool idle() const;

  const LatencyHistogram& latency() const { return latency_; }  ///< from reception to the sinks

 private:
  bool take_frames();
  bool take_commands();
  void look_for_silence();
  bool waits(int catheter);
  void say(int catheter, const char* event);
  void deliver();
  std::int64_t next_look_ns() const;

  const HostClock& clock_;
  std::vector<LiveCatheter*> catheters_;
  std::vector<RecordSink*> sinks_;
  Wakeup wakeup_;
  std::deque<FrameQueue> sources_;
  session::Ring<Command> commands_{64};
  session::Ring<std::unique_ptr<ForceObserver>> retired_{64};  ///< freed by the thread that commands
  session::LiveRecord record_, event_;
  LatencyHistogram latency_;
  std::atomic<bool> stopping_{false};
  std::atomic<bool> busy_{false};
};

}  // namespace palpate::service
