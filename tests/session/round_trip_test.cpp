// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <chrono>
#include <palpate/math/errors.hpp>
#include <palpate/store/database.hpp>
#include <tests/observer/allocation_counter.hpp>
#include <tests/recording/temporary_folder.hpp>
#include <tests/session/session_records.hpp>
#include <thread>

namespace palpate::test {
namespace {

using session::LiveRecord;
using session::SessionReader;
using session::SessionWriter;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class RoundTrip : public TemporaryFolder {
 protected:
  /// Offers until it is taken: these tests are about what is kept, not about the queue.
  static void offer(SessionWriter& writer, const LiveRecord& record) {
    while (!writer.offer(record)) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  std::vector<LiveRecord> write(const std::vector<session::SessionCatheter>& catheters, std::vector<LiveRecord> records,
                                const session::WriterOptions& options = {.batch_s = 0.01}) const {
    SessionWriter writer(path("s.palpate"), catheters, options);
    for (const LiveRecord& record : records) offer(writer, record);
    const session::WriterHealth health = writer.close();
    EXPECT_EQ(health.committed, records.size());
    EXPECT_FALSE(health.failing) << health.error;
    return records;
  }
  void expect_read_back(const std::vector<LiveRecord>& written) const {
    SessionReader reader(path("s.palpate"));
    const std::vector<LiveRecord> read = read_all(reader);
    EXPECT_THAT(reader.damage(), IsEmpty());
    ASSERT_EQ(read.size(), written.size());
    for (std::size_t i = 0; i < read.size() && !HasFailure(); ++i) {
      SCOPED_TRACE(i);
      expect_same(written[i], read[i]);
    }
  }
};

TEST_F(RoundTrip, KeepsEveryFieldBitForBit) {
  RandomRecords random(1, 3, 9);
  std::vector<LiveRecord> records;
  for (int i = 0; i < 2000; ++i) records.push_back(random.chance(7) ? random.event("note") : random.frame());
  write(some_catheters(3, 9), records);
  expect_read_back(records);
}

TEST_F(RoundTrip, Keeps64CathetersInTheOrderInWhichTheyCame) {
  RandomRecords random(2, 64);
  std::vector<LiveRecord> records;
  for (int i = 0; i < 6400; ++i) records.push_back(random.frame());
  write(some_catheters(64), records);
  expect_read_back(records);
  SessionReader reader(path("s.palpate"));
  ASSERT_EQ(reader.catheters().size(), 64u);
  EXPECT_EQ(reader.catheters()[63].name, "catheter 63");
  EXPECT_EQ(reader.catheters()[63].toml, "schema = 1\n");
  EXPECT_THAT(reader.catheters()[5].sensor_names, ::testing::ElementsAre("sensor0", "sensor1"));
}

TEST_F(RoundTrip, KeepsEventsBeforeTheFirstAndBehindTheLastFrame) {
  RandomRecords random(3);
  std::vector<LiveRecord> records{random.event("start"), random.event("note"), random.frame(),     random.event("tare"),
                                  random.event("base"),  random.frame(),       random.event("end")};
  write(some_catheters(), records);
  expect_read_back(records);
}

TEST_F(RoundTrip, KeepsAStaleForecastAsAnEventWithoutAFrame) {
  LiveRecord stale;
  stale.kind = LiveRecord::Kind::kStale;
  stale.estimate.status = EstimateStatus::kStale;
  stale.estimate.force_tip_N = {0.1, -0.25, std::numeric_limits<double>::quiet_NaN()};
  stale.estimate.covariance_tip_N2 = Vector3d(4.0, 9.0, 0.0).asDiagonal();
  write(some_catheters(), {stale});
  SessionReader reader(path("s.palpate"));
  const std::vector<LiveRecord> read = read_all(reader);
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(read[0].event, "stale");
  EXPECT_EQ(read[0].data, R"({"forecast_force_tip_N":[0.1,-0.25,null],"sigma_N":[2,3,0]})");
}

TEST_F(RoundTrip, LeavesTheSessionAloneInItsFolder) {
  RandomRecords random(4);
  write(some_catheters(), {random.frame()}, {.durability = session::Durability::kFull, .program_version = "1.2.3"});
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(path("")))
    files.push_back(entry.path().filename().string());
  EXPECT_THAT(files, ::testing::ElementsAre("s.palpate"));
  SessionReader reader(path("s.palpate"));
  EXPECT_EQ(reader.about("program_version"), "1.2.3");
  EXPECT_EQ(reader.about("durability"), "FULL");
  EXPECT_EQ(reader.about("no such key"), "");
}

TEST_F(RoundTrip, OneSessionOneWriter) {
  const auto open = [&] { SessionWriter writer(path("s.palpate"), some_catheters(), {}); };
  {
    SessionWriter writer(path("s.palpate"), some_catheters(), {});
    EXPECT_THAT(error_of(open), HasSubstr("s.palpate: exists"));
  }
  EXPECT_THAT(error_of(open), HasSubstr("never overwritten"));
  EXPECT_THAT(error_of([&] { SessionWriter writer(path("no/s.palpate"), some_catheters(), {}); }),
              HasSubstr("cannot be written: No such file or directory"));
  EXPECT_THAT(error_of([&] { SessionWriter writer(path("t"), some_catheters(), {.batch_s = 0.0}); }),
              HasSubstr("batch_s = 0: expected seconds from 0.01 to 10"));
  EXPECT_FALSE(std::filesystem::exists(path("t")));
}

TEST_F(RoundTrip, RefusesWhatIsNoSession) {
  TemporaryFolder::write("text", "time_s,frame\n");
  EXPECT_FALSE(session::looks_like_session(path("text")));
  EXPECT_THAT(error_of([&] { SessionReader reader(path("text")); }), HasSubstr("does not begin as SQLite files do"));
  EXPECT_THAT(error_of([&] { SessionReader reader(path("none")); }), HasSubstr("cannot be read"));
  store::Database(path("other")).execute("CREATE TABLE session (x)");
  EXPECT_THAT(error_of([&] { SessionReader reader(path("other")); }), HasSubstr("of another program"));
  write(some_catheters(), {});
  store::Database(path("s.palpate")).execute("PRAGMA user_version = 99");
  EXPECT_THAT(error_of([&] { SessionReader reader(path("s.palpate")); }), HasSubstr("written by a later program"));
}

TEST_F(RoundTrip, ASessionCanBeReadWhileItIsWritten) {
  RandomRecords random(5);
  SessionWriter writer(path("s.palpate"), some_catheters(), {.batch_s = 0.01});
  for (int i = 0; i < 100; ++i) offer(writer, random.frame());
  while (writer.health().committed < 100) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  SessionReader reader(path("s.palpate"));
  for (int i = 0; i < 100; ++i) offer(writer, random.frame());
  while (writer.health().committed < 200) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  EXPECT_EQ(read_all(reader).size(), 100u);  // as it was when the reader came
  EXPECT_THAT(reader.damage(), IsEmpty());
}

TEST_F(RoundTrip, OfferingAllocatesNothingOnceItIsWarm) {
  RandomRecords random(6);
  const LiveRecord frame = random.frame(), event = random.event("operator's note");
  SessionWriter writer(path("s.palpate"), some_catheters(), {.batch_s = 0.01, .queue = 64});
  offer(writer, frame);
  std::size_t allocations = 0;
  {
    const CountAllocations count;
    const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    for (int i = 1; std::chrono::steady_clock::now() < limit; ++i) {
      writer.offer(i % 10 == 0 ? event : frame);
      if (i % 100 != 0) continue;  // more than the queue holds
      std::this_thread::sleep_for(std::chrono::milliseconds(12));
      if (writer.health().committed > 300 && writer.health().dropped > 0) break;
    }
    allocations = count.so_far();
  }
  EXPECT_EQ(allocations, 0u);
  EXPECT_GT(writer.health().committed, 300u);
  EXPECT_GT(writer.health().dropped, 0u);
}

}  // namespace
}  // namespace palpate::test
