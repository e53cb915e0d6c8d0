// SPDX-License-Identifier: Apache-2.0
#include "04_control_loop.hpp"

#include <algorithm>
#include <cstdio>
#include <palpate/math/units.hpp>
#include <palpate/recording/catheter_file.hpp>
#include <palpate/simulation/virtual_tracker.hpp>

namespace {

/// Stands for a tracker's driver: gives recorded frames when their time has come, and loses 200 ms in the middle.
class PlayedTracker {
 public:
  explicit PlayedTracker(const std::vector<palpate::TrackerFrame>& frames) : frames_(frames) {}
  double now_s() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  bool poll(palpate::TrackerFrame& frame) {
    if (next_ == frames_.size() || frames_[next_].time_s > now_s()) return false;
    frame = frames_[next_++];  // as many readings as before: their memory is used again
    return frame.time_s < 0.4 || frame.time_s > 0.6;
  }

 private:
  const std::vector<palpate::TrackerFrame>& frames_;
  std::size_t next_ = 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Stands for a robot: counts what it was told.
struct CountingRobot {
  int cycles = 0, held = 0;
  double largest_N = 0.0;
  bool running() const { return cycles < 1000; }
  void hold() { ++cycles, ++held; }
  void apply(const palpate::ForceGaussian& force) {
    ++cycles;
    largest_N = std::max(largest_N, force.mean_N.norm());
  }
};

}  // namespace

int main(int argc, char** argv) {
  using namespace palpate;
  if (argc != 2) {
    std::fprintf(stderr, "usage: 04_control_loop CATHETER.toml\n");
    return 2;
  }
  const CatheterFile file = read_catheter_file(argv[1]);
  const VirtualRecording recording = simulate_tracker(file.catheter, beating_wall_force, {.duration_s = 1.2});
  PlayedTracker tracker(recording.frames);
  CountingRobot robot;
  ForceObserver observer(file.catheter, file.observer);
  TrackerFrame frame = recording.frames.front();  // of the right size once and for all
  control_loop(observer, frame, tracker, robot);
  std::printf("%d cycles, %d of them held while the tracker was silent; largest force %.1f g\n", robot.cycles,
              robot.held, kGramsForcePerNewton * robot.largest_N);
  return robot.held > 0 && robot.held < robot.cycles ? 0 : 1;
}
