# SPDX-License-Identifier: BSD-3-Clause
# Installs to a temporary prefix, then builds and runs an outside project against it.

file(REMOVE_RECURSE ${WORK})

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "failed (${status}): ${ARGN}")
  endif()
endfunction()

set(prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${prefix})

# Nothing but what bears Firn's name, so that it may go to /usr/local.
file(GLOB_RECURSE installed RELATIVE ${prefix} ${prefix}/*)
foreach(file IN LISTS installed)
  if(NOT file MATCHES "^(bin/firn(-guest|-verify)?|include/firn/.+[.]hp*|lib.*/libfirn_[a-z_]+[.](a|so)|lib.*/cmake/Firn/Firn[A-Za-z-]+[.]cmake|share/doc/Firn/LICENSE)$")
    message(FATAL_ERROR "installed although it does not belong there: ${file}")
  endif()
endforeach()

# The source tree must not be needed: nothing installed may name it.
set(package_files ${installed})
list(FILTER package_files INCLUDE REGEX "cmake/Firn/")
if(NOT package_files)
  message(FATAL_ERROR "no package files under ${prefix}")
endif()
foreach(file IN LISTS package_files)
  file(READ ${prefix}/${file} text)
  string(FIND "${text}" "${SOURCE_DIR}/" at)
  if(NOT at EQUAL -1)
    message(FATAL_ERROR "${file} names the source tree ${SOURCE_DIR}")
  endif()
endforeach()

# Copied away from the tree, so that no header is found by accident.
file(COPY ${OUTSIDE} DESTINATION ${WORK})

# Every installed header finds what it includes.
set(includes "")
foreach(file IN LISTS installed)
  if(file MATCHES "^include/firn/(.+/.+)$" OR file MATCHES "^include/(firn/.+)$")
    string(APPEND includes "#include \"${CMAKE_MATCH_1}\"\n")
  endif()
endforeach()
file(WRITE ${WORK}/outside/every_header.cpp "${includes}")

run(${CMAKE_COMMAND} -S ${WORK}/outside -B ${WORK}/build -G ${GENERATOR} -DCMAKE_PREFIX_PATH=${prefix}
  -DCMAKE_C_COMPILER=${C_COMPILER} -DCMAKE_CXX_COMPILER=${CXX_COMPILER}
  -DCMAKE_CXX_FLAGS=${CXX_FLAGS} -DCMAKE_BUILD_TYPE=Release)
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/outside)

# A guest in C needs one header, and no CMake.
file(COPY ${SOURCE_DIR}/examples/c DESTINATION ${WORK}/guest)
file(GLOB guest_sources ${WORK}/guest/c/*.c)
run(${C_COMPILER} -std=c11 -O2 -ffp-contract=off -fPIC -shared -I${prefix}/include ${guest_sources} -lm
  -o ${WORK}/guest/libmpm.so)
run(${prefix}/bin/firn check tiny_impact --solver ${WORK}/guest/libmpm.so --steps 1)

# The installed program finds the one behind `firn verify` beside itself.
run(${prefix}/bin/firn verify --list)
