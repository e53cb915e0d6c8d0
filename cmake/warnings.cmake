# SPDX-License-Identifier: Apache-2.0
set(PALPATE_WARNINGS -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  list(APPEND PALPATE_WARNINGS -Wno-restrict)  # false alarms on std::string concatenation, GCC bug 105651
endif()
if(PALPATE_WERROR)
  list(APPEND PALPATE_WARNINGS -Werror)
endif()
