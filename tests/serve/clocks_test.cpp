// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <stdexcept>
#include <tests/serve/serve_fixture.hpp>

/// Time stamps that jump, stand still, run back, come twice (FAULTS 6, 7).
namespace palpate::serve_test {
namespace {

constexpr double kRate_hz = 100.0;

class ServeClocks : public Serve {
 protected:
  void SetUp() override {
    Serve::SetUp();
    frames_ = moved_to(virtual_wire(catheter_.catheter, kRate_hz, 2.0).frames, utc_s());
  }
  /// `rate_hz`: messages a second; where it is not that of the clean run, the tracker's clock would seem to lag. A
  /// frame whose time is refused shows nothing.
  void play(double rate_hz = kRate_hz) {
    program_ = serve();
    screen_ = slicer(*program_);
    const auto sent = plus_.play(frames_, rate_hz);
    const auto expected = offline(catheter_, frames_);
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      if (!moves_the_clock(expected[i].time)) continue;
      shown_.push_back(expected[i]);
      sent_.push_back(sent[i]);
    }
    if (!screen_->wait_for(shown_.size(), 10.0)) throw std::runtime_error(program_->health().dump());
    came_ = screen_->forces();
  }
  /// Never back, never NaN, and what the host's clock says to a few seconds.
  void expect_good_times() const {
    for (std::size_t i = 0; i < came_.size(); ++i) {
      ASSERT_TRUE(std::isfinite(came_[i].time_s)) << i;
      ASSERT_LT(std::abs(came_[i].time_s - utc_s()), 30.0) << i;
      if (i > 0) {
        ASSERT_GE(came_[i].time_s, came_[i - 1].time_s) << i;
      }
    }
  }
  /// Forces as offline, whatever the times; NaN where the frame seemed old.
  void expect_forces() const {
    const auto latencies = latencies_s(came_, sent_);
    for (std::size_t i = 0; i < shown_.size(); ++i)
      if (came_[i].live()) {
        EXPECT_EQ(came_[i].values[0], shown_[i].force_tip_N.x()) << i;
      } else {
        EXPECT_GT(latencies[i], 0.1) << i;
      }
  }
  /// The tracker's clock was set back once: five frames are doubted, then it is believed again.
  void expect_one_setting() const {
    expect_good_times();
    expect_forces();
    EXPECT_EQ(times()["stepped_back"], 5);
    EXPECT_EQ(times()["resynchronised"], 1);
    EXPECT_TRUE(came_.back().live());
  }
  nlohmann::json times() const { return program_->catheter()["times"]; }

  WireFrames frames_;
  std::vector<Estimate> shown_;          ///< of the frames whose time is good, offline
  std::vector<Clock::time_point> sent_;  ///< and when those were sent
  std::vector<SlicerClient::Force> came_;
  std::unique_ptr<ServeProcess> program_;
  std::unique_ptr<SlicerClient> screen_;
};

TEST_F(ServeClocks, AnHourOnAndBack) {
  for (std::size_t i = 50; i < 100; ++i) frames_[i].time_s = wire_time(frames_[i].time_s + 3600.0);
  play();
  expect_one_setting();
}

TEST_F(ServeClocks, AnHourBackAndOn) {
  for (std::size_t i = 50; i < 100; ++i) frames_[i].time_s = wire_time(frames_[i].time_s - 3600.0);
  play();
  expect_one_setting();
}

TEST_F(ServeClocks, WrapsToZero) {
  for (std::size_t i = 100; i < frames_.size(); ++i)
    frames_[i].time_s = wire_time(static_cast<double>(i - 99) / kRate_hz);
  play();
  expect_one_setting();
}

/// A device that repeats its last time: nothing is believed, and it goes on afterwards.
TEST_F(ServeClocks, StandsStill) {
  for (std::size_t i = 50; i < 80; ++i) frames_[i].time_s = frames_[49].time_s;
  play();
  EXPECT_EQ(program_->catheter()["stale"], 1) << "300 ms in which the device's clock stood";
  EXPECT_EQ(times()["stood_still"], 30);
  EXPECT_TRUE(came_.back().live());
  for (std::size_t i = 1; i < came_.size(); ++i) ASSERT_GE(came_[i].time_s, came_[i - 1].time_s) << i;
}

/// Every fifth frame twice, two in ten in the wrong order.
TEST_F(ServeClocks, TwiceAndOutOfOrder) {
  const WireFrames clean = frames_;
  frames_.clear();
  WireFrames accepted;
  std::size_t doubled = 0, back = 0;
  for (std::size_t i = 0; i + 10 <= clean.size(); i += 10) {
    for (const std::size_t k : {0, 1, 1, 2, 4, 3, 5, 6, 6, 7, 8, 9}) frames_.push_back(clean[i + k]);
    for (const std::size_t k : {0, 1, 2, 4, 5, 6, 7, 8, 9}) accepted.push_back(clean[i + k]);
    doubled += 2, ++back;
  }
  play(1.2 * kRate_hz);
  EXPECT_EQ(times()["stood_still"], doubled);
  EXPECT_EQ(times()["stepped_back"], back);
  EXPECT_EQ(times()["resynchronised"], 0);
  const auto expected = offline(catheter_, accepted);
  std::size_t next = 0;
  for (const auto& force : came_) {
    if (!force.live()) continue;
    while (next < accepted.size() && accepted[next].time_s < force.time_s) ++next;
    ASSERT_LT(next, accepted.size());
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_EQ(force.values[axis], expected[next].force_tip_N(static_cast<Eigen::Index>(axis)));
  }
  const auto live =
      static_cast<std::size_t>(std::count_if(came_.begin(), came_.end(), [](const auto& f) { return f.live(); }));
  EXPECT_EQ(live, accepted.size());
}

}  // namespace
}  // namespace palpate::serve_test
