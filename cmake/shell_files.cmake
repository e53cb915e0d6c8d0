# SPDX-License-Identifier: Apache-2.0
# Man pages and shell completion, made by the program from its own --help. Crossing to another machine leaves them out:
# the program cannot run here.
if(NOT TARGET palpate_cli OR CMAKE_CROSSCOMPILING)
  return()
endif()

set(PALPATE_SHELL_FILES ${PROJECT_BINARY_DIR}/shell)
add_custom_command(
  OUTPUT ${PALPATE_SHELL_FILES}/stamp
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${PALPATE_SHELL_FILES}/man1
  COMMAND ${CMAKE_COMMAND} -E make_directory ${PALPATE_SHELL_FILES}/man1
  COMMAND palpate_cli man --out ${PALPATE_SHELL_FILES}/man1
  COMMAND palpate_cli completion bash --out ${PALPATE_SHELL_FILES}/palpate
  COMMAND palpate_cli completion zsh --out ${PALPATE_SHELL_FILES}/_palpate
  COMMAND palpate_cli completion fish --out ${PALPATE_SHELL_FILES}/palpate.fish
  COMMAND ${CMAKE_COMMAND} -E touch ${PALPATE_SHELL_FILES}/stamp
  DEPENDS palpate_cli
  COMMENT "Man pages and shell completion" VERBATIM)
add_custom_target(palpate_shell_files ALL DEPENDS ${PALPATE_SHELL_FILES}/stamp)

install(DIRECTORY ${PALPATE_SHELL_FILES}/man1/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
install(FILES ${PALPATE_SHELL_FILES}/palpate
        DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program)
install(FILES ${PALPATE_SHELL_FILES}/_palpate
        DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions COMPONENT program)
install(FILES ${PALPATE_SHELL_FILES}/palpate.fish
        DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT program)
