// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <functional>
#include <tests/apps/app_fixture.hpp>

namespace palpate {
namespace {

using test::RecordingText;
using Row = RecordingText::Row;

/// A row that must not be used, and what --strict says of it.
struct Fault {
  const char* reason;  ///< key of readings_not_used
  std::function<void(Row&)> spoil;
};

std::vector<Fault> pose_faults() {
  const auto set = [](RecordingText::Column column, const char* value) {
    return [=](Row& row) { row[column] = value; };
  };
  return {{"not finite", set(RecordingText::kX, "nan")},
          {"not finite", set(RecordingText::kQ0, "NaN")},
          {"not finite", set(RecordingText::kZ, "inf")},
          {"not finite", set(RecordingText::kQz, "-Inf")},
          {"zero quaternion",
           [](Row& row) {
             RecordingText::set_pose(row, {"0", "0", "0", "0", "77", "-71", "-189"});
           }},
          {"non-unit quaternion",
           [](Row& row) {
             RecordingText::set_pose(row, {"2", "0", "0", "0", "77", "-71", "-189"});
           }},
          {"identity pose",
           [](Row& row) {
             RecordingText::set_pose(row, {"1", "0", "0", "0", "0", "0", "0"});
           }},
          {"no orientation", [](Row& row) {
             RecordingText::set_pose(row, {"", "", "", "", "77", "-71", "-189"});
           }}};
}

class TrackerFaults : public test::App {
 protected:
  /// Estimates a recording; the table of the run and its summary.
  nlohmann::json run(const RecordingText& recording, test::EstimateTable& rows) const {
    write("r.csv", recording.text());
    const nlohmann::json said = summary();
    rows = table();
    return said;
  }

