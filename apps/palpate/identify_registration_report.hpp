// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/identification/registration.hpp>
#include <palpate/recording/toml_edit.hpp>
#include <span>
#include <string>

/// What `palpate identify registration` hands on: the catheter file, the summary, the picture.
namespace palpate::app {

/// The catheter file with the base found, or the mounting of the base sensor, and the mountings of the others where
/// they were asked for, and how well they are known.
void put_registration(const Registration& found, bool mounting, TomlEdit& edit);

void print_registration(const Registration& found, bool mounting, const std::string& out);
void print_registration_json(const Registration& found, bool mounting, const std::string& out);

/// Fitted shafts with the sensors as measured, seen from the side; residuals, sensor by sensor.
void plot_registration(const Registration& found, std::span<const KnobPosition> measured, const std::string& file);

}  // namespace palpate::app
