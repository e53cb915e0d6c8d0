// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/sensing/catheter.hpp>
#include <utility>

namespace palpate {

/// The paper's Table 2 with k1,0 = 24.57 1/m and two sensors, as the benchmarks use it.
inline Catheter paper_catheter() {
  Catheter catheter;
  catheter.name = "paper, Table 2";
  catheter.rod = uniform_rod(0.07, {0.2612e-3, 0.16664e-3, 0.1645e-3}, {24.57, 0.0, 0.0});
  for (const auto& [name, arc_length_m] : {std::pair{"tip", 0.07}, std::pair{"shaft", 0.0653}}) {
    Sensor sensor;
    sensor.name = name;
    sensor.arc_length_m = arc_length_m;
    catheter.sensors.push_back(sensor);
  }
  return catheter;
}

}  // namespace palpate
