// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <palpate/link/codec.hpp>
#include <palpate/math/units.hpp>
#include <random>
#include <tests/serve/serve_fixture.hpp>

/// Poses that are wrong: refused and counted, never felt (FAULTS 3, 4, 5, 8, 18).
namespace palpate::serve_test {
namespace {

constexpr double kRate_hz = 250.0;

/// Shifts and turns what a sensor says.
void disturb(link::Matrix& matrix, const Vector3d& shift_mm, const Eigen::AngleAxisd& turn) {
  Eigen::Map<Eigen::Matrix<float, 3, 4>> columns(matrix.columns.data());
  columns.leftCols<3>() = (columns.leftCols<3>().cast<double>() * turn.toRotationMatrix()).cast<float>();
  columns.col(3) += shift_mm.cast<float>();
}

Vector3d random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Vector3d(normal(random), normal(random), normal(random)).normalized();
}

class ServePoses : public Serve {
 protected:
  /// All frames, played; the forces that came.
  std::vector<SlicerClient::Force> play(const WireFrames& frames) {
    const auto screen = slicer(*program_);
    const auto sent = plus_.play(frames, kRate_hz);
    EXPECT_TRUE(screen->wait_for(frames.size(), 10.0)) << program_->health().dump();
    return screen->forces();
  }
  static std::vector<Vector3d> vectors(const std::vector<Estimate>& estimates) {
    std::vector<Vector3d> out;
    out.reserve(estimates.size());
    for (const Estimate& each : estimates) out.push_back(each.force_tip_N);
    return out;
  }
  std::unique_ptr<ServeProcess> program_;
};

/// What is refused is as if it had not been there: the forces after it are those of a tracker that saw nothing.
TEST_F(ServePoses, NoRotationNoNumberNoFault) {
  program_ = serve();
  WireFrames frames = moved_to(virtual_wire(catheter_.catheter, kRate_hz, 0.4).frames, utc_s()), spared = frames;
  const auto spoil = [&](std::size_t i, const auto& change) {
    for (auto& [device, matrix] : frames[i].poses) change(matrix.columns);
    spared[i].poses.clear();
  };
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  spoil(40, [&](auto& m) { m[9] = nan; });
  spoil(41, [&](auto& m) { m[4] = nan; });
  spoil(45, [&](auto& m) { m[11] = inf; });
  spoil(50, [&](auto& m) {  // a scale is no rotation
    for (std::size_t k = 0; k < 9; ++k) m[k] *= 1.1F;
  });
  spoil(51, [&](auto& m) {
    for (int i = 0; i < 3; ++i) m[static_cast<std::size_t>(i)] *= -1.0F;
  });  // nor a mirror
  spoil(52, [&](auto& m) { m.fill(0.0F); });
  spoil(60, [&](auto& m) { m = link::Matrix{}.columns; });
  const auto came = play(frames);
  ASSERT_EQ(came.size(), frames.size());
  const auto expected = offline(catheter_, spared);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(came[i].live(), !spared[i].poses.empty()) << i;
    if (came[i].live()) {
      EXPECT_EQ(came[i].values[0], expected[i].force_tip_N.x()) << i;
    }
    EXPECT_EQ(came[i].values[3], std::sqrt(expected[i].covariance_tip_N2(0, 0))) << i;
  }
  // Had they not come at all, one long step would stand for two: the process noise found is a little another.
  std::erase_if(spared, [](const WireFrame& frame) { return frame.poses.empty(); });
  EXPECT_NEAR(came.back().values[0], offline(catheter_, spared).back().force_tip_N.x(), 1e-6);
  for (const char* const name : {"Tip", "Shaft"}) {
    auto sensor = program_->catheter()["sensors"][name];
    std::uint64_t refused = 0;
    for (const auto& [reason, count] : sensor.items())
      if (reason != "usable") refused += count.get<std::uint64_t>();
    EXPECT_EQ(refused, 7U) << sensor.dump();
    EXPECT_EQ(sensor["not finite"], 2) << sensor.dump();       // positions
    EXPECT_EQ(sensor["zero quaternion"], 4) << sensor.dump();  // what is no rotation has none
    EXPECT_EQ(sensor["identity pose"], 1) << sensor.dump();
    EXPECT_EQ(sensor["usable"], frames.size() - 7);
  }
}

