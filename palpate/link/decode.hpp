// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <palpate/link/message.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::link {

/// A type of message that is understood, and how long its content may be.
struct Type {
  std::string_view name;
  std::size_t least_bytes, most_bytes;
  /// Reads the content. Returns what is wrong with it, empty where nothing is. What is right but richer than a bounded
  /// Body holds becomes Skipped.
  std::string (*decode)(std::span<const std::byte> content, Body& body);
};

/// Null where the type is passed over.
const Type* find_type(std::string_view name);
/// The names of all types that are understood, for CAPABILITY.
std::vector<std::string> type_names();

inline constexpr std::size_t kMostTools = 1024;         ///< of a TDATA or QTDATA
inline constexpr std::size_t kMostCapabilities = 1024;  ///< of a CAPABILITY
inline constexpr std::size_t kMostLines = 1024;         ///< of a POLYDATA that is kept
inline constexpr std::size_t kMostTextBytes = 65535;    ///< of a STRING or a STATUS

std::string decode_polydata(std::span<const std::byte> content, Body& body);

}  // namespace palpate::link
