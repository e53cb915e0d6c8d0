// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace palpate::app {

/// `text` as it may stand in HTML, in an attribute as well.
std::string html_escaped(const std::string& text);

/// JSON as it may stand in a <script> element: no character in it can end the element or begin a comment. Text that is
/// no UTF-8 is made so.
std::string script_safe(const nlohmann::json& data);

/// The whole page: title, data, style and script in one file, which may load nothing from anywhere. Throws InputError
/// where the program was built without pages.
std::string report_page(const std::string& title, const nlohmann::json& data);

}  // namespace palpate::app
