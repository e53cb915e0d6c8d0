# SPDX-License-Identifier: Apache-2.0
# cmake -D BUILD_DIR=... -D CXX_COMPILER=... [-D BUILD_TYPE=... -D CXX_FLAGS=...] -P install_and_consume.cmake
# Installs the build into its own tree, then configures, builds and runs the consumer against nothing but that.
set(place ${BUILD_DIR}/consumer)
set(include ${place}/prefix/include)
file(REMOVE_RECURSE ${place})

function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
endfunction()

# Rooms of the running program alone stay out, and headers include the standard library, Eigen and each other.
function(check_headers headers)
  foreach(header IN LISTS headers)
    if(header MATCHES "^palpate/(http|link|ndi|reproduction|service|session|store|study)/")
      message(SEND_ERROR "${header}: is no part of what a user needs")
    endif()
    file(STRINGS ${include}/${header} lines REGEX "^ *#include")
    foreach(line IN LISTS lines)
      if(NOT line MATCHES "#include <(palpate/[a-z_0-9/]+\\.hpp|Eigen/[A-Za-z]+|[a-z_0-9]+)>")
        message(SEND_ERROR "${header}: ${line}: expected the standard library, Eigen or palpate")
      elseif(CMAKE_MATCH_1 MATCHES "^palpate/" AND NOT EXISTS ${include}/${CMAKE_MATCH_1})
        message(SEND_ERROR "${header}: ${line}: is not installed")
      endif()
    endforeach()
  endforeach()
endfunction()

function(write_header_sources headers)
  foreach(order IN ITEMS forward backward)
    list(TRANSFORM headers REPLACE "(.+)" "#include <\\1>" OUTPUT_VARIABLE lines)
    list(JOIN lines "\n" text)
    file(WRITE ${place}/headers_${order}.cpp "${text}\n")
    list(REVERSE headers)
  endforeach()
endfunction()

function(check_links program unwanted)
  file(GET_RUNTIME_DEPENDENCIES EXECUTABLES ${program} RESOLVED_DEPENDENCIES_VAR libraries)
  foreach(library IN LISTS libraries)
    if(library MATCHES "${unwanted}")
      message(SEND_ERROR "${program} links ${library}")
    endif()
  endforeach()
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${place}/prefix)
file(GLOB_RECURSE headers RELATIVE ${include} ${include}/palpate/*.hpp)
list(LENGTH headers count)
if(count LESS 50)
  message(FATAL_ERROR "only ${count} headers were installed")
endif()
list(SORT headers)
check_headers("${headers}")
write_header_sources("${headers}")

run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${place}/build -G Ninja -D CMAKE_PREFIX_PATH=${place}/prefix
    -D CMAKE_CXX_COMPILER=${CXX_COMPILER} -D CMAKE_BUILD_TYPE=${BUILD_TYPE} -D CMAKE_CXX_FLAGS=${CXX_FLAGS}
    -D CONSUMER_HEADERS=${place})
run(${CMAKE_COMMAND} --build ${place}/build)
foreach(program IN ITEMS feel_force many_rods find_precurvature)
  run(${place}/build/${program})
endforeach()
check_links(${place}/build/feel_force "/lib(ceres|glog|nlopt|tbb|boost|ssl|crypto|sqlite3|hdf5|tomlplusplus)")
check_links(${place}/build/many_rods "/lib(ceres|glog|nlopt|boost|ssl|crypto|sqlite3|hdf5|tomlplusplus)")
# Ceres may bring TBB.
check_links(${place}/build/find_precurvature "/lib(boost|ssl|crypto|sqlite3|hdf5|tomlplusplus)")
