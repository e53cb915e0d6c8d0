// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/math/rotation.hpp>
#include <palpate/session/catheter_change.hpp>
#include <tests/apps/recording_text.hpp>
#include <tests/session/recorded_session.hpp>

namespace palpate::test {
namespace {

Catheter catheter() { return session::settings_of({"one", "one.toml", beating_recording().catheter, {}}).catheter; }

TEST(CatheterChange, IsTheSameToTheLastBitAfterText) {
  Catheter tared = catheter();
  tared.base.T_tracker_base = {exp_so3({0.1, -0.2, 1.0 / 3.0}), {1e-3 / 3.0, -0.1, 0.7}};
  tared.base.position_sigma_m = 1e-4 / 3.0;
  tared.base.covariance = Eigen::Matrix<double, 6, 6>::Random();
  tared.rod.sections[0].precurvature_per_m = {24.57 / 3.0, -1.0, 0.1};
  tared.precurvature_sigma_per_m = {0.3, 0.7, 0.0};
  tared.rod.distributed_load_base_N_per_m = {0.0, 0.1 / 3.0, 0.2};
  const std::string text = session::catheter_change(tared).dump();

  Catheter back = catheter();
  session::apply_catheter_change(nlohmann::json::parse(text), back);
  EXPECT_EQ(back.base.T_tracker_base.R, tared.base.T_tracker_base.R);
  EXPECT_EQ(back.base.T_tracker_base.p, tared.base.T_tracker_base.p);
  EXPECT_EQ(back.base.position_sigma_m, tared.base.position_sigma_m);
  EXPECT_EQ(*back.base.covariance, *tared.base.covariance);
  EXPECT_EQ(back.rod.sections[0].precurvature_per_m, tared.rod.sections[0].precurvature_per_m);
  EXPECT_EQ(back.precurvature_sigma_per_m, tared.precurvature_sigma_per_m);
  EXPECT_EQ(back.rod.distributed_load_base_N_per_m, tared.rod.distributed_load_base_N_per_m);
}

TEST(CatheterChange, WhatIsNoneChangesNothing) {
  Catheter unchanged = catheter();
  nlohmann::json change = session::catheter_change(unchanged);
  change["base"]["R_tracker_base"].erase(0);
  unchanged.base.T_tracker_base.p.x() = 5.0;
  EXPECT_THROW(session::apply_catheter_change(change, unchanged), InputError);
  EXPECT_THROW(session::apply_catheter_change("text", unchanged), InputError);
  EXPECT_EQ(unchanged.base.T_tracker_base.p.x(), 5.0);
}

TEST(CatheterChange, OnlyTareAndBaseAreChanges) {
  session::LiveRecord event;
  event.kind = session::LiveRecord::Kind::kEvent;
  CatheterFile settings = session::settings_of({"one", "one.toml", beating_recording().catheter, {}});
  event.event = "note";
  event.data = "{}";
  EXPECT_FALSE(session::apply_event(event, settings));
  event.event = "tare";
  EXPECT_THROW(session::apply_event(event, settings), InputError);
}

}  // namespace
}  // namespace palpate::test
