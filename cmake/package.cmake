# SPDX-License-Identifier: Apache-2.0
# cpack -G DEB makes palpate (program), libpalpate-dev (library), python3-palpate and, with MPI, palpate-mpi: who does not
# run campaigns over several machines installs no MPI.
set(PALPATE_PACKAGE_CONTACT "Palpate maintainers <palpate@palpate.invalid>" CACHE STRING
    "Maintainer of the packages, name <address>: for who publishes them to set")
set(debian ${CMAKE_CURRENT_LIST_DIR}/debian)
set(package_files ${PROJECT_BINARY_DIR}/package)
string(TIMESTAMP PALPATE_PACKAGE_DATE "%a, %d %b %Y %H:%M:%S +0000" UTC)  # SOURCE_DATE_EPOCH's, where that is set

function(palpate_package component name)
  set(folder ${CMAKE_INSTALL_DATADIR}/doc/${name})
  set(PALPATE_PACKAGE_NAME ${name})
  configure_file(${debian}/changelog.in ${package_files}/${name}/changelog.Debian @ONLY)
  install(FILES ${debian}/copyright ${package_files}/${name}/changelog.Debian DESTINATION ${folder}
          COMPONENT ${component})
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(CPACK_COMPONENTS_ALL ${CPACK_COMPONENTS_ALL} ${component} PARENT_SCOPE)
endfunction()

set(CPACK_COMPONENTS_ALL "")
palpate_package(development libpalpate-dev)
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "Force on a catheter's tip from its shape (C++ library)
Headers, static libraries and CMake files of Palpate: find_package(palpate
CONFIG) gives palpate::palpate, and by component palpate::identification and
palpate::batch.

Research software: not for clinical use.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libeigen3-dev, libfmt-dev")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_RECOMMENDS "libceres-dev, libnlopt-cxx-dev, libnlopt-dev, libtbb-dev")

if(TARGET palpate_cli)
  palpate_package(program palpate)
  set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "Force on a catheter's tip from its shape
Palpate estimates the three-dimensional force on the tip of a tendon-driven
catheter, with its uncertainty, from the poses that a tracker reports: live,
or from a recording. It identifies a catheter's stiffness, precurvature and
registration, simulates experiments, and records and replays sessions.

Research software: not for clinical use.")
  set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "gnuplot-nox | gnuplot")
  set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "bash-completion")
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/palpate COMPONENT program
          FILES_MATCHING PATTERN "*.toml" PATTERN "*.csv")
endif()
if(TARGET palpate_study_mpi)
  palpate_package(mpi palpate-mpi)
  set(CPACK_COMPONENT_MPI_DESCRIPTION "Force on a catheter's tip from its shape (campaigns over MPI)
What palpate study --mpi runs: Monte-Carlo campaigns over several machines.

Research software: not for clinical use.")
  set(CPACK_DEBIAN_MPI_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_MPI_PACKAGE_DEPENDS "palpate (= ${PROJECT_VERSION}-1)")
  file(WRITE ${package_files}/palpate-study-mpi.1 ".so man1/palpate-study.1\n")
  install(FILES ${package_files}/palpate-study-mpi.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT mpi)
endif()

if(TARGET palpate_python)
  palpate_package(python python3-palpate)
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION "Force on a catheter's tip from its shape (Python 3)
import palpate: the rod's shape, live and offline estimates of the force with
its uncertainty, identification, simulation, recordings as numpy arrays, and
pictures with matplotlib.

Research software: not for clinical use.")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  # The compiled module is of one version of Python.
  math(EXPR next "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "python3 (>= 3.${Python_VERSION_MINOR}~), python3 (<< 3.${next}), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS python3-matplotlib)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${debian}/postinst ${debian}/prerm)
  # Debian's place, so no part of a plain cmake --install: elsewhere pip knows where it belongs.
  set(packages lib/python3/dist-packages/palpate)
  install(TARGETS palpate_python LIBRARY DESTINATION ${packages} COMPONENT python EXCLUDE_FROM_ALL)
  install(FILES ${palpate_python_files} DESTINATION ${packages} COMPONENT python EXCLUDE_FROM_ALL)
  # As they lie in the source, so that each finds what it reads.
  set(documents ${CMAKE_INSTALL_DATADIR}/doc/python3-palpate)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples DESTINATION ${documents} COMPONENT python EXCLUDE_FROM_ALL
          FILES_MATCHING PATTERN "*.py" PATTERN "*.toml" PATTERN "*.csv")
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/python/examples DESTINATION ${documents}/python COMPONENT python
          EXCLUDE_FROM_ALL FILES_MATCHING PATTERN "*.py")
endif()

set(CPACK_PACKAGE_NAME palpate)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT ${PALPATE_PACKAGE_CONTACT})
set(CPACK_PACKAGE_VENDOR Palpate)
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_GENERATOR DEB)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/package_finish.cmake)
include(CPack)
