# SPDX-License-Identifier: Apache-2.0
# cmake -D BUILD_DIR=... -D CXX_COMPILER=... [-D BUILD_TYPE=... -D CXX_FLAGS=...] -P install_and_consume.cmake
# Installs the build into its own tree, then configures, builds and runs the consumer against nothing but that.
set(place ${BUILD_DIR}/consumer)
file(REMOVE_RECURSE ${place})

function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${place}/prefix)
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${place}/build -G Ninja -D CMAKE_PREFIX_PATH=${place}/prefix
    -D CMAKE_CXX_COMPILER=${CXX_COMPILER} -D CMAKE_BUILD_TYPE=${BUILD_TYPE} -D CMAKE_CXX_FLAGS=${CXX_FLAGS})
run(${CMAKE_COMMAND} --build ${place}/build)
run(${place}/build/consumer)
