# SPDX-License-Identifier: Apache-2.0
# Tests of the live process: its rooms, and `palpate serve` itself (tests/serve). Debian's OpenIGTLink is the peer.
find_package(OpenIGTLink REQUIRED)

file(GLOB palpate_live_test_sources CONFIGURE_DEPENDS link/*.cpp ndi/*.cpp http/*.cpp session/*.cpp service/*.cpp
     serve/*.cpp)
set(palpate_live_test_helpers observer/allocation_counter.cpp apps/recording_text.cpp apps/run_program.cpp)
add_executable(palpate_live_tests ${palpate_live_test_sources} ${palpate_live_test_helpers})
target_link_libraries(palpate_live_tests PRIVATE palpate_service GTest::gtest_main GTest::gmock rapidcheck fmt::fmt
                                                 nlohmann_json::nlohmann_json)
target_include_directories(palpate_live_tests PRIVATE ${CMAKE_SOURCE_DIR})
target_include_directories(palpate_live_tests SYSTEM PRIVATE ${OpenIGTLink_INCLUDE_DIRS})
target_link_libraries(palpate_live_tests PRIVATE ${OpenIGTLink_LIBRARIES})
target_compile_options(palpate_live_tests PRIVATE ${PALPATE_WARNINGS})
palpate_precompile(palpate_live_tests <fstream> <gmock/gmock.h> <gtest/gtest.h>)
target_compile_definitions(palpate_live_tests PRIVATE PALPATE_SHARED_DIR="${PALPATE_SHARED_DIR}" PALPATE_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                           PALPATE_BINARY="$<TARGET_FILE:palpate_cli>")
add_dependencies(palpate_live_tests palpate_cli)
gtest_discover_tests(palpate_live_tests DISCOVERY_MODE PRE_TEST TEST_FILTER "-Serve*:*/Serve*" PROPERTIES LABELS live)
# Clocks run in these: each has the machine for itself. PALPATE_LONG=1 in the environment is their full form.
gtest_discover_tests(palpate_live_tests DISCOVERY_MODE PRE_TEST TEST_FILTER "Serve*:*/Serve*" PROPERTIES LABELS "live;serve" RUN_SERIAL TRUE)

# What has threads, once more under the thread sanitizer: the live rooms and their tests are compiled for it, the
# estimator, which knows no threads, is linked as it is.
if(NOT CMAKE_CXX_FLAGS MATCHES "-fsanitize")
  file(GLOB palpate_live_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/palpate/link/*.cpp
       ${PROJECT_SOURCE_DIR}/palpate/ndi/*.cpp ${PROJECT_SOURCE_DIR}/palpate/http/*.cpp
       ${PROJECT_SOURCE_DIR}/palpate/store/*.cpp ${PROJECT_SOURCE_DIR}/palpate/session/*.cpp ${PROJECT_SOURCE_DIR}/palpate/service/*.cpp)
  list(FILTER palpate_live_test_sources EXCLUDE REGEX "/serve/")
  add_executable(palpate_thread_tests ${palpate_live_sources} ${palpate_live_test_sources} ${palpate_live_test_helpers})
  get_target_property(palpate_live_links palpate_live_tests LINK_LIBRARIES)
  list(REMOVE_ITEM palpate_live_links palpate_service)
  target_link_libraries(palpate_thread_tests PRIVATE palpate::identification palpate_hdf5 SQLite::SQLite3 Boost::headers
                                                     OpenSSL::SSL OpenSSL::Crypto tomlplusplus::tomlplusplus Threads::Threads ${palpate_live_links})
  target_include_directories(palpate_thread_tests PRIVATE ${CMAKE_SOURCE_DIR})
  target_include_directories(palpate_thread_tests SYSTEM PRIVATE ${OpenIGTLink_INCLUDE_DIRS})
  target_compile_definitions(palpate_thread_tests PRIVATE $<TARGET_PROPERTY:palpate_live_tests,COMPILE_DEFINITIONS>)
  target_compile_options(palpate_thread_tests PRIVATE ${PALPATE_WARNINGS} -O1 -g1 -fsanitize=thread -Wno-tsan)
  target_link_options(palpate_thread_tests PRIVATE -fsanitize=thread)
  add_test(NAME live.thread_sanitizer COMMAND palpate_thread_tests --gtest_brief=1)
  set_tests_properties(live.thread_sanitizer PROPERTIES LABELS live ENVIRONMENT "TSAN_OPTIONS=halt_on_error=1")
endif()
