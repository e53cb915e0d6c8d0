# SPDX-License-Identifier: Apache-2.0
# Run by CPack over what is installed, before it becomes packages: Debian wants man pages and changelogs compressed, and
# zsh looks for a package's completion in a folder of its own.
file(GLOB_RECURSE installed ${CPACK_TEMPORARY_DIRECTORY}/*)
foreach(file IN LISTS installed)
  if(file MATCHES "/share/man/.*\\.1$|/changelog\\.Debian$")
    execute_process(COMMAND gzip -9nf ${file} COMMAND_ERROR_IS_FATAL ANY)
  elseif(file MATCHES "(.*/share/zsh)/site-functions/(.*)")
    file(MAKE_DIRECTORY ${CMAKE_MATCH_1}/vendor-completions)
    file(RENAME ${file} ${CMAKE_MATCH_1}/vendor-completions/${CMAKE_MATCH_2})
    file(REMOVE_RECURSE ${CMAKE_MATCH_1}/site-functions)
  endif()
endforeach()
