# SPDX-License-Identifier: Apache-2.0
# The rod's kernels are compiled for several instruction sets and chosen when the program runs; all else is built for
# the oldest processor. palpate_kernels(dir/name 256 OUT): dir/name_{baseline,avx2,avx512}.cpp, those that this processor's
# family can run.
find_package(xsimd REQUIRED)  # its headers are all that is used: its target would link xtl to every program

# Always optimised: unoptimised, the wide kernels would leave inline functions behind that the linker may give to the
# rest of the program (tests/rod/kernel_symbols.cmake). A kernel includes next to nothing, so precompiled headers would
# only be in the way.
set(palpate_kernel_flags_baseline -O3)
set(palpate_kernel_flags_avx2 -O3 -march=x86-64-v3)
set(palpate_kernel_flags_avx512 -O3 -march=x86-64-v4)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # False alarms in avx512fintrin.h, GCC bug 105593.
  list(APPEND palpate_kernel_flags_avx512 -Wno-maybe-uninitialized -Wno-uninitialized)
endif()

# One source for all: a sanitizer that watches the narrow kernel has seen the wide ones, and takes minutes to compile each.
if(CMAKE_CXX_FLAGS MATCHES "-fsanitize")
  list(APPEND palpate_kernel_flags_avx2 -fno-sanitize=all)
  list(APPEND palpate_kernel_flags_avx512 -fno-sanitize=all)
endif()

# widest: bits of the vectors that the AVX-512 kernel mostly uses. Copies are as wide as those: a vector stored in parts
# and read as a whole, or the other way round, waits for the store.
function(palpate_kernels name widest out)
  set(copy_bits_avx2 256)
  set(copy_bits_avx512 ${widest})
  set(sources "")
  foreach(set IN ITEMS baseline avx2 avx512)
    set(flags ${palpate_kernel_flags_${set}})
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND DEFINED copy_bits_${set})
      list(APPEND flags -mmove-max=${copy_bits_${set}} -mstore-max=${copy_bits_${set}})
    endif()
    if(set STREQUAL "baseline" OR CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
      list(APPEND sources ${name}_${set}.cpp)
      set_source_files_properties(${name}_${set}.cpp PROPERTIES SKIP_PRECOMPILE_HEADERS ON COMPILE_OPTIONS "${flags}")
    endif()
  endforeach()
  set(${out} ${sources} PARENT_SCOPE)
endfunction()
