// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace palpate::app {

/// A stretch of time as typed after `flag`: "FROM:TO" in seconds.
struct TimeSpan {
  double from_s = 0.0, to_s = 0.0;
};
/// Throws InputError naming flag and value.
TimeSpan parse_time_span(std::string_view flag, const std::string& text);

}  // namespace palpate::app
