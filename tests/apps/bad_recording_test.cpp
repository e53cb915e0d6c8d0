// SPDX-License-Identifier: Apache-2.0
#include <tests/apps/app_fixture.hpp>

namespace palpate {
namespace {

using test::RecordingText;

/// What a user reads when the recording cannot be used.
class BadRecording : public test::App {
 protected:
  std::string refusal_of(const std::string& recording) const {
    write("r.csv", recording);
    return estimate_refusal();
  }
  /// One field of the tip's row of frame 20, line 42, is changed.
  std::string refusal_of_field(RecordingText::Column column, const char* value) const {
    RecordingText recording = test::beating_recording().tracker;
    recording.at(20, "tip")[column] = value;
    return refusal_of(recording.text());
  }
};

TEST_F(BadRecording, IsNoFile) {
  EXPECT_EQ(refusal_of(""), "r.csv: is empty: expected lines of text");
  EXPECT_EQ(refusal_of(" \n\n"), "r.csv: is empty: expected lines of text");
  std::filesystem::remove(path("r.csv"));
  EXPECT_EQ(estimate_refusal(), "r.csv: cannot be opened: No such file or directory: expected a readable text file");
  std::filesystem::create_directory(path("r.csv"));
  EXPECT_EQ(estimate_refusal(),
            "r.csv: is a folder: expected the file of a recording, or MR coil text named "
            "cathcoords-coil<K>-<REC>.txt in it");
}

TEST_F(BadRecording, HasAnotherFormat) {
  EXPECT_EQ(
      refusal_of("time,force\n0,1\n"),
      "r.csv:1: field header: value 'time,force': expected tracker CSV (time_s,frame,sensor,status,q0,...), a PLUS "
      "sequence (.igs.mha), NDI CSV (first line 'Test Date'), marker CSV (time_s,NAME_x_m,NAME_y_m,NAME_z_m,... or "
      "_mm), or MR coil text (cathcoords-coil<K>-<REC>.txt or its folder)");
  EXPECT_EQ(
      refusal_of("time_s,frame,sensor,status,q0,qx,qy,qz,tx_mm,ty_mm\n"),
      "r.csv:1: field header: value 'time_s,frame,sensor,status,q0,qx,qy,qz,tx_mm,ty_mm': expected a column named "
      "tz_mm");
  EXPECT_EQ(refusal_of("time_s,frame,sensor,status,q0,qx,qy,qz,tx_mm,ty_mm,tz_mm,error_mm\n"),
            "r.csv:1: field row: value '': expected at least one row after the header");
}

TEST_F(BadRecording, HasAWrongField) {
  EXPECT_EQ(refusal_of_field(RecordingText::kX, "7o.1"), "r.csv:42: field tx_mm: value '7o.1': expected a number");
  EXPECT_EQ(refusal_of_field(RecordingText::kY, ""), "r.csv:42: field ty_mm: value '': expected a number");
  EXPECT_EQ(refusal_of_field(RecordingText::kQx, ""), "r.csv:42: field qx: value '': expected a number");
  EXPECT_EQ(refusal_of_field(RecordingText::kTime, "noon"), "r.csv:42: field time_s: value 'noon': expected a number");
  EXPECT_EQ(refusal_of_field(RecordingText::kFrame, "20.5"),
            "r.csv:42: field frame: value '20.5': expected an integer");
  EXPECT_EQ(refusal_of_field(RecordingText::kStatus, "GOOD"),
            "r.csv:42: field status: value 'GOOD': expected OK or MISSING");
  EXPECT_EQ(refusal_of_field(RecordingText::kTime, "0.51"),
            "r.csv:43: field time_s: value '0.500000': expected 0.51, the time of the other rows of frame 20");
}

TEST_F(BadRecording, IsCutShort) {
  std::string text = test::beating_recording().tracker.text();
  text.resize(text.rfind("OK") + 12);
  EXPECT_EQ(refusal_of(text).substr(0, 29), "r.csv:321: field row: value '");
  EXPECT_TRUE(refusal_of(text).ends_with("': expected 12 fields, found 6 (truncated last row)")) << refusal_of(text);
}

TEST_F(BadRecording, IsOfAnotherCatheter) {
  EXPECT_EQ(refusal_of_field(RecordingText::kSensor, "stylus"),
            "r.csv:42: field sensor: value 'stylus': expected a sensor of the catheter (tip, shaft), or [recording] "
            "ignore_sensors of the catheter file to name it");
  RecordingText alone = test::beating_recording().tracker;
  std::erase_if(alone.rows, [](const auto& row) { return row[RecordingText::kSensor] == "shaft"; });
  EXPECT_EQ(refusal_of(alone.text()),
            "r.csv: field sensor: value 'shaft': expected this sensor of the catheter to occur; the recording has tip");
  RecordingText away = test::beating_recording().tracker;
  for (auto& row : away.rows) row[RecordingText::kX] = std::to_string(std::stod(row[RecordingText::kX]) + 300.0);
  const std::string message = refusal_of(away.text());
  EXPECT_TRUE(message.starts_with("r.csv: sensor \"tip\": never nearer than 3")) << message;
  EXPECT_TRUE(
      message.ends_with(" mm to the base of the catheter file: expected at most 125 mm; is [base] that of this setup?"))
      << message;
}

TEST_F(BadRecording, IsInMetres) {
  RecordingText metres = test::beating_recording().tracker;
  for (auto& row : metres.rows)
    for (const auto column : {RecordingText::kX, RecordingText::kY, RecordingText::kZ})
      row[column] = std::to_string(1e-3 * std::stod(row[column]));
  const std::string far = refusal_of(metres.text());
  EXPECT_TRUE(far.starts_with("r.csv: sensor \"tip\": never nearer than 18")) << far;
  EXPECT_TRUE(far.ends_with("expected at most 125 mm; are the positions in metres instead of millimetres?")) << far;
  // Where the base is the tracker's origin everything seems to sit in the clamp.
  write_catheter("position_mm = [20.0, -40.0, -180.0]", "position_mm = [0, 0, 0]");
  EXPECT_EQ(estimate_refusal(),
            "r.csv: sensor \"tip\": never farther than 0.2198 mm from the base, though 70 mm along the shaft: expected "
            "millimetres; are the positions in metres?");
}

TEST_F(BadRecording, TendonFile) {
  write("t.csv", "time_s,moment_1_Nm,moment_2_Nm,sigma_Nm\n0,1e-3,0,0\n0,1e-3,0,0\n");
  EXPECT_EQ(estimate_refusal({"--tendon", "t.csv"}),
            "--tendon t.csv: the catheter file has no [tendon]: expected its model");
  write_catheter("[base]", "[tendon]\nmodel = \"couple\"\n[base]");
  EXPECT_EQ(estimate_refusal({"--tendon", "t.csv"}),
            "t.csv:3: field time_s: value '0': expected a time later than 0, that of the row before");
  EXPECT_EQ(estimate_refusal({"--tendon", "no.csv"}),
            "no.csv: cannot be opened: No such file or directory: expected a readable text file");
}

// A position-only row is a point: what a sensor of kind "position" wants.
TEST_F(BadRecording, PointsAreGoodForPositionSensors) {
  RecordingText points = test::beating_recording().tracker;
  for (auto& row : points.rows)
    for (const auto column : {RecordingText::kQ0, RecordingText::kQx, RecordingText::kQy, RecordingText::kQz})
      row[column].clear();
  write("r.csv", points.text());
  EXPECT_EQ(summary()["readings_not_used"]["no orientation"], 320);
  write_catheter("kind = \"pose\"\narc_length_mm = 70.0", "kind = \"position\"\narc_length_mm = 70.0");
  const auto said = summary();
  EXPECT_EQ(said["readings_not_used"]["no orientation"], 160);
  // A lone point is refused where the force moves faster than predicted: nothing tells that from an outlier.
  EXPECT_GE(said["frames_by_status"]["UPDATED"], 150);
}

}  // namespace
}  // namespace palpate
