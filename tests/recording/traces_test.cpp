// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <palpate/recording/force_csv.hpp>
#include <palpate/recording/tendon_csv.hpp>
#include <tests/recording/temporary_folder.hpp>
#include <tests/shared_data.hpp>

namespace palpate {
namespace {

constexpr std::string_view kForceHeader = "time_s,fx_tip_N,fy_tip_N,fz_tip_N\n";
constexpr std::string_view kTendonHeader = "time_s,moment_1_Nm,moment_2_Nm,sigma_Nm,tension_N,knob_rad\n";

class Traces : public test::TemporaryFolder {
 protected:
  ForceTrace force(std::string_view rows) const {
    return read_force_csv(write("f.csv", std::string(kForceHeader).append(rows)));
  }
  TendonTrace tendon(std::string_view rows, const Tendon& with = {}) const {
    return read_tendon_csv(write("t.csv", std::string(kTendonHeader).append(rows)), with);
  }
};

TEST_F(Traces, ForceIsLinearBetweenSamplesAndClampedOutside) {
  const auto trace = force("0,1,2,3\n2,3,2,-1\n3,0,0,0\n");
  EXPECT_TRUE(trace.force_base_N.empty());
  EXPECT_TRUE(trace.interpolate(0.5).force_tip_N.isApprox(Vector3d(1.5, 2, 2)));
  EXPECT_TRUE(trace.interpolate(0.5).inside);
  EXPECT_EQ(trace.interpolate(2.0).force_tip_N, Vector3d(3, 2, -1));
  EXPECT_TRUE(trace.interpolate(0.0).inside);
  EXPECT_TRUE(trace.interpolate(3.0).inside);
  EXPECT_EQ(trace.interpolate(-1.0).force_tip_N, Vector3d(1, 2, 3));
  EXPECT_EQ(trace.interpolate(9.0).force_tip_N, Vector3d(0, 0, 0));
  for (const double outside_s : {-1.0, 9.0, std::nan("")}) EXPECT_FALSE(trace.interpolate(outside_s).inside);
}

TEST_F(Traces, ForceRefuses) {
  const auto error = [&](const char* rows) { return error_of([&] { force(rows); }); };
  EXPECT_EQ(error("0,1,2,3\n0,1,2,3\n"),
            "f.csv:3: field time_s: value '0': expected a time later than 0, that of the row before");
  EXPECT_EQ(error("1,1,2,3\n0.5,1,2,3\n"),
            "f.csv:3: field time_s: value '0.5': expected a time later than 1, that of the row before");
  EXPECT_EQ(error("nan,1,2,3\n"), "f.csv:2: field time_s: value 'nan': expected a finite number");
  EXPECT_EQ(error("0,1,inf,3\n"), "f.csv:2: field fy_tip_N: value 'inf': expected a finite number");
  EXPECT_EQ(error("0,1,,3\n"), "f.csv:2: field fy_tip_N: value '': expected a number");
  EXPECT_EQ(error("0,1,2,3\n1,2"), "f.csv:3: field row: value '1,2': expected 4 fields, found 2 (truncated last row)");
  EXPECT_EQ(error(""), "f.csv:1: field row: value '': expected at least one row after the header");
  EXPECT_EQ(
      error_of([&] { read_force_csv(write("g.csv", "time_s,fx_tip_N,fy_tip_N,fz_tip_N,fx_base_N\n0,1,2,3,4\n")); }),
      "g.csv:1: field header: value 'time_s,fx_tip_N,fy_tip_N,fz_tip_N,fx_base_N': expected a column named "
      "fy_base_N");
}

TEST_F(Traces, TendonMomentOrTensionTimesOffset) {
  Tendon with;
  with.offset_m = 0.9e-3;
  with.moment_sigma_fraction = 0.02;
  const auto trace = tendon("0,0.004,0.001,0.0001,,\n1,,,,5,\n", with);
  EXPECT_EQ(trace.moment_Nm[0], Eigen::Vector2d(0.004, 0.001));
  EXPECT_EQ(trace.sigma_Nm[0], 0.0001);
  EXPECT_TRUE(trace.moment_Nm[1].isApprox(Eigen::Vector2d(4.5e-3, 0)));
  EXPECT_NEAR(trace.sigma_Nm[1], 9e-5, 1e-12);
  EXPECT_TRUE(trace.interpolate(0.5).moment_Nm.isApprox(Eigen::Vector2d(4.25e-3, 0.5e-3)));
  EXPECT_NEAR(trace.interpolate(0.5).sigma_Nm, 9.5e-5, 1e-12);
  EXPECT_FALSE(trace.interpolate(2.0).inside);
}

TEST_F(Traces, TendonRefuses) {
  const auto error = [&](const char* rows) { return error_of([&] { tendon(rows); }); };
  EXPECT_EQ(
      error("0,,,,5,\n"),
      "t.csv:2: field moment_1_Nm: value '': expected a moment in N m, or [tendon] offset_mm in the catheter file "
      "to use tension_N");
  EXPECT_EQ(error("0,,,,,\n"), "t.csv:2: field moment_1_Nm: value '': expected a moment in N m, or a tension_N");
  EXPECT_EQ(error("0,1,,0,,\n"), "t.csv:2: field moment_2_Nm: value '': expected a number");
  EXPECT_EQ(error("0,1,0,-1,,\n"), "t.csv:2: field sigma_Nm: value '-1': expected a standard deviation, 0 or more");
  EXPECT_EQ(error("0,1,0,0,,\n0,1,0,0,,\n"),
            "t.csv:3: field time_s: value '0': expected a time later than 0, that of the row before");
}

// wc -l: 1201 lines and 2401 lines with the header.
TEST_F(Traces, SharedRecordings) {
  PALPATE_NEEDS_SHARED("recordings");
  for (const char* name : {"weight_planar", "heartbeat", "faults"}) {
    const auto trace = read_force_csv(test::shared_data("recordings") / (std::string(name) + ".force.csv"));
    EXPECT_EQ(trace.times_s.size(), 1200u);
    EXPECT_EQ(trace.force_base_N.size(), 1200u);
  }
  const auto trace = read_tendon_csv(test::shared_data("recordings/stiffness_drift.tendon.csv"));
  EXPECT_EQ(trace.times_s.size(), 2400u);
  EXPECT_EQ(trace.moment_Nm[0], Eigen::Vector2d(0.00533964128, 0.0));
}

}  // namespace
}  // namespace palpate
