// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <palpate/session/inspection.hpp>
#include <palpate/store/database.hpp>
#include <tests/recording/temporary_folder.hpp>
#include <tests/session/session_records.hpp>
#include <thread>

namespace palpate::test {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using session::LiveRecord;
using session::SessionReader;
using session::SessionWriter;
using session::WriterHealth;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr session::WriterOptions kQuick{.batch_s = 0.02, .queue = 256};

/// Number and order of what came through: frames numbered 0, 1, 2 ... with holes exactly where an event says so.
struct Account {
  std::int64_t frames = 0, dropped = 0, drop_events = 0;
  bool in_order = true;
};

Account account(SessionReader& reader) {
  Account all;
  std::int64_t next = 0;
  for (const LiveRecord& record : read_all(reader)) {
    if (record.kind == LiveRecord::Kind::kFrame) {
      all.in_order = all.in_order && record.frame.number == next;
      next = record.frame.number + 1;
      ++all.frames;
      continue;
    }
    const auto count = nlohmann::json::parse(record.data).at("count").get<std::int64_t>();
    next += count;
    all.dropped += count;
    ++all.drop_events;
  }
  return all;
}

class WriterFaults : public TemporaryFolder {
 protected:
  /// Offers numbered frames at 1 kHz until `done`; none is offered twice.
  template <typename Done>
  static void play(SessionWriter& writer, LiveRecord& frame, Done done) {
    const auto limit = Clock::now() + 20s;
    while (!done() && Clock::now() < limit) {
      frame.received_ns = 1000 * ++frame.frame.number;
      writer.offer(frame);
      std::this_thread::sleep_for(1ms);
    }
    EXPECT_LT(Clock::now(), limit);
  }
  static LiveRecord first_frame() {
    RandomRecords random(7);
    LiveRecord frame = random.frame();
    frame.frame.number = -1;
    return frame;
  }
  std::filesystem::path file() const { return path("s.palpate"); }
};

/// What a child process does, and says through a pipe.
class Child {
 public:
  template <typename Action>
  explicit Child(const Action& action) {
    int ends[2];
    EXPECT_EQ(::pipe(ends), 0);
    process_ = ::fork();
    if (process_ == 0) {
      ::close(ends[0]);
      action(ends[1]);
      ::_exit(0);
    }
    ::close(ends[1]);
    pipe_ = ends[0];
  }
  ~Child() { ::close(pipe_); }
  /// All that the child has said until its pipe is closed.
  std::vector<std::uint64_t> all() const {
    std::vector<std::uint64_t> words;
    for (std::uint64_t word = 0; ::read(pipe_, &word, sizeof word) == sizeof word;) words.push_back(word);
    return words;
  }
  bool next(std::uint64_t& word) const { return ::read(pipe_, &word, sizeof word) == sizeof word; }
  void kill() const { ::kill(process_, SIGKILL); }
  int wait() const {
    int status = 0;
    ::waitpid(process_, &status, 0);
    return status;
  }

