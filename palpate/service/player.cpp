// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <palpate/service/player.hpp>
#include <utility>

namespace palpate::service {

namespace {

/// From one frame to the next; nothing where the clock of the recording does not run on.
double step_s(const TrackerFrame& from, const TrackerFrame& to) {
  const double step = to.time_s - from.time_s;
  return std::isfinite(step) ? std::max(step, 0.0) : 0.0;
}

double duration_s(const std::vector<TrackerFrame>& frames) {
  double sum_s = 0.0;
  for (std::size_t i = 1; i < frames.size(); ++i) sum_s += step_s(frames[i - 1], frames[i]);
  return frames.size() > 1 ? sum_s * static_cast<double>(frames.size()) / static_cast<double>(frames.size() - 1) : 1.0;
}

}  // namespace

Player::Player(const HostClock& clock, FrameQueue& queue, std::vector<Reel> reels)
    : clock_(clock), queue_(queue), reels_(std::move(reels)), courses_(reels_.size()) {
  for (std::size_t i = 0; i < reels_.size(); ++i) {
    courses_[i].round_s = duration_s(reels_[i].frames);
    courses_[i].ended = reels_[i].frames.empty();
  }
}

void Player::run() {
  started_ns_ = clock_.now_ns();
  while (!stopping_.load(std::memory_order_acquire)) {
    std::size_t first = 0;
    for (std::size_t i = 1; i < reels_.size(); ++i)
      if (due_ns(i) < due_ns(first)) first = i;
    if (courses_[first].ended) return;
    const std::int64_t wait_ns = due_ns(first) - clock_.now_ns();
    wait_ns > 0 ? wakeup_.wait(wait_ns) : play(first);
  }
}

void Player::stop() noexcept {
  stopping_.store(true, std::memory_order_release);
  wakeup_.notify();
}

std::int64_t Player::due_ns(std::size_t reel) const {
  if (courses_[reel].ended) return std::numeric_limits<std::int64_t>::max();
  const double speed = reels_[reel].speed;
  return speed == 0.0 ? started_ns_ : started_ns_ + nanoseconds(courses_[reel].played_s / speed);
}

void Player::play(std::size_t reel) {
  constexpr std::int64_t kRetry_ns = 1'000'000;
  const Reel& played = reels_[reel];
  frame_ = played.frames[courses_[reel].next];
  frame_.time_s += courses_[reel].shift_s;
  while (!queue_.put(played.catheter, clock_.now_ns(), frame_)) {
    if (played.speed > 0.0) {
      played.counters->queue_dropped.add();
      break;
    }
    if (stopping_.load(std::memory_order_acquire)) return;
    wakeup_.wait(kRetry_ns);
  }
  advance(reel);
}

void Player::advance(std::size_t reel) {
  const std::vector<TrackerFrame>& frames = reels_[reel].frames;
  Course& course = courses_[reel];
  if (++course.next < frames.size()) {
    course.played_s += step_s(frames[course.next - 1], frames[course.next]);
  } else {
    course.ended = !reels_[reel].loop;
    course.next = 0;
    course.shift_s += course.round_s;
    course.played_s = course.shift_s;
  }
}

}  // namespace palpate::service
