# SPDX-License-Identifier: Apache-2.0
# palpate::batch, a library of its own: who solves one rod at a time links no TBB.
find_package(TBB REQUIRED)

file(GLOB palpate_batch_sources CONFIGURE_DEPENDS palpate/batch/*.cpp)
list(FILTER palpate_batch_sources EXCLUDE REGEX "/kernel_[a-z0-9]+\\.cpp$")
palpate_kernels(palpate/batch/kernel 512 palpate_batch_kernels)
add_library(palpate_batch STATIC ${palpate_batch_sources} ${palpate_batch_kernels})
add_library(palpate::batch ALIAS palpate_batch)
set_target_properties(palpate_batch PROPERTIES EXPORT_NAME batch)
target_link_libraries(palpate_batch PUBLIC palpate PRIVATE fmt::fmt TBB::tbb)
target_compile_options(palpate_batch PRIVATE ${PALPATE_WARNINGS})
palpate_precompile(palpate_batch)
