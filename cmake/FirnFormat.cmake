# SPDX-License-Identifier: BSD-3-Clause
# Targets that judge the text of the code: format-check, format, tidy.
# All three want version 14 of the tools (other versions format differently) and
# exist only where it is installed: apt-get install clang-format-14 clang-tidy-14.

find_program(FIRN_CLANG_FORMAT NAMES clang-format-14)
find_program(FIRN_CLANG_TIDY NAMES clang-tidy-14)
find_program(FIRN_GIT NAMES git)

set(firn_code_folders firn io simulation reference optimized guests verification solvers bench cli teach web examples)

# Only what belongs to the project: the files that git knows.
if(FIRN_CLANG_FORMAT AND FIRN_GIT)
  foreach(target IN ITEMS format format-check)
    add_custom_target(${target}
      COMMAND ${CMAKE_COMMAND} -DGIT=${FIRN_GIT} -DCLANG_FORMAT=${FIRN_CLANG_FORMAT}
              "-DFOLDERS=${firn_code_folders}" -DMODE=${target}
              -P ${PROJECT_SOURCE_DIR}/cmake/run_clang_format.cmake
      WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} VERBATIM USES_TERMINAL)
  endforeach()
endif()

# tidy: every file of compile_commands.json, in parallel; FIRN_TIDY_ONLY narrows it to a
# regular expression, e.g. -DFIRN_TIDY_ONLY=reference/.
set(FIRN_TIDY_ONLY "" CACHE STRING "Regular expression of the files that target tidy looks at")
if(FIRN_CLANG_TIDY)
  find_package(Python3 REQUIRED COMPONENTS Interpreter)
  add_custom_target(tidy
    COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/cmake/run_clang_tidy.py
            --clang-tidy ${FIRN_CLANG_TIDY} --build ${PROJECT_BINARY_DIR}
            --source ${PROJECT_SOURCE_DIR} "--only=${FIRN_TIDY_ONLY}"
    VERBATIM USES_TERMINAL)
endif()
