// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

/// The pages under web/ as they were bundled when the program was built.
namespace palpate::web {

/// Script and style sheet of one page, each whole; fit to stand in <script> and <style>. Both empty where the program
/// was built without pages (CMake option PALPATE_WEB).
struct PageAssets {
  std::string_view script, style;
};

PageAssets report_page();

/// The page of `palpate serve`: served as `/`, `/dashboard.js` and `/dashboard.css`, which the first one names. All
/// empty where the program was built without pages.
struct DashboardAssets {
  std::string_view html, script, style;
};

DashboardAssets dashboard_page();

}  // namespace palpate::web
