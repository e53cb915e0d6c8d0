# SPDX-License-Identifier: Apache-2.0
# `import palpate`: the compiled module beside copies of the Python files, so that PYTHONPATH=<build>/python works.
option(PALPATE_PYTHON "Build the Python module" ON)
if(NOT PALPATE_PYTHON)
  return()
endif()

# Of several interpreters the one that Debian's packages are for, unless -D Python_EXECUTABLE says otherwise.
if(NOT DEFINED Python_EXECUTABLE AND EXISTS /usr/bin/python3)
  set(Python_EXECUTABLE /usr/bin/python3)
endif()
find_package(Python REQUIRED COMPONENTS Interpreter Development.Module NumPy)
find_package(pybind11 2.10 REQUIRED CONFIG)

file(GLOB palpate_python_sources CONFIGURE_DEPENDS python/src/*.cpp)
# What the command line makes of its input is made of it here too.
set(palpate_python_apps "")
foreach(name IN ITEMS estimate_input estimate_options estimate_warnings file_paths identify_registration_report identify_stiffness_input
                      identify_stiffness_recordings identify_stiffness_toml reference_tare time_span)
  list(APPEND palpate_python_apps apps/palpate/${name}.cpp)
endforeach()
pybind11_add_module(palpate_python MODULE NO_EXTRAS ${palpate_python_sources} ${palpate_python_apps})
set_target_properties(palpate_python PROPERTIES OUTPUT_NAME _palpate CXX_VISIBILITY_PRESET hidden
                                                LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/python/palpate)
target_compile_definitions(palpate_python PRIVATE PALPATE_VERSION="${PROJECT_VERSION}")
target_link_libraries(palpate_python PRIVATE palpate::batch palpate::identification palpate_session nlohmann_json::nlohmann_json
                                             tomlplusplus::tomlplusplus CLI11::CLI11 fmt::fmt)
target_compile_options(palpate_python PRIVATE ${PALPATE_WARNINGS})
palpate_precompile(palpate_python <pybind11/numpy.h> <pybind11/pybind11.h>)
# Else another module's static libraries (fmt, Ceres) could stand in for ours.
target_link_options(palpate_python PRIVATE LINKER:--exclude-libs,ALL)
# Nor is a user to need what nothing of it uses: a session's export to HDF5.
target_link_options(palpate_python PRIVATE LINKER:--as-needed)

file(GLOB palpate_python_files CONFIGURE_DEPENDS python/palpate/*.py python/palpate/*.pyi python/palpate/py.typed)
add_custom_target(palpate_python_files ALL
                  COMMAND ${CMAKE_COMMAND} -E copy_if_different ${palpate_python_files} ${CMAKE_BINARY_DIR}/python/palpate)
add_dependencies(palpate_python palpate_python_files)

function(palpate_python_tests)
  # The estimates of the library itself with all their digits.
  add_executable(palpate_python_dump python/tests/dump_estimates.cpp apps/palpate/estimate_input.cpp
                                     apps/palpate/reference_tare.cpp)
  target_link_libraries(palpate_python_dump PRIVATE palpate::identification fmt::fmt)
  target_compile_options(palpate_python_dump PRIVATE ${PALPATE_WARNINGS})
  set_target_properties(palpate_python_dump PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
  set(environment PYTHONPATH=${CMAKE_BINARY_DIR}/python PALPATE_BINARY=${CMAKE_BINARY_DIR}/bin/palpate
                  PALPATE_DUMP=${CMAKE_BINARY_DIR}/bin/palpate_python_dump PALPATE_SHARED_DIR=${PALPATE_SHARED_DIR}
                  MPLBACKEND=Agg)
  if(CMAKE_CXX_FLAGS MATCHES "-fsanitize=[a-z,]*address")
    # An interpreter that was built without it must load it first, and the library that throws with it. What Python
    # itself never frees is none of ours.
    set(first "")
    foreach(library IN ITEMS libasan.so libstdc++.so)
      execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-file-name=${library} OUTPUT_VARIABLE path
                      OUTPUT_STRIP_TRAILING_WHITESPACE)
      string(APPEND first "${path} ")
    endforeach()
    list(APPEND environment "LD_PRELOAD=${first}" ASAN_OPTIONS=detect_leaks=0)
  endif()
  file(GLOB tests CONFIGURE_DEPENDS python/tests/test_*.py)
  foreach(test IN LISTS tests)
    get_filename_component(name ${test} NAME_WE)
    string(REGEX REPLACE "^test_" "" name ${name})
    add_test(NAME python.${name} COMMAND ${Python_EXECUTABLE} -B -m pytest -q -rs -p no:cacheprovider ${test})
    set_tests_properties(python.${name} PROPERTIES LABELS python ENVIRONMENT "${environment}")
  endforeach()
  # The numbered examples' twins.
  set(demo ${PROJECT_BINARY_DIR}/artifacts/examples/demo)
  set(examples ${PROJECT_SOURCE_DIR}/examples)
  function(twin name)
    add_test(NAME example.${name}.py COMMAND ${Python_EXECUTABLE} -B ${examples}/${name}.py ${ARGN})
    set_tests_properties(example.${name}.py PROPERTIES LABELS "example;python" ENVIRONMENT "${environment}"
                                                       FIXTURES_REQUIRED example_recording)
  endfunction()
  twin(01_shape)
  twin(02_force_from_a_frame)
  twin(03_recording ${demo}.catheter.toml ${demo}.tracker.csv ${demo}.force.csv)
  twin(04_control_loop ${demo}.catheter.toml ${demo}.tracker.csv)
  twin(05_batch)
  twin(06_identify_stiffness ${examples}/stiffness/catheter.toml ${examples}/stiffness/cases.toml)
  twin(07_simulate ${examples}/scenarios/beating_heart.toml)
  add_test(NAME python.types COMMAND ${Python_EXECUTABLE} -B -m mypy --cache-dir=${CMAKE_BINARY_DIR}/mypy
           WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
  set_tests_properties(python.types PROPERTIES LABELS python)
endfunction()
if(PALPATE_BUILD_TESTS)
  palpate_python_tests()
endif()

# The C++ side of python/benchmarks/batch.py.
if(PALPATE_BUILD_BENCHMARKS)
  add_executable(benchmark_python_batch python/benchmarks/batch_loop.cpp)
  set_target_properties(benchmark_python_batch PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
  target_link_libraries(benchmark_python_batch PRIVATE palpate::batch fmt::fmt)
  target_compile_options(benchmark_python_batch PRIVATE ${PALPATE_WARNINGS})
endif()
