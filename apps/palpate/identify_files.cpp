// SPDX-License-Identifier: Apache-2.0
#include "identify_files.hpp"

#include <algorithm>

namespace palpate::app {

SensorPlace place_of(const TomlEdit& edit, const Sensor& sensor) {
  const std::vector<std::string> names = edit.names("sensor");
  const auto found = std::find(names.begin(), names.end(), sensor.name);
  if (found == names.end()) return {.table = "base"};
  return {.index = static_cast<std::size_t>(found - names.begin())};
}

std::vector<const Sensor*> all_sensors(const Catheter& catheter) {
  std::vector<const Sensor*> sensors;
  for (const Sensor& sensor : catheter.sensors) sensors.push_back(&sensor);
  if (catheter.base.tracked) sensors.push_back(&catheter.base.sensor);
  return sensors;
}

}  // namespace palpate::app
