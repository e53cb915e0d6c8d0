// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace palpate {

/// The known name that takes the fewest insertions, deletions and substitutions to become `text`: for "did you mean".
/// Precondition: `known` is not empty.
std::string_view nearest_name(std::string_view text, std::span<const std::string_view> known);

}  // namespace palpate
