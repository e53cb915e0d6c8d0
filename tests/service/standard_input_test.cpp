// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <palpate/math/errors.hpp>
#include <palpate/service/standard_input.hpp>
#include <tests/service/demo_frames.hpp>
#include <thread>

namespace palpate::service {
namespace {

constexpr const char* kHeader = "time_s,frame,sensor,status,q0,qx,qy,qz,tx_mm,ty_mm,tz_mm,error_mm\n";

struct Heard {
  std::vector<TrackerFrame> frames;
  std::vector<std::string> complaints;
};

/// What comes of `text` on standard input, in pieces of `piece` bytes.
Heard hear(const std::string& text, std::size_t piece = 1000) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) throw std::runtime_error("pipe");
  HostClock clock;
  Wakeup wakeup;
  FrameQueue queue(wakeup, 2);
  CatheterCounters counters;
  Heard out;
  StandardInput input(
      clock, queue, 0, test::demo_catheter(), counters,
      [&](const std::string& what) { out.complaints.push_back(what); }, ends[0]);
  std::thread writer([&] {
    for (std::size_t i = 0; i < text.size(); i += piece) {
      const std::string part = text.substr(i, piece);
      [[maybe_unused]] const ssize_t count = write(ends[1], part.data(), part.size());
    }
    close(ends[1]);
  });
  const auto finish = [&] {
    writer.join();
    close(ends[0]);
  };
  try {
    input.run();
  } catch (...) {
    finish();
    throw;
  }
  finish();
  for (; queue.front() != nullptr; queue.pop()) out.frames.push_back(queue.front()->frame);
  return out;
}

std::string row(double time_s, int frame, const char* sensor, const char* rest = "OK,1,0,0,0,1,2,3,0.1") {
  return std::to_string(time_s) + "," + std::to_string(frame) + "," + sensor + "," + rest + "\n";
}

TEST(StandardInput, RowsBecomeFrames) {
  const std::string text = kHeader + row(0.0, 0, "tip") + row(0.0, 0, "shaft", "MISSING,,,,,,,,") +
                           row(0.1, 1, "shaft") + row(0.1, 1, "tip");
  for (const std::size_t piece : {1UL, 7UL, 1000UL}) {
    const Heard heard = hear(text, piece);
    ASSERT_EQ(heard.frames.size(), 2u) << piece;
    EXPECT_EQ(heard.frames[0].readings[0].status, SensorReading::Status::kOk);
    EXPECT_EQ(heard.frames[0].readings[1].status, SensorReading::Status::kMissing);
    EXPECT_NEAR(heard.frames[1].readings[1].position_m.z(), 3e-3, 1e-15);
    EXPECT_TRUE(heard.complaints.empty());
  }
}

TEST(StandardInput, TheLastFrameNeedsNoNext) { EXPECT_EQ(hear(kHeader + row(0.0, 0, "tip")).frames.size(), 1u); }

TEST(StandardInput, ABadLineIsPassedOverAndTold) {
  const Heard heard =
      hear(kHeader + row(0.0, 0, "tip") + row(0.0, 0, "shaft") + "\n" + row(0.1, 1, "tip", "OK,x,0,0,0,1,2,3,0") +
           row(0.1, 1, "nose") + row(0.2, 2, "tip") + row(0.2, 2, "shaft"));
  ASSERT_EQ(heard.complaints.size(), 2u);
  EXPECT_THAT(heard.complaints[0], testing::StartsWith("standard input:5: field q0: value 'x'"));
  EXPECT_THAT(heard.complaints[1], testing::StartsWith("standard input:6: field sensor: value 'nose'"));
  EXPECT_EQ(heard.frames.size(), 2u);
}

TEST(StandardInput, WithoutAHeaderItEnds) {
  EXPECT_THROW(hear("hello\n"), InputError);
  EXPECT_THROW(hear(std::string(10'000, 'x')), InputError);
}

}  // namespace
}  // namespace palpate::service
