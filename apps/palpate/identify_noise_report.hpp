// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <palpate/identification/noise.hpp>
#include <palpate/identification/noise_moving.hpp>
#include <palpate/sensing/catheter.hpp>
#include <string>
#include <vector>

namespace palpate::app {

/// One sensor of the recording; either `rest` or `moving` is set.
struct SensorNoise {
  std::string name;
  const Sensor* sensor = nullptr;  ///< on the catheter; none: a stranger to it, or no catheter
  std::optional<RestNoise> rest;
  std::optional<MovingNoise> moving;

  const std::string& untold() const { return rest ? rest->untold : moving->untold; }
  /// What was found is noise: the sensor stands still, or the filter follows its motion.
  bool stands() const { return untold().empty() && (rest ? rest->rest != Rest::kMoves : moving->holds()); }
  /// Covariance of the position along tracker axes, variances of the rotation about sensor axes.
  Matrix3d position_m2() const;
  Vector3d rotation_rad2() const;
  /// One standard deviation of a sigma, relative.
  double sigma_fraction() const;
};

struct NoiseReport {
  std::string source;
  bool moving = false;
  std::vector<SensorNoise> sensors = {};
  std::string out = {};  ///< the catheter file written; empty: none

  void print() const;
  void print_json() const;
  void plot(const std::string& path) const;
};

/// What a user must know: sensors that do not stand still, repeat themselves, or state no accuracy error.
std::vector<std::string> warnings_of(const NoiseReport& report);

}  // namespace palpate::app
