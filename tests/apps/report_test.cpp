// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <tests/apps/app_fixture.hpp>

namespace palpate::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// `palpate report` of the good recording has run; a program built without pages (PALPATE_WEB) has nothing to show.
class Report : public App {
 protected:
  void SetUp() override {
    App::SetUp();
    const ProgramRun run = report();
    if (run.err.find("built without pages") != std::string::npos) GTEST_SKIP() << run.err;
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  ProgramRun report(const Arguments& more = {}) const { return palpate(arguments(more)); }
  std::string report_refusal(const Arguments& more = {}) const { return refusal(arguments(more)); }
  std::string page() const { return contents(path("report.html")); }
  /// The data in the page.
  nlohmann::json data() const {
    const std::string html = page(), from = "id=\"data\">";
    const std::size_t begin = html.find(from) + from.size();
    return nlohmann::json::parse(html.substr(begin, html.find("</script>", begin) - begin));
  }

 private:
  static Arguments arguments(const Arguments& more) {
    Arguments all{"report", "r.csv", "--catheter", "c.toml", "--out", "report.html"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
};

TEST_F(Report, EstimatesByItselfAsEstimateDoes) {
  const nlohmann::json own = data();
  ASSERT_EQ(estimate().exit_code, 0);
  ASSERT_EQ(report({"--estimate", "e.csv"}).exit_code, 0);
  const nlohmann::json read = data();
  for (const char* part : {"fx_N", "fy_N", "fz_N", "status", "time_s"})
    EXPECT_EQ(own["curves"][part], read["curves"][part]) << part;
  EXPECT_EQ(own["figures"]["contacts"].size(), read["figures"]["contacts"].size());
  EXPECT_THAT(own["health"]["words"].get<std::string>(), HasSubstr("sigma"));
  EXPECT_EQ(read["health"]["words"], "");
  const EstimateTable rows = table();
  ASSERT_EQ(rows.size(), own["curves"]["fx_N"].size());
  for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(number(rows[i], "fx_tip_N"), own["curves"]["fx_N"][i]);
}

TEST_F(Report, ShapeEndsWhereTheSensorIs) {
  const nlohmann::json shown = data();
  for (const nlohmann::json& moment : shown["shapes"]["moments"]) {
    const std::size_t last = moment["shaft"].size() - 3;
    double distance_mm = 0.0;
    for (std::size_t k = 0; k < 3; ++k)
      distance_mm =
          std::hypot(distance_mm, moment["shaft"][last + k].get<double>() - moment["seen"][0][k].get<double>());
    EXPECT_LT(distance_mm, 5.0 * 0.28);  // the tip sensor sits at the end; its noise is 0.28 mm an axis
    EXPECT_EQ(moment["shaft"][0], 0.0);
  }
}

TEST_F(Report, RefusesATruthOfAnotherTime) {
  write("far.force.csv", "time_s,fx_tip_N,fy_tip_N,fz_tip_N\n1000000,0,0,0\n1000001,0,0,0\n");
  EXPECT_THAT(report_refusal({"--truth", "far.force.csv"}), HasSubstr("far.force.csv: no sample in the recording's"));
}

TEST_F(Report, RefusesEmptyValues) {
  for (const char* flag : {"--estimate", "--truth", "--tendon", "--reference", "--title"})
    EXPECT_THAT(report_refusal({flag, ""}), HasSubstr(std::string(flag) + ": expected a value, found an empty one"));
}

TEST_F(Report, WarnsWhereHardlyAFrameWasMeasured) {
  std::string text = contents(path("r.csv"));
  for (std::size_t at = 0; (at = text.find(",OK,", at)) != std::string::npos;) text.replace(at, 4, ",MISSING,");
  write("r.csv", text);
  EXPECT_THAT(report().err, HasSubstr("warning: r.csv: only 0 of "));
}

TEST_F(Report, IsOneFileThatMayLoadNothing) {
  const std::string html = page();
  EXPECT_THAT(html, HasSubstr("default-src 'none'"));
  EXPECT_THAT(html, HasSubstr("not for clinical use"));
  EXPECT_THAT(html, Not(HasSubstr("<link rel=\"stylesheet\"")));
  EXPECT_THAT(html, Not(HasSubstr("<script src")));
}

TEST_F(Report, TextOfOthersStaysText) {
  write_catheter("virtual ablation catheter", "</script><b>\\u2028");
  const std::string title = "<i>& \xe2\x80\xa8 \xff";
  ASSERT_EQ(report({"--title", title}).exit_code, 0);
  EXPECT_THAT(page(), HasSubstr("<title>&lt;i&gt;&amp; "));
  EXPECT_THAT(page(), Not(HasSubstr("</script><b>")));
  EXPECT_EQ(data()["catheter"]["name"], "</script><b>\xe2\x80\xa8");
}

TEST_F(Report, SummaryForAProgram) {
  const ProgramRun run = report({"--json", "--bands", "10,20", "--contact", "2"});
  const nlohmann::json json = nlohmann::json::parse(run.out, nullptr, false);
  ASSERT_TRUE(json.is_object()) << run.out << run.err;
  EXPECT_EQ(json["bands"]["seconds"].size(), 3u);
  EXPECT_THAT(json["contact_rule"].get<std::string>(), HasSubstr("at least 2 g"));
  EXPECT_EQ(json["bytes"], page().size());
}

TEST_F(Report, RefusesBadInputs) {
  std::filesystem::remove(path("report.html"));
  EXPECT_THAT(report_refusal({"--bands", "5,5"}),
              HasSubstr("--bands 5,5: '5': expected positive grams-force that rise"));
  EXPECT_THAT(report_refusal({"--bands", "-1"}), HasSubstr("--bands -1"));
  EXPECT_THAT(report_refusal({"--bands", "5,nan"}), HasSubstr("'nan'"));
  EXPECT_THAT(report_refusal({"--contact", "0"}), HasSubstr("--contact 0: expected grams-force"));
  write("e.csv", "time_s,fx_tip_N\n0,0\n");
  EXPECT_THAT(report_refusal({"--estimate", "e.csv"}), HasSubstr("fy_tip_N"));
  ASSERT_EQ(estimate().exit_code, 0);
  std::string rows = contents(path("e.csv"));
  write("e.csv", rows.substr(0, rows.rfind('\n', rows.size() - 2) + 1));
  EXPECT_THAT(report_refusal({"--estimate", "e.csv"}), HasSubstr("e.csv: 159 rows: expected 160"));
  write("f.csv", "time_s,fx_tip_N\n0,0\n");
  EXPECT_THAT(report_refusal({"--truth", "f.csv"}), HasSubstr("f.csv"));
  EXPECT_THAT(refusal({"report", "r.csv", "--catheter", "c.toml", "--out", "r.csv"}), HasSubstr("another file than"));
}

TEST_F(Report, ARecordingWithoutAnyMeasurementSaysSo) {
  RecordingText text = beating_recording().tracker;
  for (RecordingText::Row& row : text.rows) RecordingText::set_missing(row);
  write("r.csv", text.text());
  ASSERT_EQ(report().exit_code, 0);
  const nlohmann::json found = data();
  EXPECT_TRUE(found["figures"]["peak"].is_null());
  EXPECT_TRUE(found["figures"]["contacts"].empty());
  EXPECT_TRUE(found["health"]["innovation"].is_null());
}

TEST_F(Report, APatchyRecordingIsThinnedLikeAWholeOne) {
  write("s.toml",
        "schema = 1\n[scenario]\ncatheter = \"c.toml\"\nduration_s = 80\n[tracker]\nmissing_percent = 60\n"
        "[load]\nkind = \"force\"\nforce_tip_N = [0, 0.02, -0.05]\n");
  ASSERT_EQ(palpate({"simulate", "s.toml", "--out", "s"}).exit_code, 0);
  ASSERT_EQ(palpate({"report", "s.tracker.csv", "--catheter", "s.catheter.toml", "--out", "report.html"}).exit_code, 0);
  EXPECT_GT(data()["curves"]["spans"].size(), 500U) << "frames without a reading";
  EXPECT_LE(data()["shapes"]["moments"].size(), 802U);
}

}  // namespace
}  // namespace palpate::test