TEST_F(ServePoses, ZeroQuaternion) {
  program_ = serve();
  const auto screen = slicer(*program_);
  const WireFrames frames = moved_to(virtual_wire(catheter_.catheter, kRate_hz, 0.2).frames, utc_s());
  plus_.play(frames, kRate_hz, 0, 30);
  std::vector<std::byte> bytes;
  const link::QuaternionTrackingData::Tool tip{"Tip", 2, {1, 2, 3}, {0, 0, 0, 0}},
      shaft{"Shaft", 2, {1, 2, 3}, {0, 0, 0, 0}};
  link::encode({.device = "Tracker", .time_s = frames[30].time_s, .body = link::QuaternionTrackingData{{tip, shaft}}},
               bytes);
  ASSERT_TRUE(plus_.send_raw(bytes));
  plus_.play(frames, kRate_hz, 31, 50);
  ASSERT_TRUE(screen->wait_for(50, 5.0));
  WireFrames spared = frames;
  spared[30].poses.clear();
  EXPECT_FALSE(screen->forces()[30].live());
  EXPECT_EQ(screen->forces()[49].values[0], offline(catheter_, spared)[49].force_tip_N.x());
  EXPECT_EQ(program_->catheter()["sensors"]["Tip"]["zero quaternion"], 1);
}

TEST_F(ServePoses, OneReadingInTenIsAnOutlier) {
  program_ = serve();
  VirtualWire clean = virtual_wire(catheter_.catheter, kRate_hz, 2.0);
  clean.frames = moved_to(clean.frames, utc_s());
  WireFrames frames = clean.frames;
  std::mt19937 random(5);
  for (WireFrame& frame : frames)
    for (auto& [device, matrix] : frame.poses)
      if (random() % 10 == 0)
        disturb(matrix, 10.0 * random_direction(random), {30.0 * kRadiansPerDegree, random_direction(random)});
  const auto came = play(frames);
  const auto expected = offline(catheter_, frames);
  ASSERT_EQ(came.size(), expected.size());
  std::vector<Vector3d> shown, truth;
  for (std::size_t i = 250; i < came.size(); ++i) {
    for (std::size_t axis = 3; axis < 6; ++axis) EXPECT_GT(came[i].values[axis], 0.0);
    if (!came[i].live()) continue;
    shown.emplace_back(came[i].values[0], came[i].values[1], came[i].values[2]);
    truth.push_back(clean.force_tip_N[i]);
  }
  const double clean_N = rmse_N(vectors(offline(catheter_, clean.frames)), clean.force_tip_N, 250);
  RecordProperty("rmse_over_clean", std::to_string(rmse_N(shown, truth) / clean_N));
  EXPECT_GT(shown.size(), 9 * (came.size() - 250) / 10);
  EXPECT_LE(rmse_N(shown, truth), 1.5 * clean_N);
  EXPECT_LE(rmse_N(vectors(expected), clean.force_tip_N, 250), 1.5 * clean_N) << "frames that show no force included";
}

class ServeStepBias : public ServePoses {
 protected:
  void step(const std::function<void(WireFrame&)>& change) {
    program_ = serve();
    const auto screen = slicer(*program_);
    WireFrames frames = moved_to(virtual_wire(catheter_.catheter, 100.0, 1.0).frames, utc_s());
    for (std::size_t i = 90; i < 100; ++i) change(frames[i]);
    plus_.play(frames, 100.0, 0, 90);
    ASSERT_TRUE(screen->wait_for(90, 5.0));
    EXPECT_EQ(program_->catheter()["inconsistent"], 0) << program_->catheter().dump();
    plus_.play(frames, 100.0, 90, 100);
    ASSERT_TRUE(screen->wait_for(100, 5.0));
    auto catheter = program_->catheter();
    EXPECT_EQ(catheter["inconsistent"], 1) << catheter.dump();
    // A machine that is busy may have called it stale by now, and said so.
    EXPECT_TRUE(catheter["state"] == "DEGRADED" || catheter["stale"] != 0) << catheter.dump();
  }
};

