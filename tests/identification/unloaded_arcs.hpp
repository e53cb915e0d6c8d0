// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/identification/registration.hpp>
#include <tests/random_draws.hpp>
#include <tests/sensing/virtual_setups.hpp>
#include <vector>

/// Unloaded shafts by their closed form, apart from palpate/rod: with constant (k1, k2, tau) the local frame runs along
/// a screw, R(s) = exp(s hat(u)), r(s) = s (I + (1 - cos a)/a^2 A + (a - sin a)/a^3 A^2) e3, A = s hat(u), a = |s u|.
namespace palpate::test {

inline Pose arc(const Vector3d& u_per_m, double s_m) {
  const Vector3d turn = s_m * u_per_m;
  const double a = turn.norm();
  if (a == 0.0) return {Matrix3d::Identity(), {0.0, 0.0, s_m}};
  Matrix3d A;
  A << 0.0, -turn.z(), turn.y(), turn.z(), 0.0, -turn.x(), -turn.y(), turn.x(), 0.0;
  const Matrix3d V = Matrix3d::Identity() + (1.0 - std::cos(a)) / (a * a) * A + (a - std::sin(a)) / (a * a * a) * A * A;
  return {Draws::turn(turn), s_m * V.col(2)};
}

/// A setup as it really is, in front of its sensors.
struct ArcSetup {
  Catheter catheter = {};  ///< sensors and their noise, as in the file; its base and mountings are not used
  Pose T_reference_base = {};
  std::vector<Pose> T_local_sensor = {};
  std::vector<Vector3d> bends_per_m = {};  ///< k1, k2, tau of each knob position

  Pose pose(std::size_t position, std::size_t sensor) const {
    return T_reference_base * arc(bends_per_m[position], catheter.sensors[sensor].arc_length_m) *
           T_local_sensor[sensor];
  }
};

/// Mean poses of `frames` frames with the white noise that the sensors state.
inline std::vector<KnobPosition> mean_poses_of(const ArcSetup& setup, int frames, Draws* draws) {
  std::vector<KnobPosition> positions;
  for (std::size_t j = 0; j < setup.bends_per_m.size(); ++j) {
    positions.push_back({"knob " + std::to_string(j + 1), {}});
    for (std::size_t i = 0; i < setup.catheter.sensors.size(); ++i) {
      const Sensor& sensor = setup.catheter.sensors[i];
      MeanPose mean{.T_base_sensor = setup.pose(j, i), .count = frames};
      const double share = 1.0 / std::sqrt(frames);
      if (draws != nullptr) {
        mean.T_base_sensor.p += share * sensor.noise_m.cwiseProduct(draws->normal3());
        mean.T_base_sensor.R = mean.T_base_sensor.R * draws->small_turn(share * sensor.noise_rad);
      }
      positions.back().poses.push_back(mean);
    }
  }
  return positions;
}

/// The catheter of formats/catheter.toml, its base not known: 0.28 mm and 0.17 deg of noise, two sensors.
inline Catheter unregistered() {
  Catheter catheter = two_sensors();
  catheter.base = BaseRegistration{};
  catheter.rod.sections[0].precurvature_per_m = {39.99, 0.0, 0.0};
  catheter.precurvature_sigma_per_m = {0.5, 0.5, 0.2};
  return catheter;
}

/// Bends about d1, and a little about d2, as a knob makes them; the twist stays.
inline std::vector<Vector3d> knob_bends(int positions, const Catheter& catheter, Draws& draws) {
  std::vector<Vector3d> bends;
  const double tau = catheter.precurvature_sigma_per_m.z() * draws.normal();
  for (int j = 0; j < positions; ++j)
    bends.emplace_back(55.0 * j / std::max(1, positions - 1), 0.5 * draws.normal(), tau);
  return bends;
}

/// Somewhere within 0.8 m, turned by 150 deg about any axis.
inline Pose far_away(Draws& draws) {
  return {Draws::turn(150.0 * kRadiansPerDegree * draws.normal3().normalized()), 0.8 * draws.normal3().normalized()};
}

inline ArcSetup arc_setup(const Catheter& catheter, int positions, Draws& draws) {
  ArcSetup setup{.catheter = catheter, .T_reference_base = far_away(draws)};
  for (const Sensor& sensor : catheter.sensors) setup.T_local_sensor.push_back(sensor.T_local_sensor);
  setup.bends_per_m = knob_bends(positions, catheter, draws);
  return setup;
}

}  // namespace palpate::test
