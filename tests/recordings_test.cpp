// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <palpate/evaluation/evaluation.hpp>
#include <palpate/observer/force_observer.hpp>
#include <palpate/recording/tracker_recording.hpp>
#include <tests/shared_data.hpp>

/// The observer with its defaults on recordings that another program made, held against the Cramer-Rao bound of a
/// single frame. Says how good the estimate is, and whether its covariance is true.
namespace palpate {
namespace {

constexpr const char* kFolder = "recordings";

nlohmann::json load(const char* name) {
  return nlohmann::json::parse(std::ifstream(test::shared_data(kFolder) / name));
}

Vector3d vector3(const nlohmann::json& j) {
  return {j.at(0).get<double>(), j.at(1).get<double>(), j.at(2).get<double>()};
}

Catheter catheter_of(const nlohmann::json& j) {
  const auto number = [&](const char* key) { return j.at(key).get<double>(); };
  Catheter catheter;
  catheter.rod = uniform_rod(
      number("length_m"),
      {number("bending_stiffness_1_Nm2"), number("bending_stiffness_2_Nm2"), number("torsional_stiffness_Nm2")},
      {number("precurvature_1_per_m"), 0.0, 0.0});
  for (const char* name : {"tip", "shaft"}) {
    Sensor& sensor = catheter.sensors.emplace_back();
    sensor.name = name;
    sensor.arc_length_m = std::min(j.at("sensor_arc_length_m").at(name).get<double>(), catheter.rod.length_m());
    sensor.noise_m.setConstant(number("noise_sd_mm_per_axis") * kMetresPerMillimetre);
    sensor.noise_rad = number("noise_sd_deg_per_axis") * kRadiansPerDegree;
  }
  const auto& base = j.at("base_in_tracker");
  const auto& q = base.at("quaternion_wxyz");
  const Eigen::Quaterniond turn(q.at(0).get<double>(), q.at(1).get<double>(), q.at(2).get<double>(),
                                q.at(3).get<double>());
  catheter.base.T_tracker_base = {turn.normalized().toRotationMatrix(),
                                  vector3(base.at("position_mm")) * kMetresPerMillimetre};
  return catheter;
}

class Recordings : public ::testing::TestWithParam<const char*> {
 protected:
  static std::vector<EstimateRow> estimate(const std::string& name) {
    const Catheter catheter = catheter_of(load("recordings.json").at(name));
    TrackerRecording recording = read_tracker_recording(test::shared_data(kFolder) / (name + ".tracker.csv"));
    bind_to_catheter(recording, catheter);
    ForceObserver observer(catheter, ObserverOptions{});
    std::vector<EstimateRow> rows;
    for (const TrackerFrame& frame : recording.frames) {
      const Estimate e = observer.update(frame);
      rows.push_back({e.time_s, e.force_tip_N, e.covariance_tip_N2, e.status});
    }
    return rows;
  }
};

/// Share within 3 sigma: 99.73 % if the sigmas are true, 99 % asked. Mean NEES 3 if the covariance is true; the random
/// walk is not the law by which these forces move, hence the band of 20 %.
TEST_P(Recordings, ForceIsFollowedAndTheCovarianceIsTrue) {
  PALPATE_NEEDS_SHARED(kFolder);
  const std::string name = GetParam();
  const std::vector<EstimateRow> rows = estimate(name);
  const Evaluation e = evaluate(rows, read_force_csv(test::shared_data(kFolder) / (name + ".force.csv")));
  const Vector3d bound_N = vector3(load("bounds.json").at(name).at("rms_bound_tip_frame_N"));
  const Vector3d ratio = e.rmse_N.cwiseQuotient(bound_N), inside = 100.0 * e.inside_3_sigma;
  fmt::print(
      "{}: {} frames, {} updated; RMSE/bound {:.4f} {:.4f} {:.4f}; in 3 sigma {:.2f} {:.2f} {:.2f} %; NEES {:.3f}\n",
      name, e.frames, e.updated, ratio.x(), ratio.y(), ratio.z(), inside.x(), inside.y(), inside.z(), e.mean_nees);
  EXPECT_EQ(e.outside_truth, 0U);
  EXPECT_GE(e.inside_3_sigma.minCoeff(), 0.99);
  EXPECT_GE(e.mean_nees, 2.4);
  EXPECT_LE(e.mean_nees, 3.6);
  if (name == "faults") return;  // its bound is that of frames without faults
  for (const EstimateRow& row : rows) EXPECT_EQ(row.status, EstimateStatus::kUpdated) << row.time_s << " s";
  EXPECT_LE(ratio.maxCoeff(), 1.03);
}

INSTANTIATE_TEST_SUITE_P(Default, Recordings, ::testing::Values("weight_planar", "heartbeat", "faults"),
                         [](const auto& test_case) { return std::string(test_case.param); });

}  // namespace
}  // namespace palpate
