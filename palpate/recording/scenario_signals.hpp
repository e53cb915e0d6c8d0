// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/recording/toml_table.hpp>
#include <palpate/simulation/scenario.hpp>

namespace palpate {

/// How a signal's values are spelt: their range in the file's unit, which `expectation` names, and what makes them SI.
struct SignalUnit {
  NumberRange range;
  double si_per_unit = 1.0;
};

/// A signal of a scenario file: a number, or a table
/// `{ constant, sines = [{ amplitude, frequency_hz, phase_deg }], points = [[time_s, value], ...], course }`
/// with at least one of the first three, added up. course: "linear" (default), "hold", "smooth".
/// Throws InputError on a missing key, a value out of range, and points whose times do not rise.
Signal read_signal(const TomlTable& table, std::string_view key, const SignalUnit& unit);
/// The same; `fallback` where the key is absent.
Signal read_signal(const TomlTable& table, std::string_view key, const SignalUnit& unit, const Signal& fallback);
/// Three of them in an array.
Signal3 read_signals(const TomlTable& table, std::string_view key, const SignalUnit& unit);

}  // namespace palpate
