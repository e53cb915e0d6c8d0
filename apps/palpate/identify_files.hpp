// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/recording/catheter_file.hpp>
#include <palpate/recording/toml_edit.hpp>
#include <string>
#include <vector>

namespace palpate::app {

/// Where a sensor of the catheter stands in its file: the index-th [[sensor]], or [base] for a base sensor described
/// there.
struct SensorPlace {
  std::string_view table = "sensor";
  std::size_t index = 0;
};
SensorPlace place_of(const TomlEdit& edit, const Sensor& sensor);

/// All sensors of the catheter, a tracked base's last.
std::vector<const Sensor*> all_sensors(const Catheter& catheter);

}  // namespace palpate::app
