# SPDX-License-Identifier: Apache-2.0
# After it, find_package(palpate CONFIG) gives palpate::palpate; with COMPONENTS identification or batch also
# palpate::identification or palpate::batch and what that links.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(palpate_config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/palpate)

install(TARGETS palpate EXPORT palpateTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
        INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(TARGETS palpate_identification EXPORT palpateIdentificationTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
        COMPONENT development INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(TARGETS palpate_batch EXPORT palpateBatchTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
        COMPONENT development INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
if(TARGET palpate_cli)
  install(TARGETS palpate_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
endif()
if(TARGET palpate_study_mpi)
  install(TARGETS palpate_study_mpi RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT mpi)
endif()
# The rooms of what is installed. What only these libraries' own sources include stays out: the rod's kernels and the
# readers' parts, which want xsimd and toml++.
foreach(room IN ITEMS batch estimation evaluation identification math observer plot recording rod sensing simulation)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/palpate/${room} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/palpate
          COMPONENT development FILES_MATCHING PATTERN "*.hpp"
          REGEX "/(rod/(field|integration|lanes|march|march_columns|march_lanes|runge_kutta)|batch/(kernel|lane_kernel|plan))\\.hpp$" EXCLUDE
          REGEX "/recording/(toml_table|catheter_(estimator|sensors|shaft|tendon_map)|scenario_(load|signals|tracker|truth))\\.hpp$" EXCLUDE)
endforeach()
foreach(export IN ITEMS palpateTargets palpateIdentificationTargets palpateBatchTargets)
  install(EXPORT ${export} NAMESPACE palpate:: DESTINATION ${palpate_config_dir} COMPONENT development)
endforeach()
# A small project of a user's, to start from.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/tests/consumer DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libpalpate-dev/examples
        COMPONENT development FILES_MATCHING PATTERN CMakeLists.txt PATTERN "*.cpp")

# Whoever links a static library links what it links: one find_dependency for each imported target that the
# exported one names. What is there only to build the library stands in $<BUILD_INTERFACE:...> and is not named.
function(palpate_find_dependencies target out)
  get_target_property(links ${target} INTERFACE_LINK_LIBRARIES)
  set(lines "")
  foreach(link IN LISTS links)
    if(link MATCHES "^(\\$<LINK_ONLY:)?([A-Za-z0-9_]+)::")
      list(APPEND lines "find_dependency(${CMAKE_MATCH_2})")
    endif()
  endforeach()
  list(REMOVE_DUPLICATES lines)
  list(JOIN lines "\n" lines)
  set(${out} "${lines}" PARENT_SCOPE)
endfunction()
palpate_find_dependencies(palpate palpate_dependencies)
palpate_find_dependencies(palpate_identification palpate_identification_dependencies)
palpate_find_dependencies(palpate_batch palpate_batch_dependencies)

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/palpateConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/palpateConfig.cmake INSTALL_DESTINATION ${palpate_config_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/palpateConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/palpateConfig.cmake ${PROJECT_BINARY_DIR}/palpateConfigVersion.cmake
        DESTINATION ${palpate_config_dir} COMPONENT development)
