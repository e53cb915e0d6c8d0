# SPDX-License-Identifier: Apache-2.0
# What most sources of a target include, parsed once. A source still names what it uses: configure with
# -D CMAKE_DISABLE_PRECOMPILE_HEADERS=ON to see that it does.
function(palpate_precompile target)
  target_precompile_headers(${target} PRIVATE <algorithm> <array> <cmath> <filesystem> <functional> <limits> <optional>
                            <string> <vector> <Eigen/Cholesky> <Eigen/Eigenvalues> <Eigen/Geometry> <fmt/format.h> ${ARGN})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE -fpch-preprocess)  # for ccache
  endif()
endfunction()
