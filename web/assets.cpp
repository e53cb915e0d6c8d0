// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <web/assets.hpp>

#ifdef PALPATE_WEB
// From the object that cmake/web_assets.s.in makes.
extern "C" const char palpate_report_script[], palpate_report_script_end[];
extern "C" const char palpate_report_style[], palpate_report_style_end[];
extern "C" const char palpate_dashboard_html[], palpate_dashboard_html_end[];
extern "C" const char palpate_dashboard_script[], palpate_dashboard_script_end[];
extern "C" const char palpate_dashboard_style[], palpate_dashboard_style_end[];
#endif

namespace palpate::web {

#ifdef PALPATE_WEB

namespace {

std::string_view between(const char* begin, const char* end) { return {begin, static_cast<std::size_t>(end - begin)}; }

}  // namespace

PageAssets report_page() {
  return {between(palpate_report_script, palpate_report_script_end),
          between(palpate_report_style, palpate_report_style_end)};
}

DashboardAssets dashboard_page() {
  return {between(palpate_dashboard_html, palpate_dashboard_html_end),
          between(palpate_dashboard_script, palpate_dashboard_script_end),
          between(palpate_dashboard_style, palpate_dashboard_style_end)};
}

#else

PageAssets report_page() { return {}; }
DashboardAssets dashboard_page() { return {}; }

#endif

}  // namespace palpate::web
