# SPDX-License-Identifier: Apache-2.0
# What a live process is made of: the link to tracker and Slicer, the session's recording, the web server, the service.
# Part of the command line, not of what is installed.
find_package(Threads REQUIRED)
find_package(SQLite3 REQUIRED)
find_package(OpenSSL REQUIRED)

# CMake's own module wants the C language and links what the library was built with.
find_path(PALPATE_HDF5_INCLUDE hdf5.h PATH_SUFFIXES hdf5/serial REQUIRED)
find_library(PALPATE_HDF5_LIBRARY NAMES hdf5_serial hdf5 PATH_SUFFIXES hdf5/serial REQUIRED)
add_library(palpate_hdf5 INTERFACE)
target_include_directories(palpate_hdf5 SYSTEM INTERFACE ${PALPATE_HDF5_INCLUDE})
target_link_libraries(palpate_hdf5 INTERFACE ${PALPATE_HDF5_LIBRARY})

function(palpate_live_library name)
  file(GLOB sources CONFIGURE_DEPENDS palpate/${name}/*.cpp)
  if(NOT sources)
    return()
  endif()
  add_library(palpate_${name} STATIC ${sources})
  target_link_libraries(palpate_${name} PUBLIC palpate ${ARGN} PRIVATE fmt::fmt)
  target_compile_options(palpate_${name} PRIVATE ${PALPATE_WARNINGS})
  palpate_precompile(palpate_${name})
endfunction()

palpate_live_library(store SQLite::SQLite3)
palpate_live_library(link Boost::headers Threads::Threads)
palpate_live_library(ndi Boost::headers Threads::Threads)
palpate_live_library(http Boost::headers OpenSSL::SSL OpenSSL::Crypto Threads::Threads)
palpate_live_library(session palpate_store nlohmann_json::nlohmann_json Threads::Threads palpate_hdf5)
palpate_live_library(service palpate_session palpate_link palpate_ndi palpate_http palpate_identification
                     nlohmann_json::nlohmann_json tomlplusplus::tomlplusplus Boost::headers Threads::Threads)
