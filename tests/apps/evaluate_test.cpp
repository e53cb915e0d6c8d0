// SPDX-License-Identifier: Apache-2.0
#include <tests/apps/app_fixture.hpp>

namespace palpate {
namespace {

class BadEvaluation : public test::App {
 protected:
  void SetUp() override {
    test::App::SetUp();
    write("f.csv", "time_s,fx_tip_N,fy_tip_N,fz_tip_N\n0,0,0,0\n9,0,0,0\n");
    ASSERT_EQ(estimate().exit_code, 0);
  }
  std::string refusal_of_truth(const char* rows) const {
    write("f.csv", std::string("time_s,fx_tip_N,fy_tip_N,fz_tip_N\n") + rows);
    return refusal({"evaluate", "--estimate", "e.csv", "--truth", "f.csv"});
  }
  /// The first occurrence of a part of e.csv is replaced.
  std::string refusal_of_estimate(const std::string& part, const char* replacement) const {
    std::string text = contents(path("e.csv"));
    write("x.csv", text.replace(text.find(part), part.size(), replacement));
    return refusal({"evaluate", "--estimate", "x.csv", "--truth", "f.csv"});
  }
};

TEST_F(BadEvaluation, Truth) {
  EXPECT_EQ(refusal_of_truth("0,0,0,0\n1,0,0,0\n1,0,0,0\n"),
            "f.csv:4: field time_s: value '1': expected a time later than 1, that of the row before");
  EXPECT_EQ(refusal_of_truth("0,0,x,0\n"), "f.csv:2: field fy_tip_N: value 'x': expected a number");
  EXPECT_EQ(refusal_of_truth("0,0,nan,0\n"), "f.csv:2: field fy_tip_N: value 'nan': expected a finite number");
  EXPECT_EQ(refusal_of_truth("100,0,0,0\n101,0,0,0\n"),
            "f.csv: no frame to judge: expected force samples between the estimate's first second and its end");
  EXPECT_EQ(refusal({"evaluate", "--estimate", "e.csv", "--truth", "r.csv"}).substr(0, 15), "r.csv:1: field ");
}

TEST_F(BadEvaluation, Estimate) {
  EXPECT_EQ(refusal_of_estimate("sigma_y_N", "sigma_N").substr(0, 29), "x.csv:1: field header: value ");
  EXPECT_EQ(
      refusal_of_estimate("UPDATED", "GREAT"),
      "x.csv:2: field status: value 'GREAT': expected UPDATED, RESEEDED, AMBIGUOUS, REJECTED, HELD, NOT_CONVERGED "
      "or STALE");
  EXPECT_EQ(refusal_of_estimate("\n0.025,", "\n0.025,,").substr(0, 26), "x.csv:3: field row: value ");
  EXPECT_EQ(refusal_of_estimate("\n0.025,", "\nsoon,"), "x.csv:3: field time_s: value 'soon': expected a number");
  EXPECT_EQ(refusal({"evaluate", "--estimate", "no.csv", "--truth", "f.csv"}),
            "no.csv: cannot be opened: No such file or directory: expected a readable text file");
}

TEST_F(BadEvaluation, Bounds) {
  const auto with = [](const char* name) {
    return Arguments{"evaluate", "--estimate", "e.csv", "--truth", "f.csv", "--bounds", "b.json", "--recording", name};
  };
  EXPECT_EQ(refusal(with("run")), "b.json: cannot be read");
  write("b.json", "[1, 2");
  EXPECT_EQ(refusal(with("run")), "b.json: expected a JSON object");
  write("b.json",
        R"({"run": {"rms_bound_tip_frame_N": [1e-3, 2e-3, 4e-3]}, "bad": {"rms_bound_tip_frame_N": [1, 2, "x"]}})");
  EXPECT_EQ(refusal(with("ran")),
            "b.json: no entry \"ran\": expected the name of a recording in this file (--recording)");
  EXPECT_EQ(refusal(with("bad")), "b.json: bad: expected \"rms_bound_tip_frame_N\" with three numbers");
  auto arguments = with("run");
  arguments.push_back("--json");
  const auto judged = nlohmann::json::parse(palpate(arguments).out, nullptr, false);
  EXPECT_DOUBLE_EQ(judged["rmse_over_bound"]["z"].get<double>() * 4e-3, judged["rmse_N"]["z"].get<double>());
}

}  // namespace
}  // namespace palpate
