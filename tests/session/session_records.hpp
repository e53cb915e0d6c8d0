// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <limits>
#include <palpate/session/reader.hpp>
#include <palpate/session/writer.hpp>
#include <random>

namespace palpate::test {

/// Records of which every field that is kept has a value of its own; some numbers are NaN, infinite, zero or -0.
class RandomRecords {
 public:
  explicit RandomRecords(unsigned seed, int catheters = 1, std::size_t sensors = 2)
      : random_(seed), catheters_(catheters), sensors_(sensors) {}

  session::LiveRecord frame() {
    session::LiveRecord record;
    stamp(record);
    record.frame.number = number_++;
    record.frame.time_s = odd();
    fill_readings(record.frame);
    fill_loads(record.frame);
    fill(record.estimate);
    return record;
  }
  session::LiveRecord event(const std::string& name) {
    session::LiveRecord record;
    stamp(record);
    record.kind = session::LiveRecord::Kind::kEvent;
    record.catheter -= chance(2) ? 1 : 0;  // -1: of all
    record.event = name;
    record.data = R"({"value":)" + std::to_string(number_) + ",\"text\":\"Größe 'x'\"}";
    return record;
  }
  bool chance(int one_in) { return std::uniform_int_distribution<int>(1, one_in)(random_) == 1; }

 private:
  void stamp(session::LiveRecord& record) {
    record.catheter = catheters_ == 1 ? 0 : std::uniform_int_distribution<int>(0, catheters_ - 1)(random_);
    record.received_ns = 1'700'000'000'000'000'000 + 1'000'003 * ++stamps_;
    record.output_time_s = 1.7e9 + 1e-3 * static_cast<double>(stamps_);
  }
  double plain() { return std::normal_distribution<double>(0.0, 1.0)(random_); }
  double odd() {
    switch (std::uniform_int_distribution<int>(0, 40)(random_)) {
      case 0:
        return std::numeric_limits<double>::quiet_NaN();
      case 1:
        return std::numeric_limits<double>::infinity();
      case 2:
        return -0.0;
      case 3:
        return 0.0;
      case 4:
        return 5e-324;
      case 5:
        return -17.0;
      default:
        return plain();
    }
  }
  template <typename Numbers>
  void fill_odd(Numbers& numbers) {
    for (auto& value : numbers) value = odd();
  }
  void fill_symmetric(Matrix3d& m) {
    for (int i = 0; i < 3; ++i)
      for (int k = i; k < 3; ++k) m(i, k) = m(k, i) = odd();
  }
  void fill_readings(TrackerFrame& frame) {
    frame.readings.resize(sensors_);
    for (SensorReading& reading : frame.readings) {
      if (chance(10)) {
        reading.status = SensorReading::Status::kAbsent;
        continue;
      }
      reading.status = chance(8) ? SensorReading::Status::kMissing : SensorReading::Status::kOk;
      reading.has_orientation = !chance(5);
      if (reading.status == SensorReading::Status::kMissing) continue;
      fill_odd(reading.quaternion_wxyz);
      fill_odd(reading.position_m);
      if (!chance(3)) reading.error_m = odd();
    }
  }
  void fill_loads(TrackerFrame& frame) {
    if (chance(2)) frame.tendon = {.present = true, .moment_Nm = {odd(), odd()}, .sigma_Nm = odd()};
    if (chance(2))
      frame.bend = {.present = true, .inside = chance(2), .change_per_m = {odd(), odd()}, .sigma_per_m = {odd(), 1.0}};
    if (chance(3))
      frame.known_load = {.present = true, .in_base = chance(2), .force_N = {odd(), odd(), odd()}, .sigma_N = odd()};
  }
  void fill(Estimate& e) {
    const auto integer = [&](int most) { return std::uniform_int_distribution<int>(0, most)(random_); };
    e.time_s = odd();
    e.status = static_cast<EstimateStatus>(integer(6));
    e.time = static_cast<FrameTime>(integer(5));
    fill_odd(e.force_tip_N);
    fill_symmetric(e.covariance_tip_N2);
    for (auto& source : e.sigma_by_source_N) fill_odd(source);
    for (Vector3d* v :
         {&e.shaft.stiffness_Nm2, &e.shaft.stiffness_sigma_Nm2, &e.shaft.precurvature_per_m,
          &e.shaft.precurvature_sigma_per_m, &e.observability.weakest_force_N, &e.observability.weakest_log_stiffness,
          &e.observability.weakest_precurvature_per_m, &e.force_base_N})
      fill_odd(*v);
    for (double* v : {&e.observability.weakest_sigmas, &e.observability.stiffness_scale_sigma,
                      &e.observability.stiffness_scale_prior_sigma, &e.nis})
      *v = odd();
    for (bool* flag :
         {&e.observability.axial_force_hidden, &e.observability.shaft_straight, &e.observability.lateral_force_hidden,
          &e.observability.stiffness_rests_on_prior, &e.observability.precurvature_rests_on_prior, &e.jumped})
      *flag = chance(2);
    for (int i = 0; i < 9; ++i) e.R_base_tip(i / 3, i % 3) = odd();
    e.used = static_cast<unsigned>(integer(255));
    e.sensors_used = integer(8);
    e.dof = integer(54);
    e.evaluations = integer(1400);
    for (Rejection& reason : e.rejections) reason = static_cast<Rejection>(integer(8));
    if (!chance(4)) return;  // what is there only where it was asked for
    e.convergence = {odd(), odd()};
    fill_odd(e.forecast.mean_N);
    fill_symmetric(e.forecast.covariance_N2);
    e.lagged.age_frames = integer(100);
    e.lagged.time_s = odd();
    fill_odd(e.lagged.force.mean_N);
    fill_symmetric(e.lagged.force.covariance_N2);
  }

