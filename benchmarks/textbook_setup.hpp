// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <benchmarks/textbook.hpp>
#include <palpate/sensing/shape_model.hpp>

/// The yardstick on a Catheter: what it takes from palpate's own types.
namespace palpate::textbook {

/// One section, sensors mounted without offset, the tip's first: what the yardstick can do.
inline Shaft shaft_of(const Catheter& catheter) {
  const Section& section = catheter.rod.sections.front();
  return {catheter.rod.length_m(), catheter.sensors[1].arc_length_m, section.stiffness_Nm2, section.precurvature_per_m};
}

inline SensorPoses poses_of(const Measurement& measurement) {
  return {measurement.poses[0].T_base_sensor, measurement.poses[1].T_base_sensor};
}

/// R^-1 of the sensors' noise as it is, correlations included: the yardstick's R is not the paper's guess but right.
template <int Rows>
Eigen::Matrix<double, Rows, Rows> noise_information(ShapeModel& model) {
  ResidualMatrix noise;
  model.noise(noise);
  return noise.llt().solve(ResidualMatrix::Identity(Rows, Rows).eval());
}

}  // namespace palpate::textbook