 private:
  pid_t process_ = -1;
  int pipe_ = -1;
};

void say(int pipe, std::uint64_t word) {
  if (::write(pipe, &word, sizeof word) != sizeof word) ::_exit(9);
}

/// Writes for ever and tells how many frames are acknowledged.
void write_until_killed(const std::filesystem::path& file, int pipe) {
  SessionWriter writer(file, some_catheters(), {.batch_s = 0.01, .queue = 1024});
  RandomRecords random(8);
  const LiveRecord some = random.frame();
  LiveRecord frame = some;
  for (std::int64_t number = 0;; ++number) {
    frame.frame.number = number;
    while (!writer.offer(frame)) std::this_thread::sleep_for(1ms);
    if (number % 16 != 0) continue;
    say(pipe, writer.health().committed_frames);
    std::this_thread::sleep_for(1ms);
  }
}

/// The full form, 100 times, with PALPATE_LONG in the environment.
TEST_F(WriterFaults, KilledWhileWritingLosesNothingThatWasAcknowledged) {
  const int rounds = std::getenv("PALPATE_LONG") != nullptr ? 100 : 8;
  std::mt19937_64 random(9);
  for (int round = 0; round < rounds; ++round) {
    const auto session = path(fmt::format("k{}", round));
    const Child child([&](int pipe) { write_until_killed(session, pipe); });
    std::uint64_t acknowledged = 0;
    while (acknowledged == 0 && child.next(acknowledged)) {
    }
    std::this_thread::sleep_for(std::chrono::microseconds(std::uniform_int_distribution<int>(0, 120'000)(random)));
    child.kill();
    for (const std::uint64_t word : child.all()) acknowledged = std::max(acknowledged, word);
    child.wait();
    SessionReader reader(session);
    const std::vector<LiveRecord> records = read_all(reader);
    EXPECT_THAT(reader.damage(), IsEmpty());
    EXPECT_GE(records.size(), acknowledged);
    for (std::size_t i = 0; i < records.size(); ++i)
      ASSERT_EQ(records[i].frame.number, static_cast<std::int64_t>(i) + records[0].frame.number);
    EXPECT_THAT(session::inspect(session, true).damage, IsEmpty());
    RecordProperty("acknowledged", static_cast<int>(acknowledged));
  }
}

/// The largest file that this process may write: what a full disk does, and goes again. Of a child alone.
void limit_files(rlim_t bytes) {
  rlimit limit{};
  ::getrlimit(RLIMIT_FSIZE, &limit);
  limit.rlim_cur = bytes;
  ::setrlimit(RLIMIT_FSIZE, &limit);
}

TEST_F(WriterFaults, ADiskThatIsFullIsToldAndWrittenToAgainOnceThereIsRoom) {
  const Child child([&](int pipe) {
    ::signal(SIGXFSZ, SIG_IGN);
    SessionWriter writer(file(), some_catheters(), kQuick);
    LiveRecord frame = first_frame();
    play(writer, frame, [&] { return writer.health().committed >= 100; });
    limit_files(16'384);
    const auto since = Clock::now();
    play(writer, frame, [&] { return writer.health().failing; });
    say(pipe, static_cast<std::uint64_t>(
                  std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - since).count()));
    say(pipe, writer.health().error.find("disk") != std::string::npos ? 1 : 0);
    play(writer, frame, [&] { return writer.health().dropped >= 100; });
    const SessionReader readable(file());
    limit_files(RLIM_INFINITY);
    const std::uint64_t before = writer.health().committed;
    play(writer, frame, [&] { return !writer.health().failing && writer.health().committed > before + 300; });
    const WriterHealth end = writer.close();
    say(pipe, end.failing ? 1 : 0);
    say(pipe, end.offered);
    say(pipe, end.committed);
    say(pipe, end.dropped);
  });
  const std::vector<std::uint64_t> said = child.all();
  child.wait();
  ASSERT_EQ(said.size(), 6u);
  EXPECT_LT(said[0], 1000u) << "ms until it is told";
  EXPECT_EQ(said[1], 1u) << "the reason";
  EXPECT_EQ(said[2], 0u);
  EXPECT_EQ(said[3], said[4]);
  SessionReader reader(file());
  const Account all = account(reader);
  EXPECT_THAT(reader.damage(), IsEmpty());
  EXPECT_EQ(static_cast<std::uint64_t>(all.frames), said[3]);
  EXPECT_EQ(static_cast<std::uint64_t>(all.dropped), said[5]);
  EXPECT_TRUE(all.in_order);
  EXPECT_THAT(session::inspect(file(), true).damage, IsEmpty());
}

/// A real disk of half a megabyte, made larger later; where the test may mount one.
TEST_F(WriterFaults, ASmallDiskThatFillsUpIsNoEnd) {
  const std::filesystem::path disk = path("disk");
  std::filesystem::create_directories(disk);
  if (::mount("palpate-test", disk.c_str(), "tmpfs", 0, "size=512k") != 0) GTEST_SKIP() << "may not mount";
  WriterHealth end;
  {
    SessionWriter writer(disk / "s", some_catheters(), kQuick);
    LiveRecord frame = first_frame();
    play(writer, frame, [&] { return writer.health().failing; });
    EXPECT_THAT(writer.health().error, HasSubstr("full"));
    play(writer, frame, [&] { return writer.health().dropped >= 100; });
    SessionReader while_full(disk / "s");
    EXPECT_EQ(read_all(while_full).size(), writer.health().committed);
    ::mount("palpate-test", disk.c_str(), "tmpfs", MS_REMOUNT, "size=64m");
    const std::uint64_t before = writer.health().committed;
    play(writer, frame, [&] { return !writer.health().failing && writer.health().committed > before + 300; });
    end = writer.close();
  }
  EXPECT_FALSE(end.failing) << end.error;
  EXPECT_EQ(end.offered, end.committed);
  {
    SessionReader reader(disk / "s");
    const Account all = account(reader);
    EXPECT_EQ(static_cast<std::uint64_t>(all.frames), end.committed);
    EXPECT_EQ(static_cast<std::uint64_t>(all.dropped), end.dropped);
    EXPECT_TRUE(all.in_order);
  }
  EXPECT_EQ(::umount(disk.c_str()), 0);
}

/// Another process that keeps the file to itself.
TEST_F(WriterFaults, AFileLockedByAnotherProcessStopsNobodyThatOffers) {
  SessionWriter writer(file(), some_catheters(), kQuick);
  LiveRecord frame = first_frame();
  play(writer, frame, [&] { return writer.health().committed >= 20; });
  const store::Database other(file());
  other.execute("BEGIN IMMEDIATE");
  const auto since = Clock::now();
  std::int64_t longest_us = 0;
  play(writer, frame, [&] {
    const auto before = Clock::now();
    frame.received_ns = 1000 * ++frame.frame.number;
    writer.offer(frame);
    longest_us =
        std::max(longest_us, std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - before).count());
    return Clock::now() - since > 1500ms;
  });
  EXPECT_LT(longest_us, 200'000);  // it would be 1.5 s
  EXPECT_TRUE(writer.health().failing);
  EXPECT_THAT(writer.health().error, HasSubstr("locked"));
  EXPECT_GT(writer.health().dropped, 1000u);
  other.execute("ROLLBACK");
  const std::uint64_t before = writer.health().committed;
  play(writer, frame, [&] { return writer.health().committed > before + 300; });
  const WriterHealth end = writer.close();
  EXPECT_FALSE(end.failing) << end.error;
  EXPECT_EQ(end.offered, end.committed);
  SessionReader reader(file());
  const Account all = account(reader);
  EXPECT_EQ(static_cast<std::uint64_t>(all.frames), end.committed);
  EXPECT_EQ(static_cast<std::uint64_t>(all.dropped), end.dropped);
  EXPECT_TRUE(all.in_order);
}

TEST_F(WriterFaults, ClosingGivesUpAfterTwoSecondsAndTellsWhatIsLost) {
  SessionWriter writer(file(), some_catheters(), kQuick);
  LiveRecord frame = first_frame();
  play(writer, frame, [&] { return writer.health().committed >= 20; });
  const store::Database other(file());
  other.execute("BEGIN IMMEDIATE");
  play(writer, frame, [&] { return writer.health().failing; });
  const auto since = Clock::now();
  const WriterHealth end = writer.close();
  EXPECT_LT(Clock::now() - since, 3s);
  EXPECT_TRUE(end.failing);
  EXPECT_GT(end.offered, end.committed);
  other.execute("ROLLBACK");
  SessionReader reader(file());
  EXPECT_EQ(read_all(reader).size(), end.committed);
}

TEST_F(WriterFaults, WhatIsDroppedLastIsToldToo) {
  WriterHealth end;
  LiveRecord frame = first_frame();
  {
    SessionWriter writer(file(), some_catheters(), {.batch_s = 0.5, .queue = 64});
    for (int i = 0; i < 400; ++i) {
      ++frame.frame.number;
      writer.offer(frame);
    }
    end = writer.close();
  }
  EXPECT_GT(end.dropped, 0u);
  SessionReader reader(file());
  const Account all = account(reader);
  EXPECT_EQ(static_cast<std::uint64_t>(all.dropped), end.dropped);
  EXPECT_EQ(all.frames + all.dropped, 400);
  EXPECT_TRUE(all.in_order);
  EXPECT_EQ(session::inspect(file()).dropped, end.dropped);
}

}  // namespace
}  // namespace palpate::test
