# SPDX-License-Identifier: Apache-2.0
# What everything but the kernels (cmake/kernels.cmake) is built for.
set(palpate_default_arch "")
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  set(palpate_default_arch x86-64-v2)
endif()
set(PALPATE_ARCH "${palpate_default_arch}" CACHE STRING "Processor level (-march) to build for; empty: the compiler's own")
set_property(CACHE PALPATE_ARCH PROPERTY STRINGS "" x86-64-v2 x86-64-v3 x86-64-v4)
if(PALPATE_ARCH)
  add_compile_options(-march=${PALPATE_ARCH})
endif()

# Eigen aligns its fixed-size types, and allocates, by the instruction set of whoever includes it: with AVX by 32 bytes,
# and with an aligned allocator of its own. A user's -march would then see other structs than the library, and free what
# the library allocated with the wrong function. Both are fixed here, for library and users alike (exported).
function(palpate_fix_eigen_abi target)
  target_compile_definitions(${target} PUBLIC EIGEN_MAX_ALIGN_BYTES=16 EIGEN_MALLOC_ALREADY_ALIGNED=1)
endfunction()
