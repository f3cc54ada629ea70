# SPDX-License-Identifier: BSD-3-Clause
# cmake -DGIT= -DCLANG_FORMAT= -DFOLDERS= -DMODE=format|format-check -P run_clang_format.cmake
execute_process(COMMAND ${GIT} ls-files --cached --others --exclude-standard ${FOLDERS}
  OUTPUT_VARIABLE files COMMAND_ERROR_IS_FATAL ANY)
string(REPLACE "\n" ";" files "${files}")
list(FILTER files INCLUDE REGEX "\\.(c|cpp|h|hpp)$")
list(LENGTH files count)
if(count EQUAL 0)
  message(FATAL_ERROR "no source file found")
endif()
if(MODE STREQUAL "format")
  execute_process(COMMAND ${CLANG_FORMAT} -i ${files} COMMAND_ERROR_IS_FATAL ANY)
else()
  execute_process(COMMAND ${CLANG_FORMAT} --dry-run -Werror ${files} COMMAND_ERROR_IS_FATAL ANY)
endif()
message(STATUS "${MODE}: ${count} files")
