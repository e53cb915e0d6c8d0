# SPDX-License-Identifier: Apache-2.0
# The documentation: links lead somewhere, commands run and print what the page says, flags are those of the program and all told,
# C++ and CMake is compiled, symbols and keys are those of the code, the site builds without a warning.
# A sanitizer build's program is the same, but slower.
if(CMAKE_CXX_FLAGS MATCHES "-fsanitize")
  return()
endif()
add_test(NAME docs.links COMMAND ${PALPATE_PYTHON3} ${PROJECT_SOURCE_DIR}/tools/check_docs.py)
add_test(NAME docs.links_self_test COMMAND ${PALPATE_PYTHON3} ${PROJECT_SOURCE_DIR}/tools/check_docs.py --self-test)
add_test(NAME docs.commands
         COMMAND ${PALPATE_PYTHON3} ${CMAKE_CURRENT_SOURCE_DIR}/docs/run_commands.py $<TARGET_FILE:palpate_cli>
                 --shared ${PALPATE_SHARED_DIR} --python ${PROJECT_BINARY_DIR}/python)
add_test(NAME docs.commands_self_test COMMAND ${PALPATE_PYTHON3} ${CMAKE_CURRENT_SOURCE_DIR}/docs/self_test.py)
set(check_flags ${PALPATE_PYTHON3} ${CMAKE_CURRENT_SOURCE_DIR}/docs/check_command_line.py $<TARGET_FILE:palpate_cli>)
add_test(NAME docs.command_line COMMAND ${check_flags})
add_test(NAME docs.command_line_self_test COMMAND ${check_flags} --self-test)
set(check_notation ${PALPATE_PYTHON3} ${CMAKE_CURRENT_SOURCE_DIR}/docs/check_notation.py)
add_test(NAME docs.notation COMMAND ${check_notation})
add_test(NAME docs.notation_self_test COMMAND ${check_notation} --self-test)
set(check_keys ${PALPATE_PYTHON3} ${CMAKE_CURRENT_SOURCE_DIR}/docs/check_keys.py)
add_test(NAME docs.keys COMMAND ${check_keys})
add_test(NAME docs.keys_self_test COMMAND ${check_keys} --self-test)
foreach(check IN ITEMS links commands command_line notation keys)
  set_tests_properties(docs.${check} docs.${check}_self_test PROPERTIES LABELS docs TIMEOUT 300)
endforeach()
add_test(NAME docs.build COMMAND ${PROJECT_SOURCE_DIR}/tools/docs.sh ${PROJECT_BINARY_DIR}/docs)
set_tests_properties(docs.build PROPERTIES LABELS docs TIMEOUT 300)
