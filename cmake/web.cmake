# SPDX-License-Identifier: Apache-2.0
# The pages under web/, bundled into one script and one style sheet and put into the program.
# palpate_web: a static library with the bytes; PALPATE_WEB OFF leaves it empty, and `palpate report` says so, and
# `palpate serve` has no page.
option(PALPATE_WEB "Bundle the pages under web/ into palpate (needs node and npm)" ON)

add_library(palpate_web STATIC web/assets.cpp)
target_include_directories(palpate_web PUBLIC ${CMAKE_CURRENT_SOURCE_DIR})
target_compile_options(palpate_web PRIVATE ${PALPATE_WARNINGS})
if(NOT PALPATE_WEB)
  return()
endif()

find_program(PALPATE_NODE node)
find_program(PALPATE_NPM npm)
if(NOT PALPATE_NODE OR NOT PALPATE_NPM)
  message(FATAL_ERROR "node and npm are needed for the pages of palpate report and serve: install nodejs and npm "
                      "(tools/install_packages.sh), or leave the pages out with -DPALPATE_WEB=OFF")
endif()

set(PALPATE_WEB_DIR ${CMAKE_CURRENT_BINARY_DIR}/web)
set(web_source ${CMAKE_CURRENT_SOURCE_DIR}/web)
add_custom_command(
  OUTPUT ${PALPATE_WEB_DIR}/packages.stamp
  COMMAND ${CMAKE_COMMAND} -E make_directory ${PALPATE_WEB_DIR}
  COMMAND ${CMAKE_COMMAND} -E copy ${web_source}/package.json ${web_source}/package-lock.json ${PALPATE_WEB_DIR}
  COMMAND ${CMAKE_COMMAND} -E chdir ${PALPATE_WEB_DIR} ${PALPATE_NPM} ci --ignore-scripts --no-audit --no-fund --prefer-offline --loglevel=error
  COMMAND ${CMAKE_COMMAND} -E touch ${PALPATE_WEB_DIR}/packages.stamp
  DEPENDS ${web_source}/package.json ${web_source}/package-lock.json
  COMMENT "Fetching the packages of the pages" VERBATIM)

file(GLOB web_modules CONFIGURE_DEPENDS ${web_source}/*.js ${web_source}/*.css ${web_source}/*.html ${web_source}/modules/*.js)
add_custom_command(
  OUTPUT ${PALPATE_WEB_DIR}/bundle.stamp
  BYPRODUCTS ${PALPATE_WEB_DIR}/report.js ${PALPATE_WEB_DIR}/report.css ${PALPATE_WEB_DIR}/dashboard.js
             ${PALPATE_WEB_DIR}/dashboard.css ${PALPATE_WEB_DIR}/dashboard.html
  COMMAND ${PALPATE_NODE} ${web_source}/build.mjs ${PALPATE_WEB_DIR}
  DEPENDS ${PALPATE_WEB_DIR}/packages.stamp ${web_source}/build.mjs ${web_modules}
  COMMENT "Bundling the pages" VERBATIM)

enable_language(ASM)
configure_file(cmake/web_assets.s.in ${PALPATE_WEB_DIR}/assets.s @ONLY)
set_source_files_properties(${PALPATE_WEB_DIR}/assets.s PROPERTIES OBJECT_DEPENDS ${PALPATE_WEB_DIR}/bundle.stamp)
target_sources(palpate_web PRIVATE ${PALPATE_WEB_DIR}/assets.s)
target_compile_definitions(palpate_web PRIVATE PALPATE_WEB)
