// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <numbers>
#include <palpate/recording/catheter_file.hpp>
#include <palpate/recording/csv_writers.hpp>
#include <palpate/simulation/virtual_tracker.hpp>
#include <tests/apps/app_fixture.hpp>

namespace palpate {
namespace {

using ::testing::HasSubstr;

/// The real `palpate identify precurvature`, and `palpate estimate` with what it wrote.
class IdentifyPrecurvature : public test::App {
 protected:
  static constexpr double kThreshold_rad = 0.1, kRate_hz = 20.0;

  /// k1 of a handle with play, from 10 to 60 1/m over 2 rad.
  struct Handle {
    double w = 0.0;
    double k1(double knob) {
      w = std::max(knob - kThreshold_rad, std::min(knob + kThreshold_rad, w));
      return 10.0 + 50.0 * std::max(w, 0.0) / 1.9;
    }
  };

  Arguments arguments(const Arguments& more) const {
    Arguments all{"identify", "precurvature", "--catheter", "c.toml", "--out", "new.toml"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  nlohmann::json identified(const Arguments& more) const {
    Arguments all = arguments(more);
    all.push_back("--json");
    const auto run = palpate(all);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return nlohmann::json::parse(run.out, nullptr, false);
  }

  /// Markers 1 cm apart on a circle of curvature k about d1, in `unit` per metre.
  void write_points(double k, double unit = 1e3, int count = 8) const {
    std::string csv = "arc_length_mm,x_mm,y_mm,z_mm\n";
    for (int i = 0; i < count; ++i) {
      const double s = 0.01 * i;
      csv +=
          fmt::format("{},0,{:.9f},{:.9f}\n", 10 * i, -unit * (1.0 - std::cos(k * s)) / k, unit * std::sin(k * s) / k);
    }
    write("points.csv", csv);
  }

  /// A recording m.csv with its h.csv of the handle: `knob` over time, a force on the tip.
  template <class Knob>
  std::vector<Vector3d> record(double duration_s, const Knob& knob, const ForceSchedule& force) const {
    const Catheter catheter = read_catheter_file(path("c.toml")).catheter;
    Handle handle;
    std::vector<TrackerFrame> frames;
    std::vector<Vector3d> truth;
    std::string csv = "time_s,moment_1_Nm,moment_2_Nm,sigma_Nm,tension_N,knob_rad\n";
    for (int i = 0; i < duration_s * kRate_hz; ++i) {
      const double time_s = i / kRate_hz;
      Catheter now = catheter;
      now.rod.sections[0].precurvature_per_m.x() = handle.k1(knob(time_s));
      VirtualRecording one =
          simulate_tracker(now, [&](double) { return force(time_s); },
                           {.rate_hz = kRate_hz, .duration_s = 1.0 / kRate_hz, .seed = 7u + 31u * i});
      one.frames[0].time_s = time_s;
      one.frames[0].number = i;
      frames.push_back(one.frames[0]);
      truth.push_back(one.force_tip_N[0]);
      csv += fmt::format("{:.6f},,,,,{:.6f}\n", time_s, knob(time_s));
    }
    write_tracker_csv(path("m.csv"), catheter, frames);
    write("h.csv", csv);
    return truth;
  }

  /// Table of a whole loop, 21 positions each way, exact.
  void write_loop() const {
    Handle handle;
    std::string csv = "knob_deg,k1_per_m\n";
    for (int i = 0; i < 42; ++i) {
      const double knob = 0.1 * (i < 21 ? i : 41 - i);
      csv += fmt::format("{:.9f},{:.9f}\n", knob * 180.0 / std::numbers::pi, handle.k1(knob));
    }
    write("loop.csv", csv);
  }

  struct Errors {
    double rmse_N = 0.0, inside = 0.0;
  };
  Errors errors_of(const std::vector<Vector3d>& truth) const {
    const test::EstimateTable rows = table();
    Errors out;
    int count = 0;
    for (std::size_t i = 20; i < rows.size(); ++i)
      for (int axis = 0; axis < 3; ++axis, ++count) {
        const std::string letter(1, "xyz"[axis]);
        const double error = test::number(rows[i], "f" + letter + "_tip_N") - truth[i](axis);
        out.rmse_N += error * error;
        out.inside += std::abs(error) <= 1.96 * test::number(rows[i], "sigma_" + letter + "_N") ? 1.0 : 0.0;
      }
    return {std::sqrt(out.rmse_N / count * 3.0), out.inside / count};
  }
};

TEST_F(IdentifyPrecurvature, PointsGiveACatheterFile) {
  write_points(31.5);
  const nlohmann::json json = identified({"points.csv", "--plot", "p.svg"});
  EXPECT_NEAR(json["precurvature_per_m"][0].get<double>(), 31.5, 1e-4);
  EXPECT_EQ(json["told"], (nlohmann::json{true, true, false}));
  const Catheter catheter = read_catheter_file(path("new.toml")).catheter;
  EXPECT_NEAR(catheter.precurvature_per_m().x(), 31.5, 1e-4);
  EXPECT_GT(contents(path("p.svg")).size(), 1000u);
  EXPECT_THAT(contents(path("new.toml")), HasSubstr("# identified: arc through 8 places"));
  const auto run = palpate(arguments({"points.csv", "--free-clamp"}));
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.out, HasSubstr("k1,0 =    31.5000 1/m"));
  EXPECT_THAT(run.err, HasSubstr("palpate: warning: with a free clamp, points do not tell the bending plane"));
}

TEST_F(IdentifyPrecurvature, RecordingOfTheUnloadedShaftGivesOne) {
  record(
      2.0, [](double) { return 1.0; }, [](double) { return Vector3d::Zero(); });
  const nlohmann::json json = identified({"m.csv", "--interval", "0.5:2"});
  Handle handle;
  const double k1 = handle.k1(1.0);
  EXPECT_NEAR(json["precurvature_per_m"][0].get<double>(), k1, 4.0 * json["precurvature_sigma_per_m"][0].get<double>());
  EXPECT_LT(json["precurvature_sigma_per_m"][0].get<double>(), 0.1);
  EXPECT_EQ(json["told"], (nlohmann::json{true, true, true}));
}

/// From the table of a loop to the force: the moving handle no longer looks like one.
TEST_F(IdentifyPrecurvature, MapIsUsedLive) {
  write_catheter("precurvature_per_m = [24.57, 0.0, 0.0]",
                 "precurvature_per_m = [35.0, 0.0, 0.0]\nprecurvature_sigma_per_m = [0.5, 0.1, 0.0]");
  write_loop();
  const nlohmann::json map = identified({"--map", "loop.csv", "--plot", "map.svg"});
  EXPECT_EQ(map["sigma_per_m"][1].get<double>(), 0.1);  // the table has no k2: the file's
  EXPECT_NEAR(map["dead_zone"].get<double>(), 2.0 * kThreshold_rad, 0.03);
  const auto knob = [](double time_s) { return 1.0 - std::cos(2.0 * std::numbers::pi * time_s / 3.5); };
  const std::vector<Vector3d> truth = record(7.0, knob, beating_wall_force);
  const auto fixed = palpate({"estimate", "--catheter", "c.toml", "m.csv", "--out", "e.csv"});
  ASSERT_EQ(fixed.exit_code, 0) << fixed.err;
  const Errors without = errors_of(truth);
  const auto live = palpate({"estimate", "--catheter", "new.toml", "m.csv", "--tendon", "h.csv", "--out", "e.csv"});
  ASSERT_EQ(live.exit_code, 0) << live.err;
  EXPECT_EQ(live.err, "");
  const Errors with = errors_of(truth);
  std::printf(
      "live: RMSE with the map %.4f N (95 %% intervals cover %.1f %%), with the fixed precurvature %.4f N (%.1f %%)\n",
      with.rmse_N, 100.0 * with.inside, without.rmse_N, 100.0 * without.inside);
  EXPECT_LT(with.rmse_N, 0.25 * without.rmse_N);
  EXPECT_GE(with.inside, 0.90);
  EXPECT_EQ(palpate({"estimate", "--catheter", "new.toml", "m.csv", "--tendon", "h.csv", "--state",
                     "force,precurvature", "--smooth", "--out", "e.csv"})
                .exit_code,
            0);
  EXPECT_LT(errors_of(truth).rmse_N, 0.25 * without.rmse_N);
}

TEST_F(IdentifyPrecurvature, RestsOfTheHandleInARecordingGiveTheMap) {
  const auto knob = [](double time_s) {  // a staircase of 2 s a step, up and down
    const double step = time_s / 2.0, level = std::floor(step), share = std::min(1.0, 4.0 * (step - level));
    const auto at = [](double i) { return 0.2 * (i <= 10.0 ? std::max(i, 0.0) : 20.0 - std::min(i, 20.0)); };
    return (1.0 - share) * at(level - 1.0) + share * at(level);
  };
  record(42.0, knob, [](double) { return Vector3d::Zero(); });
  const nlohmann::json json = identified({"m.csv", "--tendon", "h.csv", "--plot", "map.svg"});
  EXPECT_EQ(json["samples"].size(), 21u);
  Handle up, down;
  up.k1(0.0);
  down.k1(2.0);
  for (const auto& sample : json["samples"]) {
    const double position = sample["position"], k1 = sample["precurvature_per_m"][0];
    const double truth = sample["direction"] == "pull" ? up.k1(position) : down.k1(position);
    EXPECT_NEAR(k1, truth, 0.5) << position;
  }
  EXPECT_NEAR(json["dead_zone"].get<double>(), 2.0 * kThreshold_rad, 0.06);
}

TEST_F(IdentifyPrecurvature, EstimateSaysWhatItMakesOfTheHandle) {
  write_loop();
  identified({"--map", "loop.csv"});
  record(
      2.0, [](double time_s) { return 1.5 + time_s; }, [](double) { return Vector3d::Zero(); });
  const Arguments estimate{"estimate", "--catheter", "new.toml", "m.csv", "--out", "e.csv"};
  Arguments with = estimate;
  with.insert(with.end(), {"--tendon", "h.csv"});
  EXPECT_THAT(palpate(with).err, HasSubstr("h.csv: in 29 frames the handle is beyond the ends of [tendon_map]"));
  EXPECT_THAT(palpate(estimate).err, HasSubstr("tendon_map: the catheter file has one, but no --tendon was given"));
  std::string csv = contents(path("h.csv"));
  csv.replace(csv.find(",,,,,"), 5, ",1e-3,0,0,,");
  write("h.csv", csv);
  EXPECT_THAT(palpate(with).err, HasSubstr("h.csv: its moments are left out"));
  write("h.csv", "time_s,tension_N\n0,1\n");
  EXPECT_THAT(refusal(with), HasSubstr("knob_rad"));
}

TEST_F(IdentifyPrecurvature, RefusesWhatCannotBe) {
  write_points(31.5, 1.0);
  EXPECT_THAT(refusal(arguments({"points.csv"})),
              HasSubstr("points.csv: points: 0.06971 mm along their chords, 70 mm along the shaft"));
  EXPECT_THAT(refusal(arguments({"points.csv"})), HasSubstr("(are the positions in metres?)"));
  write_points(31.5, 1e3, 1);
  EXPECT_THAT(refusal(arguments({"points.csv"})), HasSubstr("expected more points or sensors"));
  write_points(31.5, 1e3, 9);
  EXPECT_THAT(refusal(arguments({"points.csv"})),
              HasSubstr("points.csv:10: field arc_length_mm: value '80': expected mm from the clamp, 0..70"));
  write_points(31.5);
  EXPECT_THAT(refusal(arguments({"points.csv", "--interval", "0:1"})), HasSubstr("expected with a recording"));
  EXPECT_THAT(refusal(arguments({})), HasSubstr("expected points of the shaft, a recording, or --map"));
  EXPECT_THAT(refusal(arguments({"points.csv", "--sigma-mm", "-1"})), HasSubstr("--sigma-mm -1: expected mm"));
  write("loop.csv", "knob_rad,k1_per_m\n0,1\n1,2\n2,oops\n");
  EXPECT_THAT(refusal(arguments({"--map", "loop.csv"})), HasSubstr("loop.csv:4: field k1_per_m: value 'oops'"));
  write("loop.csv", "angle,k1_per_m\n0,1\n");
  EXPECT_THAT(refusal(arguments({"--map", "loop.csv"})), HasSubstr("expected one of knob_rad, knob_deg"));
  write("loop.csv", "knob_rad,k1_per_m,direction\n0,1,pull\n1,2,push\n");
  EXPECT_THAT(refusal(arguments({"--map", "loop.csv"})), HasSubstr("expected pull or release"));
  write_catheter("length_mm = 70.0", "length_mm = 70000.0");
  EXPECT_THAT(refusal(arguments({"points.csv"})),
              HasSubstr("c.toml:4: catheter.length_mm = 70000: expected a length in mm"));
  write_catheter("#SIGMAS", "\n[tendon_map]\ninput = \"knob\"\nposition = [0.0, 1.0]\n");
  EXPECT_THAT(refusal(arguments({"points.csv"})), HasSubstr("tendon_map.input = \"knob\": expected one of"));
}

}  // namespace
}  // namespace palpate
