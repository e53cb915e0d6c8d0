// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <web/assets.hpp>

#ifdef PALPATE_WEB
// From the object that cmake/web_assets.s.in makes.
extern "C" const char palpate_report_script[], palpate_report_script_end[];
extern "C" const char palpate_report_style[], palpate_report_style_end[];
#endif

namespace palpate::web {

PageAssets report_page() {
#ifdef PALPATE_WEB
  return {{palpate_report_script, static_cast<std::size_t>(palpate_report_script_end - palpate_report_script)},
          {palpate_report_style, static_cast<std::size_t>(palpate_report_style_end - palpate_report_style)}};
#else
  return {};
#endif
}

}  // namespace palpate::web
