// SPDX-License-Identifier: Apache-2.0
#include "time_span.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <palpate/math/errors.hpp>

namespace palpate::app {

TimeSpan parse_time_span(std::string_view flag, const std::string& text) {
  const auto refuse = [&](const char* expected) {
    throw InputError(fmt::format("{} {}: expected {}", flag, text, expected));
  };
  const auto number = [&](std::string_view part) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (error != std::errc() || end != part.data() + part.size() || !std::isfinite(value))
      refuse("FROM:TO in seconds, as 0:2");
    return value;
  };
  const std::string_view whole = text;
  const std::size_t colon = whole.find(':');
  if (colon == std::string_view::npos) refuse("FROM:TO in seconds, as 0:2");
  const TimeSpan span{number(whole.substr(0, colon)), number(whole.substr(colon + 1))};
  if (!(span.to_s > span.from_s)) refuse("an end after the beginning");
  return span;
}

}  // namespace palpate::app
