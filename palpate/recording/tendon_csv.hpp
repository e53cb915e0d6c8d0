// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <palpate/sensing/catheter.hpp>
#include <string>
#include <vector>

namespace palpate {

/// What the tendon does to the shaft over time: its moment about d1 and d2.
struct TendonTrace {
  struct Sample {
    Eigen::Vector2d moment_Nm = Eigen::Vector2d::Zero();
    double sigma_Nm = 0.0;
    bool inside = false;  ///< false: the time lies outside the trace, the nearest sample is given
  };

  std::string source;
  std::vector<double> times_s;  ///< strictly increasing, at least one
  std::vector<Eigen::Vector2d> moment_Nm;
  std::vector<double> sigma_Nm;  ///< white noise of a sample, one standard deviation, per axis

  /// Linear between samples.
  Sample interpolate(double time_s) const;
};

/// `time_s,moment_1_Nm,moment_2_Nm,sigma_Nm[,tension_N,knob_rad]`. Where both moments are blank the moment is
/// (tension_N * tendon.offset_m, 0). sigma_Nm is the white noise of a sample; where it is blank it is
/// tendon.moment_sigma_fraction of the moment, which otherwise is the constant error of the channel's scale.
/// Throws InputError on a value that is not a finite number, a negative sigma, a time that does not increase, and a
/// blank moment without tension or offset.
TendonTrace read_tendon_csv(const std::filesystem::path& path, const Tendon& tendon = {});

}  // namespace palpate
