# SPDX-License-Identifier: BSD-3-Clause
# Run at every build: the commit may have changed since the last configure. The
# file is rewritten only when its text changes.
set(GIT_COMMIT unknown)
execute_process(COMMAND git rev-parse --short=10 HEAD WORKING_DIRECTORY "${SOURCE_DIR}"
                OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(NOT failed)
  execute_process(COMMAND git status --porcelain --untracked-files=no WORKING_DIRECTORY "${SOURCE_DIR}"
                  OUTPUT_VARIABLE changes ERROR_QUIET)
  set(GIT_COMMIT "${commit}")
  if(changes)
    string(APPEND GIT_COMMIT "+")
  endif()
endif()
configure_file("${SOURCE_DIR}/cmake/build_info.cpp.in" "${OUTPUT}" @ONLY)