  std::mt19937_64 random_;
  int catheters_;
  std::size_t sensors_;
  std::int64_t number_ = 0, stamps_ = 0;
};

/// The same bits; a NaN is any NaN.
inline ::testing::AssertionResult same_bits(const double* a, const double* b, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i)
    if (std::bit_cast<std::uint64_t>(a[i]) != std::bit_cast<std::uint64_t>(b[i]) && !(a[i] != a[i] && b[i] != b[i]))
      return ::testing::AssertionFailure() << "number " << i << ": " << a[i] << " is not " << b[i];
  return ::testing::AssertionSuccess();
}

inline void expect_same(const SensorReading& a, const SensorReading& b) {
  ASSERT_EQ(a.status, b.status);
  if (a.status == SensorReading::Status::kAbsent) return;
  EXPECT_EQ(a.has_orientation, b.has_orientation);
  EXPECT_TRUE(same_bits(a.quaternion_wxyz.data(), b.quaternion_wxyz.data(), 4));
  EXPECT_TRUE(same_bits(a.position_m.data(), b.position_m.data(), 3));
  EXPECT_TRUE(same_bits(&a.error_m, &b.error_m, 1));
}

inline void expect_same(const TrackerFrame& a, const TrackerFrame& b) {
  EXPECT_EQ(a.number, b.number);
  EXPECT_TRUE(same_bits(&a.time_s, &b.time_s, 1));
  ASSERT_EQ(a.readings.size(), b.readings.size());
  for (std::size_t i = 0; i < a.readings.size(); ++i) expect_same(a.readings[i], b.readings[i]);
  EXPECT_EQ(a.tendon.present, b.tendon.present);
  EXPECT_TRUE(same_bits(a.tendon.moment_Nm.data(), b.tendon.moment_Nm.data(), 2));
  EXPECT_TRUE(same_bits(&a.tendon.sigma_Nm, &b.tendon.sigma_Nm, 1));
  EXPECT_EQ(a.bend.present, b.bend.present);
  EXPECT_EQ(a.bend.inside, b.bend.inside);
  EXPECT_TRUE(same_bits(a.bend.change_per_m.data(), b.bend.change_per_m.data(), 2));
  EXPECT_TRUE(same_bits(a.bend.sigma_per_m.data(), b.bend.sigma_per_m.data(), 2));
  EXPECT_EQ(a.known_load.present, b.known_load.present);
  EXPECT_EQ(a.known_load.in_base, b.known_load.in_base);
  EXPECT_TRUE(same_bits(a.known_load.force_N.data(), b.known_load.force_N.data(), 3));
  EXPECT_TRUE(same_bits(&a.known_load.sigma_N, &b.known_load.sigma_N, 1));
}

inline void expect_same(const Observability& a, const Observability& b) {
  EXPECT_TRUE(same_bits(a.weakest_force_N.data(), b.weakest_force_N.data(), 3));
  EXPECT_TRUE(same_bits(a.weakest_log_stiffness.data(), b.weakest_log_stiffness.data(), 3));
  EXPECT_TRUE(same_bits(a.weakest_precurvature_per_m.data(), b.weakest_precurvature_per_m.data(), 3));
  EXPECT_TRUE(same_bits(&a.weakest_sigmas, &b.weakest_sigmas, 1));
  EXPECT_TRUE(same_bits(&a.stiffness_scale_sigma, &b.stiffness_scale_sigma, 1));
  EXPECT_TRUE(same_bits(&a.stiffness_scale_prior_sigma, &b.stiffness_scale_prior_sigma, 1));
  EXPECT_EQ(a.axial_force_hidden, b.axial_force_hidden);
  EXPECT_EQ(a.shaft_straight, b.shaft_straight);
  EXPECT_EQ(a.lateral_force_hidden, b.lateral_force_hidden);
  EXPECT_EQ(a.stiffness_rests_on_prior, b.stiffness_rests_on_prior);
  EXPECT_EQ(a.precurvature_rests_on_prior, b.precurvature_rests_on_prior);
}

