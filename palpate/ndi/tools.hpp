// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <palpate/ndi/command.hpp>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace palpate::ndi {

/// A tool as the settings name it: its port handle, two hexadecimal digits ("0A"), or where it is plugged in,
/// PORT-CHANNEL
/// ("1-0"). A handle is dealt out anew whenever tools are plugged in another order; a port stays.
using ToolName = std::variant<std::uint8_t, PortLocation>;

/// Nothing where it is neither.
std::optional<ToolName> parse_tool_name(std::string_view text);

/// A sensor that the device has initialised.
struct Tool {
  std::uint8_t handle = 0;
  std::optional<PortLocation> location;
};

/// "0A (port 1-0), 0B": for messages.
std::string list_of(const std::vector<Tool>& tools);

/// Handles of the tools by these names, in their order; without names the first `count` by port and channel, those
/// without a location behind them by handle. Throws LinkLost where one is not there: it may yet be plugged in.
std::vector<std::uint8_t> choose_tools(std::vector<Tool> tools, const std::vector<ToolName>& names, std::size_t count);

}  // namespace palpate::ndi
