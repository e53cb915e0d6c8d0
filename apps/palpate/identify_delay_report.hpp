// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/identification/delay.hpp>
#include <string>
#include <vector>

namespace palpate::app {

struct DelayReport {
  std::string tracker, sensor;   ///< the files
  bool smoothed = false;         ///< the tracker's force was felt here, without lag; false: read from a file
  double earlier_s = 0.0;        ///< delay_s of the catheter file, already taken off the tracker's times
  std::vector<TimedForce> felt;  ///< the tracker's force
  DelayFit fit;
  std::string out;  ///< the catheter file written; empty: none

  void print() const;
  void print_json() const;
  void plot(const std::string& path) const;
};

/// What a user must know: another delay that fits nearly as well, a gain far from one, the lag of an estimate.
std::vector<std::string> warnings_of(const DelayReport& report);

}  // namespace palpate::app