TEST_F(ServeStepBias, OfOneSensor) {
  step([](WireFrame& frame) { disturb(frame.of(kShaft), {6.0, 0.0, 0.0}, Eigen::AngleAxisd::Identity()); });
}

TEST_F(ServeStepBias, OfTheField) {
  step([](WireFrame& frame) {
    for (auto& [device, matrix] : frame.poses)
      disturb(matrix, {0.0, 4.0, 0.0}, {3.0 * kRadiansPerDegree, Vector3d::UnitX()});
  });
}

/// The statistics offline, over the frames that are left; live for one of them, to the last bit.
TEST_F(ServePoses, LossKeepsItsInterval) {
  const VirtualWire all = virtual_wire(catheter_.catheter, kRate_hz, 20.0);
  for (const unsigned lost_percent : {0U, 5U, 20U, 50U}) {
    std::mt19937 random(lost_percent + 1);
    WireFrames frames;
    std::vector<Vector3d> truth;
    for (std::size_t i = 0; i < all.frames.size(); ++i)
      if (random() % 100 >= lost_percent) frames.push_back(all.frames[i]), truth.push_back(all.force_tip_N[i]);
    const auto estimates = offline(catheter_, frames);
    std::size_t inside = 0, counted = 0;
    for (std::size_t i = 100; i < estimates.size(); ++i)
      for (int axis = 0; axis < 3; ++axis) {
        const double sigma_N = std::sqrt(estimates[i].covariance_tip_N2(axis, axis));
        inside += std::abs(estimates[i].force_tip_N(axis) - truth[i](axis)) <= 3.0 * sigma_N ? 1U : 0U;
        ++counted;
      }
    const double share = static_cast<double>(inside) / static_cast<double>(counted);
    RecordProperty("inside_3_sigma_at_" + std::to_string(lost_percent), std::to_string(share));
    EXPECT_GE(share, 0.99) << lost_percent << " % lost";
  }
}

TEST_F(ServePoses, LossAndJitterLive) {
  program_ = serve();
  const auto screen = slicer(*program_);
  std::mt19937 random(3);
  WireFrames frames;
  for (const WireFrame& frame : moved_to(virtual_wire(catheter_.catheter, kRate_hz, 2.0).frames, utc_s()))
    if (random() % 5 != 0) frames.push_back(frame);
  std::vector<Clock::time_point> sent;
  for (const WireFrame& frame : frames) {
    sleep_s(1e-6 * static_cast<double>(random() % 9000));
    sent.push_back(Clock::now());
    ASSERT_TRUE(plus_.send(frame));
  }
  ASSERT_TRUE(screen->wait_for(frames.size(), 5.0));
  const auto came = screen->forces();
  expect_equal_forces(came, offline(catheter_, frames), frames, sent);
}

TEST_F(ServePoses, AStraightShaftFeelsLittleAlongItself) {
  write("c.toml", catheter_text(true));
  program_ = serve();
  const WireFrames frames = moved_to(
      virtual_wire(catheter_file(true).catheter, 100.0, 0.5, [](double) { return Vector3d(0.0, 0.0, -0.02); }).frames,
      utc_s());
  plus_.play(frames, 100.0);
  auto health = health_when(
      *program_, [](const auto& h) { return h["catheters"][0]["frames"] == 50; }, 5.0);
  auto catheter = health["catheters"][0];
  EXPECT_NE(catheter["words"].dump().find("axial"), std::string::npos) << catheter.dump(1);
  EXPECT_GT(catheter["sigma_N"][2].get<double>(), 5.0 * catheter["sigma_N"][0].get<double>());
  EXPECT_GT(catheter["sigma_N"][2].get<double>(), 0.01);
}

}  // namespace
}  // namespace palpate::serve_test
