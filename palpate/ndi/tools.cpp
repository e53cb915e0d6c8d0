// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <palpate/ndi/faults.hpp>
#include <palpate/ndi/tools.hpp>
#include <tuple>

namespace palpate::ndi {

namespace {

std::optional<int> small_number(std::string_view digits) {
  const bool decimal = std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; });
  if (digits.empty() || digits.size() > 2 || !decimal) return std::nullopt;
  int value = 0;
  for (const char digit : digits) value = 10 * value + (digit - '0');
  return value;
}

std::string name_of(const PortLocation& location) { return fmt::format("{}-{}", location.port, location.channel); }

bool is(const Tool& tool, const ToolName& name) {
  if (const auto* const location = std::get_if<PortLocation>(&name)) return tool.location == *location;
  return tool.handle == std::get<std::uint8_t>(name);
}

}  // namespace

std::optional<ToolName> parse_tool_name(std::string_view text) {
  if (const std::size_t dash = text.find('-'); dash != std::string_view::npos) {
    const auto port = small_number(text.substr(0, dash)), channel = small_number(text.substr(dash + 1));
    if (!port || !channel) return std::nullopt;
    return PortLocation{*port, *channel};
  }
  const auto handle = text.size() == 2 ? parse_hex(text) : std::nullopt;
  if (!handle) return std::nullopt;
  return static_cast<std::uint8_t>(*handle);
}

std::string list_of(const std::vector<Tool>& tools) {
  std::string out;
  for (const Tool& tool : tools) {
    out += (out.empty() ? "" : ", ") + hex_handle(tool.handle);
    if (tool.location) out += fmt::format(" (port {})", name_of(*tool.location));
  }
  return out.empty() ? "none" : out;
}

std::vector<std::uint8_t> choose_tools(std::vector<Tool> tools, const std::vector<ToolName>& names, std::size_t count) {
  std::vector<std::uint8_t> out;
  if (names.empty()) {
    if (tools.size() < count)
      throw LinkLost(fmt::format("{} sensors wanted; the device has {}", count, list_of(tools)));
    const auto place = [](const Tool& tool) {
      const PortLocation at = tool.location.value_or(PortLocation{});
      return std::make_tuple(!tool.location.has_value(), at.port, at.channel, tool.handle);
    };
    std::sort(tools.begin(), tools.end(), [&](const Tool& a, const Tool& b) { return place(a) < place(b); });
    for (std::size_t i = 0; i < count; ++i) out.push_back(tools[i].handle);
    return out;
  }
  for (const ToolName& name : names) {
    const auto found = std::find_if(tools.begin(), tools.end(), [&](const Tool& tool) { return is(tool, name); });
    if (found == tools.end()) {
      const auto* const location = std::get_if<PortLocation>(&name);
      throw LinkLost(fmt::format("no tool {}; the device has {}",
                                 location != nullptr ? name_of(*location) : hex_handle(std::get<std::uint8_t>(name)),
                                 list_of(tools)));
    }
    out.push_back(found->handle);
  }
  return out;
}

}  // namespace palpate::ndi