  /// Every frame's truth is within 5 sigma on every axis (a chance of 1e-4 over such a run).
  static void expect_true(const test::EstimateTable& rows) {
    constexpr const char* kAxes[] = {"x", "y", "z"};
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (rows[i].at("status") != "UPDATED") continue;
      for (int axis = 0; axis < 3; ++axis) {
        const double error = test::number(rows[i], std::string("f") + kAxes[axis] + "_tip_N") -
                             test::beating_recording().force_tip_N[i](axis);
        const double sigma = test::number(rows[i], std::string("sigma_") + kAxes[axis] + "_N");
        EXPECT_LE(std::abs(error), 5.0 * sigma) << "row " << i << " axis " << kAxes[axis];
      }
    }
  }
};

constexpr int kSpoilt[] = {20, 21, 22, 60, 100};  // frames

// One sensor lies: the other goes on alone. Both lie: the force is held. Either way as if they had been MISSING.
TEST_F(TrackerFaults, BrokenPosesCountAsWhatTheyAreAndAsMissingForTheEstimate) {
  RecordingText good = test::beating_recording().tracker, missing = good;
  for (const int frame : kSpoilt) RecordingText::set_missing(missing.at(frame, "tip"));
  for (Row* row : missing.frame(140)) RecordingText::set_missing(*row);
  test::EstimateTable expected, rows;
  EXPECT_EQ(run(missing, expected)["readings_not_used"]["missing"], 7);
  const std::string expected_csv = contents(path("e.csv"));
  expect_true(expected);
  EXPECT_EQ(expected.at(140).at("status"), "HELD");
  EXPECT_EQ(expected.at(140).at("sensors_used"), "0");

  for (const Fault& fault : pose_faults()) {
    SCOPED_TRACE(fault.reason);
    RecordingText spoilt = good;
    for (const int frame : kSpoilt) fault.spoil(spoilt.at(frame, "tip"));
    for (Row* row : spoilt.frame(140)) fault.spoil(*row);
    auto said = run(spoilt, rows);
    EXPECT_EQ(rows.size(), 160u);
    EXPECT_EQ(said["readings_not_used"][fault.reason], 7);
    for (const auto& [reason, count] : said["readings_not_used"].items())
      EXPECT_EQ(count, reason == fault.reason ? 7 : 0) << reason;
    EXPECT_EQ(said["frames_by_status"]["HELD"], 1);
    EXPECT_EQ(said["frames_by_status"]["UPDATED"], 159);
    EXPECT_TRUE(contents(path("e.csv")) == expected_csv);
  }
}

TEST_F(TrackerFaults, StrictRefusesEachOfThem) {
  for (const Fault& fault : pose_faults()) {
    RecordingText spoilt = test::beating_recording().tracker;
    fault.spoil(spoilt.at(20, "tip"));
    write("r.csv", spoilt.text());
    EXPECT_EQ(estimate_refusal({"--strict", "--plot", "p.svg"}),
              std::string("r.csv: frame 20 at 0.5 s: sensor \"tip\": ") + fault.reason + " (--strict)");
  }
}

TEST_F(TrackerFaults, StrictAcceptsWhatTheTrackerSaysIsMissing) {
  RecordingText missing = test::beating_recording().tracker;
  RecordingText::set_missing(missing.at(20, "tip"));
  for (Row* row : missing.frame(30)) RecordingText::set_missing(*row);
  write("r.csv", missing.text());
  EXPECT_EQ(summary({"--strict"})["readings_not_used"]["missing"], 3);
}

TEST_F(TrackerFaults, ASensorWithoutARowInAFrameIsNotInItWhichIsNoFault) {
  RecordingText good = test::beating_recording().tracker;
  std::erase_if(good.rows, [](const Row& row) {
    return row[RecordingText::kFrame] == "20" && row[RecordingText::kSensor] == "tip";
  });
  test::EstimateTable rows;
  RecordingText::set_missing(good.at(30, "tip"));
  const auto said = run(good, rows);
  EXPECT_EQ(said["sensors_not_in_a_frame"], 1);
  EXPECT_EQ(said["readings_not_used"]["missing"], 1);
  for (const auto& [reason, count] : said["readings_not_used"].items()) EXPECT_LE(count, reason == "missing" ? 1 : 0);
  EXPECT_EQ(rows.at(20).at("sensors_used"), "1");
  EXPECT_EQ(said["frames_by_status"]["UPDATED"], 160);
  EXPECT_EQ(summary({"--strict"})["sensors_not_in_a_frame"], 1);
  const auto told = estimate();
  EXPECT_NE(told.out.find("  sensors not in a frame: 1\n"), std::string::npos) << told.out;
  EXPECT_NE(told.out.find("  readings not used: missing: 1\n"), std::string::npos) << told.out;
}

TEST_F(TrackerFaults, DuplicatedRowsChangeNothing) {
  RecordingText good = test::beating_recording().tracker, twice = good;
  test::EstimateTable expected, rows;
  run(good, expected);
  const std::string expected_csv = contents(path("e.csv"));
  for (const int at : {300, 101, 100, 40})
    twice.rows.insert(twice.rows.begin() + at, twice.rows[static_cast<std::size_t>(at)]);
  const auto said = run(twice, rows);
  EXPECT_EQ(said["rejected_rows"]["duplicate"], 4);
  EXPECT_EQ(said["frames"], 160);
  EXPECT_TRUE(contents(path("e.csv")) == expected_csv);
  EXPECT_EQ(
      estimate_refusal({"--strict"}),
      "r.csv: frame 20 at 0.5 s: sensor \"tip\": a second row: 4 in all: expected one row a sensor a frame (--strict)");
}

TEST_F(TrackerFaults, AnOutlierIsLeftOut) {
  RecordingText wild = test::beating_recording().tracker;
  for (const int frame : kSpoilt) {
    std::string& x_mm = wild.at(frame, "shaft")[RecordingText::kX];
    x_mm = std::to_string(std::stod(x_mm) + 25.0);
  }
  test::EstimateTable rows;
  EXPECT_EQ(run(wild, rows)["readings_not_used"]["outlier"], 5);
  expect_true(rows);
  EXPECT_EQ(estimate_refusal({"--strict"}), "r.csv: frame 20 at 0.5 s: sensor \"shaft\": outlier (--strict)");
}

}  // namespace
}  // namespace palpate