inline void expect_same(const ForceGaussian& a, const ForceGaussian& b) {
  EXPECT_TRUE(same_bits(a.mean_N.data(), b.mean_N.data(), 3));
  EXPECT_TRUE(same_bits(a.covariance_N2.data(), b.covariance_N2.data(), 9));
}

inline void expect_same(const Estimate& a, const Estimate& b) {
  EXPECT_TRUE(same_bits(&a.time_s, &b.time_s, 1));
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.time, b.time);
  EXPECT_TRUE(same_bits(a.force_tip_N.data(), b.force_tip_N.data(), 3));
  EXPECT_TRUE(same_bits(a.covariance_tip_N2.data(), b.covariance_tip_N2.data(), 9));
  for (std::size_t i = 0; i < kUncertaintySources; ++i)
    EXPECT_TRUE(same_bits(a.sigma_by_source_N[i].data(), b.sigma_by_source_N[i].data(), 3)) << i;
  EXPECT_TRUE(same_bits(a.shaft.stiffness_Nm2.data(), b.shaft.stiffness_Nm2.data(), 3));
  EXPECT_TRUE(same_bits(a.shaft.stiffness_sigma_Nm2.data(), b.shaft.stiffness_sigma_Nm2.data(), 3));
  EXPECT_TRUE(same_bits(a.shaft.precurvature_per_m.data(), b.shaft.precurvature_per_m.data(), 3));
  EXPECT_TRUE(same_bits(a.shaft.precurvature_sigma_per_m.data(), b.shaft.precurvature_sigma_per_m.data(), 3));
  expect_same(a.observability, b.observability);
  EXPECT_TRUE(same_bits(a.force_base_N.data(), b.force_base_N.data(), 3));
  EXPECT_TRUE(same_bits(a.R_base_tip.data(), b.R_base_tip.data(), 9));
  EXPECT_EQ(a.used, b.used);
  EXPECT_EQ(a.sensors_used, b.sensors_used);
  EXPECT_TRUE(same_bits(&a.nis, &b.nis, 1));
  EXPECT_EQ(a.dof, b.dof);
  EXPECT_EQ(a.jumped, b.jumped);
  EXPECT_EQ(a.evaluations, b.evaluations);
  EXPECT_TRUE(same_bits(&a.convergence.paper, &b.convergence.paper, 1));
  EXPECT_TRUE(same_bits(&a.convergence.normalised, &b.convergence.normalised, 1));
  expect_same(a.forecast, b.forecast);
  EXPECT_EQ(a.lagged.age_frames, b.lagged.age_frames);
  EXPECT_TRUE(same_bits(&a.lagged.time_s, &b.lagged.time_s, 1));
  expect_same(a.lagged.force, b.lagged.force);
  EXPECT_EQ(a.rejections, b.rejections);
}

inline void expect_same(const session::LiveRecord& a, const session::LiveRecord& b) {
  ASSERT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.catheter, b.catheter);
  EXPECT_EQ(a.received_ns, b.received_ns);
  EXPECT_TRUE(same_bits(&a.output_time_s, &b.output_time_s, 1));
  if (a.kind == session::LiveRecord::Kind::kEvent) {
    EXPECT_EQ(a.event, b.event);
    EXPECT_EQ(a.data, b.data);
    return;
  }
  expect_same(a.frame, b.frame);
  expect_same(a.estimate, b.estimate);
}

inline std::vector<session::SessionCatheter> some_catheters(int count = 1, std::size_t sensors = 2) {
  std::vector<session::SessionCatheter> catheters;
  for (int i = 0; i < count; ++i) {
    session::SessionCatheter catheter{"catheter " + std::to_string(i), "folder/c.toml", "schema = 1\n", {}};
    for (std::size_t s = 0; s < sensors; ++s) catheter.sensor_names.push_back("sensor" + std::to_string(s));
    catheters.push_back(catheter);
  }
  return catheters;
}

inline std::vector<session::LiveRecord> read_all(session::SessionReader& reader) {
  std::vector<session::LiveRecord> records;
  session::LiveRecord record;
  while (reader.next(record)) records.push_back(record);
  return records;
}

}  // namespace palpate::test
