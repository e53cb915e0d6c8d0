// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <deque>
#include <tests/serve/frame_player.hpp>
#include <tests/serve/liars.hpp>
#include <tests/serve/raw_client.hpp>
#include <tests/serve/serve_fixture.hpp>

/// Peers that go, lie, do not read, come in floods: only they are lost (FAULTS 9, 11, 12, 13).
namespace palpate::serve_test {
namespace {

constexpr double kRate_hz = 250.0;
constexpr double kAtOnce_s = 1.2;  // sooner than a connection that is only silent is given up

class ServePeers : public Serve {
 protected:
  void SetUp() override {
    Serve::SetUp();
    program_ = serve();
    screen_ = slicer(*program_);
    wire_ = virtual_wire(catheter_.catheter, kRate_hz, 10.0).frames;
  }

  /// A few frames from wherever the recording stands; each gives a live force.
  void expect_data(std::size_t frames, double longest_s) {
    const std::size_t before = screen_->forces().size();
    for (std::size_t i = 0; i < frames; ++i) ASSERT_TRUE(plus_.send(next()));
    ASSERT_TRUE(screen_->wait_for(before + frames, longest_s)) << program_->health().dump();
    EXPECT_TRUE(screen_->forces().back().live());
  }
  WireFrame next() {
    WireFrame frame = wire_[count_++ % wire_.size()];
    frame.time_s = wire_time(utc_s());
    return frame;
  }
  std::unique_ptr<ServeProcess> program_;
  std::unique_ptr<SlicerClient> screen_;
  WireFrames wire_;
  std::size_t count_ = 0;
};

TEST_F(ServePeers, ReconnectsLeaveNothingBehind) {
  const auto again = [&] {
    plus_.hang_up();
    const Clock::time_point gone = Clock::now();
    ASSERT_TRUE(plus_.accept(2.0));
    expect_data(3, 1.0);
    EXPECT_LT(seconds_since(gone), 1.0);
  };
  for (int i = 0; i < 10 && !HasFatalFailure(); ++i) again();
  sleep_s(0.1);
  const std::size_t descriptors = program_->descriptors(), threads = program_->threads();
  const double memory_MB = program_->memory_MB();
  const int times = in_full() ? 1000 : 30;
  for (int i = 0; i < times && !HasFatalFailure(); ++i) again();
  sleep_s(0.1);
  EXPECT_EQ(program_->descriptors(), descriptors);
  EXPECT_EQ(program_->threads(), threads);
  EXPECT_NEAR(program_->memory_MB(), memory_MB, 0.05 * memory_MB);
  EXPECT_EQ(program_->health()["sources"][0]["connections"], times + 11);
  RecordProperty("memory_MB", fmt::format("{:.1f} -> {:.1f}", memory_MB, program_->memory_MB()));
}

/// The peer's listener goes as well, as when PLUS is started anew.
TEST_F(ServePeers, DataWithinASecondOnceTheServerIsBack) {
  plus_.crash();
  sleep_s(1.5);  // long enough for the longest pause between two attempts
  plus_.listen();
  const Clock::time_point back = Clock::now();
  ASSERT_TRUE(plus_.accept(2.0));
  expect_data(1, 1.0);
  EXPECT_LT(seconds_since(back), 1.0);
}

TEST_F(ServePeers, AServerThatLiesIsLeft) {
  const double memory_MB = program_->memory_MB();
  std::uint64_t malformed = 0;
  for (const auto& bytes : liars()) {
    ASSERT_TRUE(plus_.send_raw(bytes));
    ASSERT_TRUE(plus_.accept(kAtOnce_s)) << "liar " << malformed << " was believed: " << program_->health().dump();
    expect_data(2, 2.0);
    EXPECT_EQ(program_->health()["sources"][0]["malformed"], ++malformed);
  }
  EXPECT_LT(program_->memory_MB(), memory_MB + 5.0);
  EXPECT_EQ(screen_->fault(), "");
}

TEST_F(ServePeers, AClientThatLiesIsClosedAlone) {
  const double memory_MB = program_->memory_MB();
  std::size_t liar = 0;
  {
    FramePlayer player(plus_, wire_, kRate_hz);
    for (const auto& bytes : liars()) {
      RawClient client(program_->link_port());
      EXPECT_EQ(client.send(bytes), bytes.size());
      ASSERT_TRUE(client.closed_within(5.0)) << "liar " << liar;
      ++liar;
    }
    const std::size_t sent = player.stop().size();
    ASSERT_TRUE(screen_->wait_for(sent, 5.0)) << program_->health().dump();
  }
  auto health = program_->health();
  EXPECT_EQ(health["openigtlink"]["closed_malformed"], liar);
  EXPECT_EQ(health["openigtlink"]["clients"], 1);
  EXPECT_FALSE(screen_->closed());
  EXPECT_LT(program_->memory_MB(), memory_MB + 5.0);
}

TEST_F(ServePeers, AClientThatNeverReadsIsDropped) {
  RawClient stuck(program_->link_port(), 4096);
  const double memory_MB = program_->memory_MB();
  const Clock::time_point start = Clock::now();
  FramePlayer player(plus_, wire_, 1000.0);
  health_when(
      *program_, [](const auto& h) { return h["openigtlink"]["closed_stuck"] == 1; }, 12.0);
  const double dropped_s = seconds_since(start);
  EXPECT_LT(dropped_s, 10.0);
  RecordProperty("dropped_after_s", fmt::format("{:.1f}", dropped_s));
  const std::size_t sent = player.stop().size();
  EXPECT_TRUE(screen_->wait_for(sent, 5.0)) << screen_->forces().size() << " of " << sent;
  EXPECT_GE(screen_->forces().size(), 99 * sent / 100);
  auto health = program_->health();
  EXPECT_GT(health["openigtlink"]["dropped"], 0) << "nothing was lost: the test proves nothing";
  EXPECT_EQ(health["network_dropped"], 0);
  EXPECT_EQ(health["openigtlink"]["clients"], 1);
  EXPECT_LT(program_->memory_MB(), memory_MB + 5.0);
}

TEST_F(ServePeers, AFloodOfConnections) {
  FramePlayer player(plus_, wire_, kRate_hz);
  sleep_s(1.0);
  const auto p99 = [&] { return fmt::format("{} s", program_->health()["latency"]["p99_s"].get<double>()); };
  RecordProperty("observer_p99_before", p99());
  const std::size_t most = in_full() ? 2000 : 300;
  std::deque<RawClient> clients;
  for (std::size_t i = 0; i < most; ++i) {
    const bool at_control = i % 4 == 3;
    clients.emplace_back(at_control ? program_->dashboard_port() : program_->link_port());
    const std::string drip = "G";
    if (at_control) clients.back().send(std::as_bytes(std::span(drip)));
    if (clients.size() > 150) clients.pop_front();  // of four descriptors each; the library knows 1024
  }
  sleep_s(0.5);
  EXPECT_LT(program_->descriptors(), 100U) << "the caps do not hold";
  EXPECT_TRUE(screen_->wait_for_live(1.0)) << "the flood stops the forces";
  const std::size_t sent = player.stop().size();
  EXPECT_TRUE(screen_->wait_for(sent, 5.0)) << screen_->forces().size() << " of " << sent;
  clients.clear();
  auto health = health_when(
      *program_, [](const auto& h) { return h["openigtlink"]["clients"] == 1; }, 5.0);
  EXPECT_GT(health["openigtlink"]["refused"], most / 2);
  RecordProperty("observer_p99_after", p99());
}

}  // namespace
}  // namespace palpate::serve_test
