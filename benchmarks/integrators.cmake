# SPDX-License-Identifier: Apache-2.0
# Work against error of several integrators: docs/theory/integrators.md. Run: integrators docs/figures
add_executable(integrators ${CMAKE_CURRENT_LIST_DIR}/integrators.cpp)
target_link_libraries(integrators PRIVATE palpate::palpate fmt::fmt nlohmann_json::nlohmann_json)
target_include_directories(integrators PRIVATE ${CMAKE_SOURCE_DIR})
target_compile_options(integrators PRIVATE ${PALPATE_WARNINGS})
target_compile_definitions(integrators PRIVATE PALPATE_SHARED_DIR="${PALPATE_SHARED_DIR}")
