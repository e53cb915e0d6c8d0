// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <palpate/math/errors.hpp>
#include <palpate/recording/run_reader.hpp>
#include <tests/recording/temporary_folder.hpp>

namespace palpate {
namespace {

using ::testing::HasSubstr;

constexpr const char* kHeader =
    "time_s,fx_tip_N,fy_tip_N,fz_tip_N,sigma_x_N,sigma_y_N,sigma_z_N,cov_xy_N2,cov_xz_N2,cov_yz_N2,fx_base_N,"
    "fy_base_N,fz_base_N,status,sensors_used,nis,dof,evaluations,EI1_Nm2,sigma_EI1_Nm2,EI2_Nm2,sigma_EI2_Nm2\n";
constexpr const char* kRest = ",0.01,0.02,-0.03,1e-3,2e-3,3e-3,0,0,0,0,0,0,UPDATED,2,11.5,12,4,2e-4,1e-6,3e-4,1e-6\n";

class RunReaderTest : public test::TemporaryFolder {
 protected:
  static TrackerRecording recording(const std::vector<double>& times_s) {
    TrackerRecording made;
    made.source = "r.csv";
    made.sensor_names = {"tip"};
    for (const double time_s : times_s)
      made.frames.push_back(
          {.time_s = time_s, .number = static_cast<std::int64_t>(made.frames.size()), .readings = {{}}});
    made.notes = {"a note"};
    return made;
  }
  std::string estimate(const std::vector<std::string>& times_s) const {
    std::string text = kHeader;
    for (const std::string& time_s : times_s) text += time_s + kRest;
    write("e.csv", text);
    return path("e.csv").string();
  }
  static std::string refusal(TrackerRecording recording, const std::string& estimate) {
    try {
      FileRunReader(std::move(recording), {}, estimate);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
};

TEST_F(RunReaderTest, FramesComeWithTheirEstimates) {
  RunDescription description;
  description.catheter_text = "text";
  FileRunReader reader(recording({0.0, 0.1, 0.2, 1.0}), description, estimate({"0", "0.1", "0.2", "1"}));
  const RunReader& run = reader;
  EXPECT_TRUE(run.description().has_estimates);
  EXPECT_EQ(run.description().source, "r.csv");
  EXPECT_EQ(run.description().catheter_text, "text");
  RunMoment moment;
  std::vector<double> times_s;
  while (reader.next(moment)) {
    ASSERT_TRUE(moment.estimate);
    EXPECT_EQ(moment.estimate->time_s, moment.frame.time_s);
    times_s.push_back(moment.frame.time_s);
  }
  EXPECT_EQ(times_s, (std::vector<double>{0.0, 0.1, 0.2, 1.0}));
  EXPECT_EQ(moment.estimate->sensors_used, 2);
  EXPECT_EQ(moment.estimate->nis, 11.5);
  EXPECT_EQ(moment.estimate->dof, 12);
  EXPECT_EQ(moment.estimate->shaft.stiffness_Nm2, Vector3d(2e-4, 3e-4, 0.0));
  ASSERT_EQ(run.events().size(), 1u);
  EXPECT_EQ(run.events()[0].text, "a note");
  ASSERT_EQ(run.gaps().size(), 1u);
  EXPECT_EQ(run.gaps()[0].from_s, 0.2);
  EXPECT_EQ(run.gaps()[0].to_s, 1.0);
}

TEST_F(RunReaderTest, WithoutEstimate) {
  FileRunReader reader(recording({0.0}), {}, "");
  RunMoment moment;
  ASSERT_TRUE(reader.next(moment));
  EXPECT_FALSE(moment.estimate);
  EXPECT_FALSE(reader.next(moment));
  EXPECT_TRUE(reader.gaps().empty());
}

TEST_F(RunReaderTest, RowsOfAnotherRecording) {
  EXPECT_THAT(refusal(recording({0.0, 0.1}), estimate({"0", "0.2"})),
              HasSubstr("e.csv:3: field time_s: value '0.2': expected 0.1 s, the time of frame 1 of r.csv"));
  EXPECT_THAT(refusal(recording({0.0, 0.1}), estimate({"0"})), HasSubstr("1 rows: expected 2"));
  EXPECT_THAT(refusal(recording({0.0}), estimate({"0", "0.1"})), HasSubstr("2 rows: expected 1"));
}

}  // namespace
}  // namespace palpate
