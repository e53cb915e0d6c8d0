// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <tests/apps/app_fixture.hpp>

namespace palpate {
namespace {

using test::RecordingText;

class ClockFaults : public test::App {
 protected:
  /// A recording whose frames' times are changed.
  static RecordingText with_times(const std::function<std::string(int frame, double time_s)>& change) {
    RecordingText recording = test::beating_recording().tracker;
    for (auto& row : recording.rows)
      row[RecordingText::kTime] = change(std::stoi(row[RecordingText::kFrame]), std::stod(row[RecordingText::kTime]));
    return recording;
  }
  nlohmann::json run(const RecordingText& recording) const {
    write("r.csv", recording.text());
    return summary();
  }

  /// Frames other than `refused` are as if those were not in the recording, to the last digit.
  void expect_as_if_left_out(const std::vector<int>& refused) const {
    const auto rows = table();
    const auto is_refused = [&](int frame) { return std::count(refused.begin(), refused.end(), frame) > 0; };
    RecordingText without = test::beating_recording().tracker;
    std::erase_if(without.rows, [&](const auto& row) { return is_refused(std::stoi(row[RecordingText::kFrame])); });
    write("r.csv", without.text());
    EXPECT_EQ(estimate().exit_code, 0);
    const auto expected = table();
    ASSERT_EQ(rows.size(), expected.size() + refused.size());
    std::size_t next = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const bool was_refused = is_refused(static_cast<int>(i));
      EXPECT_EQ(rows[i].at("status"), was_refused ? "REJECTED" : "UPDATED") << i;
      if (was_refused) continue;
      for (const char* column : {"fx_tip_N", "fy_tip_N", "fz_tip_N", "sigma_x_N", "sigma_y_N", "sigma_z_N"})
        EXPECT_EQ(rows[i].at(column), expected[next].at(column)) << i << column;
      ++next;
    }
  }
};

TEST_F(ClockFaults, TimeThatStandsStill) {
  const auto said =
      run(with_times([](int frame, double t) { return frame == 51 || frame == 52 ? "1.25" : std::to_string(t); }));
  EXPECT_EQ(said["rejected_rows"]["time_stands_still"], 2);
  EXPECT_EQ(said["frames"], 160);
  EXPECT_EQ(said["frames_by_status"]["REJECTED"], 2);
  EXPECT_EQ(estimate_refusal({"--strict"}),
            "r.csv: frame 51 at 1.25 s: time stands still: expected a later time than the frame before (--strict)");
  estimate();
  expect_as_if_left_out({51, 52});
}

TEST_F(ClockFaults, TimeThatStepsBackOnce) {
  const auto said = run(with_times([](int frame, double t) { return frame == 50 ? "0.3" : std::to_string(t); }));
  EXPECT_EQ(said["rejected_rows"]["time_steps_back"], 1);
  EXPECT_EQ(said["rejected_rows"]["clock_resynchronised"], 0);
  EXPECT_EQ(estimate_refusal({"--strict"}),
            "r.csv: frame 50 at 0.3 s: time steps back: expected a later time than the frame before (--strict)");
  estimate();
  expect_as_if_left_out({50});
}

// Five frames that run on from the new time prove that the clock was set; the sixth is used again.
TEST_F(ClockFaults, TimeThatStepsBackForGood) {
  const auto said = run(with_times([](int frame, double t) { return std::to_string(frame >= 100 ? t - 3600.0 : t); }));
  EXPECT_EQ(said["rejected_rows"]["time_steps_back"], 5);
  EXPECT_EQ(said["rejected_rows"]["clock_resynchronised"], 1);
  EXPECT_EQ(said["frames_by_status"]["UPDATED"], 155);
  const auto rows = table();
  ASSERT_EQ(rows.size(), 160u);
  for (std::size_t i = 106; i < rows.size(); ++i)
    EXPECT_LE(std::abs(test::number(rows[i], "fz_tip_N") - test::beating_recording().force_tip_N[i].z()),
              5.0 * test::number(rows[i], "sigma_z_N"));
}

TEST_F(ClockFaults, TimeThatIsNoNumber) {
  const auto said = run(with_times([](int frame, double t) { return frame == 70 ? "nan" : std::to_string(t); }));
  EXPECT_EQ(said["rejected_rows"]["time_not_finite"], 1);
  EXPECT_EQ(estimate_refusal({"--strict"}),
            "r.csv: frame 70 at nan s: time is not finite: expected seconds (--strict)");
  estimate();
  EXPECT_EQ(table().at(70).at("time_s"), "nan");
  expect_as_if_left_out({70});
}

TEST_F(ClockFaults, AJumpOfAnHourAheadIsAGap) {
  const auto said = run(with_times([](int frame, double t) { return std::to_string(frame >= 100 ? t + 3600.0 : t); }));
  EXPECT_EQ(said["frames_by_status"]["UPDATED"], 160);
}

TEST_F(ClockFaults, FramesThatLackEverySensorHoldTheForceAndItsSigmaGrows) {
  RecordingText blind = test::beating_recording().tracker;
  for (int frame = 60; frame < 80; ++frame)
    for (auto* row : blind.frame(frame)) RecordingText::set_missing(*row);
  const auto said = run(blind);
  EXPECT_EQ(said["frames_by_status"]["HELD"], 20);
  EXPECT_EQ(said["readings_not_used"]["missing"], 40);
  const auto rows = table();
  for (std::size_t i = 60; i < 80; ++i) {
    EXPECT_LE(std::abs(test::number(rows[i], "fz_tip_N") - test::number(rows[59], "fz_tip_N")),
              3.0 * test::number(rows[i], "sigma_z_N"))
        << "the prediction goes on";
    EXPECT_GT(test::number(rows[i], "sigma_z_N"), test::number(rows[i - 1], "sigma_z_N"));
  }
  EXPECT_EQ(rows[80].at("status"), "UPDATED");
}

}  // namespace
}  // namespace palpate
