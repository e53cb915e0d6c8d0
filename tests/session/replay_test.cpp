// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <palpate/math/units.hpp>
#include <palpate/recording/plus_sequence.hpp>
#include <palpate/session/catheter_change.hpp>
#include <palpate/session/export.hpp>
#include <palpate/session/replay.hpp>
#include <palpate/store/database.hpp>
#include <tests/apps/recording_text.hpp>
#include <tests/recording/temporary_folder.hpp>
#include <tests/session/recorded_session.hpp>
#include <tests/session/session_records.hpp>

namespace palpate::test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class Replay : public TemporaryFolder {
 protected:
  void SetUp() override {
    TemporaryFolder::SetUp();
    write("r.csv", beating_recording().tracker.text());
    toml_ = beating_recording().catheter;
    record_session(path("s"), "one", toml_, path("r.csv"));
  }
  std::string toml_;
};

TEST_F(Replay, GivesTheStoredEstimatesToTheLastBit) {
  const session::ReplayReport report = session::replay(path("s"));
  EXPECT_GT(report.frames, 100u);
  EXPECT_TRUE(report.identical());
  EXPECT_EQ(report.observers, 1u);
  EXPECT_THAT(report.damage, IsEmpty());
}

/// The least change there is: one bit of one number of one frame.
TEST_F(Replay, NamesTheOneNumberThatIsNotTheSame) {
  session::LiveRecord record;
  {
    session::SessionReader reader(path("s"));
    for (int i = 0; i < 60; ++i) ASSERT_TRUE(reader.next(record));
  }
  const double now = record.estimate.force_base_N.y();
  store::Database(path("s"))
      .prepare("UPDATE estimate SET fy_base_N = ? WHERE id = 60")
      .bind(1, std::nextafter(now, 1.0))
      .run();
  const session::ReplayReport report = session::replay(path("s"));
  EXPECT_EQ(report.different, 1u);
  ASSERT_TRUE(report.first);
  EXPECT_EQ(report.first->field, "fy_base_N");
  EXPECT_EQ(report.first->frame, record.frame.number);
  EXPECT_EQ(std::stod(report.first->now), now);
  EXPECT_EQ(std::stod(report.first->stored), std::nextafter(now, 1.0));
  EXPECT_THAT(report.damage, Contains(HasSubstr("estimate id 60: is not what was written")));
}

TEST_F(Replay, AnEstimateThatIsLostIsNotCalledIdentical) {
  store::Database(path("s")).execute("DELETE FROM estimate WHERE id = 60");
  const session::ReplayReport report = session::replay(path("s"));
  EXPECT_EQ(report.different, 0u);  // the frame itself is there, so that those behind it come out the same
  EXPECT_EQ(report.lost, 1u);
  EXPECT_FALSE(report.identical());
}

TEST_F(Replay, AnEventChangesTheCatheterInItsPlace) {
  Catheter moved = session::settings_of({"one", "one.toml", toml_, {}}).catheter;
  moved.base.T_tracker_base.p.x() += 1e-3;
  const nlohmann::json data{{"catheter", session::catheter_change(moved)}};
  test::record_session(path("moved"), "one", toml_, path("r.csv"), "base", data.dump());
  const session::ReplayReport report = session::replay(path("moved"));
  EXPECT_EQ(report.observers, 2u);
  ASSERT_TRUE(report.first);
  EXPECT_EQ(report.first->frame, 101);  // up to the event all is as it was
}

TEST_F(Replay, ReportsReadASession) {
  session::SessionRunReader run(path("s"), "");
  EXPECT_TRUE(run.description().has_estimates);
  EXPECT_EQ(run.description().catheter_text, toml_);
  RunMoment moment;
  std::size_t frames = 0;
  double time_100_s = 0.0;
  while (run.next(moment)) {
    ++frames;
    if (moment.frame.number == 100) time_100_s = moment.frame.time_s;
    ASSERT_TRUE(moment.estimate);
    EXPECT_EQ(moment.estimate->time_s, moment.frame.time_s);
  }
  EXPECT_EQ(frames, session::inspect(path("s")).catheters.at(0).frames);
  ASSERT_EQ(run.events().size(), 1u);
  EXPECT_EQ(run.events()[0].text, "note: contact");
  EXPECT_EQ(run.events()[0].time_s, time_100_s);
  EXPECT_THAT(run.gaps(), IsEmpty());
  EXPECT_THAT(error_of([&] { session::SessionRunReader(path("s"), "two"); }),
              HasSubstr("s: catheter \"two\": expected one of its 1: one"));
}

TEST(Millimetres, ReadBackAsTheSameMetres) {
  std::mt19937_64 random(15);
  std::uint64_t rounded = 0;
  for (int i = 0; i < 20'000; ++i) {  // what came in millimetres, of any number of digits
    const double mm = i % 2 == 0 ? std::uniform_int_distribution<int>(-300'000, 300'000)(random) * 1e-3
                                 : static_cast<double>(std::normal_distribution<float>(0.0F, 100.0F)(random));
    const double m = mm * kMetresPerMillimetre;
    EXPECT_EQ(session::millimetres(m, rounded) * kMetresPerMillimetre, m);
  }
  EXPECT_EQ(rounded, 0u);
  std::uint64_t any = 0;
  for (int i = 0; i < 20'000; ++i) {  // what did not: not every number of metres is one of millimetres
    const double m = std::normal_distribution<double>(0.0, 0.1)(random);
    EXPECT_NEAR(session::millimetres(m, any) * kMetresPerMillimetre, m, 1e-16 * std::abs(m) * 3.0);
  }
  EXPECT_GT(any, 0u);
}

TEST_F(Replay, ThePlusSequenceReadsBackAsTheSamePoses) {
  session::export_session(path("s"), path("x").string(), session::ExportFormat::kPlusSequence, "");
  const TrackerRecording back = read_plus_sequence(path("x.igs.mha"));
  session::SessionReader reader(path("s"));
  session::LiveRecord record;
  std::size_t i = 0;
  while (reader.next(record)) {
    if (record.kind != session::LiveRecord::Kind::kFrame) continue;
    const TrackerFrame& frame = back.frames.at(i++);
    EXPECT_EQ(frame.time_s, record.frame.time_s);
    EXPECT_EQ(frame.number, record.frame.number);
    for (std::size_t s = 0; s < 2; ++s) {
      const auto name = std::find(back.sensor_names.begin(), back.sensor_names.end(), s == 0 ? "tip" : "shaft");
      const SensorReading& a = frame.readings[static_cast<std::size_t>(name - back.sensor_names.begin())];
      const SensorReading& b = record.frame.readings[s];
      ASSERT_EQ(a.status, b.status);
      if (a.status != SensorReading::Status::kOk) continue;
      EXPECT_EQ(a.position_m, b.position_m);
      EXPECT_NEAR(std::abs(a.quaternion_wxyz.dot(b.quaternion_wxyz.normalized())), 1.0, 1e-14);
    }
  }
  EXPECT_EQ(i, back.frames.size());
}

}  // namespace
}  // namespace palpate::test
