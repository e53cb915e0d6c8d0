# SPDX-License-Identifier: Apache-2.0
set(PALPATE_WARNINGS -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion)
if(PALPATE_WERROR)
  list(APPEND PALPATE_WARNINGS -Werror)
endif()
