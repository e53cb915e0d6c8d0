# SPDX-License-Identifier: Apache-2.0
# `palpate study --mpi`: a program of its own beside palpate, which would otherwise load MPI at every start.
set(MPI_CXX_SKIP_MPICXX ON)  # the C interface alone: the C++ one is deprecated
find_package(MPI COMPONENTS CXX)
option(PALPATE_MPI "Build palpate-study-mpi, for studies over several machines" ${MPI_CXX_FOUND})
if(PALPATE_MPI)
  find_package(MPI REQUIRED COMPONENTS CXX)
  add_executable(palpate_study_mpi apps/palpate-study-mpi/main.cpp apps/palpate/study_run.cpp apps/palpate/file_paths.cpp
                                   apps/palpate/progress_line.cpp palpate/study/mpi_workers.cpp)
  set_target_properties(palpate_study_mpi PROPERTIES OUTPUT_NAME palpate-study-mpi
                                                     RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
  target_link_libraries(palpate_study_mpi PRIVATE palpate_study MPI::MPI_CXX CLI11::CLI11 fmt::fmt)
  target_compile_options(palpate_study_mpi PRIVATE ${PALPATE_WARNINGS})
endif()
