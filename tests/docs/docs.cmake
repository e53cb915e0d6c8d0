# SPDX-License-Identifier: Apache-2.0
# The documentation: links lead somewhere, commands run and print what the page says, the site builds without a warning.
# A sanitizer build's program is the same, but slower.
if(CMAKE_CXX_FLAGS MATCHES "-fsanitize")
  return()
endif()
add_test(NAME docs.links COMMAND ${PALPATE_PYTHON3} ${PROJECT_SOURCE_DIR}/tools/check_docs.py)
add_test(NAME docs.links_self_test COMMAND ${PALPATE_PYTHON3} ${PROJECT_SOURCE_DIR}/tools/check_docs.py --self-test)
add_test(NAME docs.commands
         COMMAND ${PALPATE_PYTHON3} ${CMAKE_CURRENT_SOURCE_DIR}/docs/run_commands.py $<TARGET_FILE:palpate_cli>
                 --shared ${PALPATE_SHARED_DIR})
add_test(NAME docs.commands_self_test COMMAND ${PALPATE_PYTHON3} ${CMAKE_CURRENT_SOURCE_DIR}/docs/self_test.py)
set_tests_properties(docs.links docs.links_self_test docs.commands docs.commands_self_test PROPERTIES LABELS docs TIMEOUT 300)
add_test(NAME docs.build COMMAND ${PROJECT_SOURCE_DIR}/tools/docs.sh ${PROJECT_BINARY_DIR}/docs)
set_tests_properties(docs.build PROPERTIES LABELS docs TIMEOUT 300)
