// SPDX-License-Identifier: Apache-2.0
#include "report_page.hpp"

#include <nlohmann/json.hpp>
#include <palpate/math/errors.hpp>
#include <web/assets.hpp>

namespace palpate::app {

namespace {

constexpr std::string_view kHead = R"(<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<link rel="icon" href="data:,">
<title>)";

std::string replaced(std::string text, std::string_view what, std::string_view by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
  return text;
}

}  // namespace

std::string html_escaped(const std::string& text) {
  std::string out;
  for (const char c : text) switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  return out;
}

std::string script_safe(const nlohmann::json& data) {
  std::string text = data.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  text = replaced(std::move(text), "<", "\\u003c");
  text = replaced(std::move(text), ">", "\\u003e");
  text = replaced(std::move(text), "\xe2\x80\xa8", "\\u2028");
  return replaced(std::move(text), "\xe2\x80\xa9", "\\u2029");
}

std::string report_page(const std::string& title, const nlohmann::json& data) {
  const web::PageAssets page = web::report_page();
  if (page.script.empty())
    throw InputError("report: this palpate was built without pages: expected CMake's PALPATE_WEB to be ON");
  std::string html(kHead);
  html += html_escaped(title) + "</title>\n<style>";
  html += page.style;
  html += "</style>\n</head>\n<body>\n<noscript>This report needs JavaScript.</noscript>\n<div id=\"report\"></div>\n";
  html += "<script type=\"application/json\" id=\"data\">" + script_safe(data) + "</script>\n<script>";
  html += page.script;
  html += "</script>\n</body>\n</html>\n";
  return html;
}

}  // namespace palpate::app
