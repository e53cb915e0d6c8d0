// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <hdf5.h>

#include <palpate/session/writer.hpp>
#include <tests/apps/app_fixture.hpp>
#include <tests/session/recorded_session.hpp>

namespace palpate::test {
namespace {

using ::testing::HasSubstr;

class ExportVerb : public App {
 protected:
  void SetUp() override {
    App::SetUp();
    record_session(path("s"), "one", beating_recording().catheter, path("r.csv"));
  }
};

/// Through the files and the offline estimator the same forces come out as were recorded.
TEST_F(ExportVerb, TheCsvFilesGiveTheSameEstimate) {
  const ProgramRun run = palpate({"export", "s", "--out", "x"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  EXPECT_EQ(contents(path("x.catheter.toml")), beating_recording().catheter);
  ASSERT_EQ(palpate({"estimate", "--catheter", "x.catheter.toml", "x.tracker.csv", "--out", "offline.csv"}).exit_code,
            0);
  EXPECT_EQ(contents(path("offline.csv")), contents(path("x.estimate.csv")));
  EXPECT_THAT(contents(path("x.events.csv")), HasSubstr(R"("note","{""text"":""contact""}")"));
}

TEST_F(ExportVerb, ThePlusSequenceIsARecordingAgain) {
  ASSERT_EQ(palpate({"export", "s", "--out", "x", "--format", "igs.mha"}).exit_code, 0);
  const ProgramRun run = palpate({"estimate", "--catheter", "c.toml", "x.igs.mha", "--out", "m.csv"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  ASSERT_EQ(estimate().exit_code, 0);
  const EstimateTable plus = table("m.csv"), csv = table();
  ASSERT_EQ(plus.size(), csv.size());
  for (std::size_t i = 0; i < csv.size(); ++i)  // a rotation goes through a matrix and back
    EXPECT_NEAR(number(plus[i], "fz_tip_N"), number(csv[i], "fz_tip_N"), 1e-6);
  EXPECT_THAT(contents(path("x.igs.mha")), HasSubstr(fmt::format("DimSize = 1 1 {}\n", csv.size())));
}

TEST_F(ExportVerb, Hdf5HoldsEveryNumberWithItsUnit) {
  ASSERT_EQ(palpate({"export", "s", "--out", "x", "--format", "hdf5"}).exit_code, 0);
  const hid_t file = H5Fopen(path("x.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  ASSERT_GE(file, 0);
  session::SessionReader reader(path("s"));
  std::vector<double> stored;
  session::LiveRecord record;
  while (reader.next(record))
    if (record.kind == session::LiveRecord::Kind::kFrame) stored.push_back(record.estimate.force_tip_N.z());
  const hid_t set = H5Dopen2(file, "/catheter_0/estimate/fz_tip_N", H5P_DEFAULT);
  ASSERT_GE(set, 0);
  std::vector<double> exported(stored.size());
  const hid_t space = H5Dget_space(set);
  EXPECT_EQ(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)), stored.size());
  H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, exported.data());
  EXPECT_EQ(exported, stored);
  const hid_t unit = H5Aopen(set, "unit", H5P_DEFAULT), type = H5Aget_type(unit);
  std::string text(H5Tget_size(type), ' ');
  H5Aread(unit, type, text.data());
  EXPECT_EQ(text, "N");
  H5Tclose(type);
  H5Aclose(unit);
  H5Sclose(space);
  H5Dclose(set);
  H5Fclose(file);
}

TEST_F(ExportVerb, RefusesWhatItCannotWriteAndLeavesNothing) {
  EXPECT_THAT(refusal({"export", "s", "--out", "x", "--format", "xls"}), HasSubstr("expected csv, igs.mha or hdf5"));
  EXPECT_THAT(refusal({"export", "s", "--out", "no/x"}), HasSubstr("expected the folder no to exist"));
  EXPECT_THAT(refusal({"export", "c.toml", "--out", "x"}), HasSubstr("does not begin as SQLite files do"));
  EXPECT_THAT(refusal({"export", "s", "--out", "x", "--catheter", "two"}), HasSubstr("catheter \"two\""));
  EXPECT_THAT(palpate({"export", "--help"}).out, HasSubstr("Example: palpate export"));
}

TEST_F(ExportVerb, EachOfSeveralCathetersGetsFilesOfItsOwn) {
  const std::vector<session::SessionCatheter> catheters{
      {"left atrium", "c.toml", contents(path("c.toml")), {"tip", "shaft"}},
      {"right/2", "c.toml", contents(path("c.toml")), {"tip", "shaft"}}};
  session::SessionWriter(path("two"), catheters, {});
  ASSERT_EQ(palpate({"export", "two", "--out", "y"}).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(path("y.left_atrium.tracker.csv")));
  EXPECT_TRUE(std::filesystem::exists(path("y.right_2.estimate.csv")));
  ASSERT_EQ(palpate({"export", "two", "--out", "z", "--catheter", "right/2"}).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(path("z.events.csv")));
}

}  // namespace
}  // namespace palpate::test
