// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/reproduction/part.hpp>
#include <span>
#include <string>

namespace palpate::app {

inline constexpr const char* kPageName = "paper.md";

/// Throws InputError unless `folder` is one, or could be made in a folder that is there.
void check_folder(const std::string& folder);

/// The page and every picture, into `folder`, which is made where it is not there. All are written beside first and put
/// in place at the end; where one fails, nothing is. Throws InputError.
void write_page(const std::string& folder, const std::string& page, std::span<const reproduction::Part> parts);

}  // namespace palpate::app
