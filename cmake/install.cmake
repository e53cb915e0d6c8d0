# SPDX-License-Identifier: Apache-2.0
# After it, find_package(palpate CONFIG) gives palpate::palpate.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(palpate_config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/palpate)

install(TARGETS palpate EXPORT palpateTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
        INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
if(TARGET palpate_cli)
  install(TARGETS palpate_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/palpate DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.hpp")
install(EXPORT palpateTargets NAMESPACE palpate:: DESTINATION ${palpate_config_dir})

# Whoever links a static library links what it links: one find_dependency for each imported target that the
# exported one names. What is there only to build the library stands in $<BUILD_INTERFACE:...> and is not named.
get_target_property(palpate_links palpate INTERFACE_LINK_LIBRARIES)
set(palpate_dependencies "")
foreach(link IN LISTS palpate_links)
  if(link MATCHES "^(\\$<LINK_ONLY:)?([A-Za-z0-9_]+)::")
    list(APPEND palpate_dependencies "find_dependency(${CMAKE_MATCH_2})")
  endif()
endforeach()
list(REMOVE_DUPLICATES palpate_dependencies)
list(JOIN palpate_dependencies "\n" palpate_dependencies)

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/palpateConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/palpateConfig.cmake INSTALL_DESTINATION ${palpate_config_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/palpateConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/palpateConfig.cmake ${PROJECT_BINARY_DIR}/palpateConfigVersion.cmake
        DESTINATION ${palpate_config_dir})
