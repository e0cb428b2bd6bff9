# Manual pages and completion scripts are printed by the command itself, from the tables it parses with. There is a page
# for every command of its overview; the tests compare.
include(GNUInstallDirs)
set(doc_dir "${CMAKE_CURRENT_BINARY_DIR}/share")
set(pages rfsmooth.1.gz)
set(page_commands COMMAND sh -c "$<TARGET_FILE:rfsmooth_command> man | gzip -9n > ${doc_dir}/rfsmooth.1.gz")
foreach(name denoise tiles mesh smooth-mesh reconstruct info compare render report flows)
  list(APPEND pages rfsmooth-${name}.1.gz)
  list(APPEND page_commands COMMAND sh -c "$<TARGET_FILE:rfsmooth_command> man ${name} | gzip -9n > ${doc_dir}/rfsmooth-${name}.1.gz")
endforeach()
list(TRANSFORM pages PREPEND "${doc_dir}/")
set(completions "${doc_dir}/rfsmooth" "${doc_dir}/_rfsmooth")
add_custom_command(
  OUTPUT ${pages} ${completions}
  COMMAND "${CMAKE_COMMAND}" -E make_directory "${doc_dir}"
  ${page_commands}
  COMMAND sh -c "$<TARGET_FILE:rfsmooth_command> completion bash > ${doc_dir}/rfsmooth"
  COMMAND sh -c "$<TARGET_FILE:rfsmooth_command> completion zsh > ${doc_dir}/_rfsmooth"
  DEPENDS rfsmooth_command
  VERBATIM)
add_custom_target(rfsmooth_docs ALL DEPENDS ${pages} ${completions})

install(TARGETS rfsmooth_command DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT command)
list(FILTER pages EXCLUDE REGEX "/rfsmooth-reconstruct[.]")  # goes with that program
install(FILES ${pages} DESTINATION "${CMAKE_INSTALL_MANDIR}/man1" COMPONENT command)
install(FILES "${doc_dir}/rfsmooth" DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions" COMPONENT command)
# Where zsh looks: Debian's keeps what packages bring apart from what an administrator puts under /usr/local.
set(zsh_folder site-functions)
if(CMAKE_INSTALL_PREFIX STREQUAL "/usr" AND EXISTS /etc/debian_version)
  set(zsh_folder vendor-completions)
endif()
install(FILES "${doc_dir}/_rfsmooth" DESTINATION "${CMAKE_INSTALL_DATADIR}/zsh/${zsh_folder}" COMPONENT command)
