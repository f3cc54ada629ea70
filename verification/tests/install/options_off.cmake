# SPDX-License-Identifier: BSD-3-Clause
# Builds a second tree with every option off, as far as `./run demo` does, runs it and installs it.
# All at once: FIRN_WITH_OPENVDB alone changes what is compiled; the others leave targets out, and
# no target that is left needs one of those.

file(REMOVE_RECURSE ${WORK})

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "failed (${status}): ${ARGN}")
  endif()
endfunction()

# Not optimized: it is built to see that it can be built.
run(${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${WORK}/build -G ${GENERATOR}
  -DCMAKE_C_COMPILER=${C_COMPILER} -DCMAKE_CXX_COMPILER=${CXX_COMPILER} -DCMAKE_CXX_FLAGS=${CXX_FLAGS}
  -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O0
  -DFIRN_BUILD_TESTS=OFF -DFIRN_WITH_OPENVDB=OFF -DFIRN_EMCC=OFF -DFIRN_PYTHON=)
run(${CMAKE_COMMAND} --build ${WORK}/build --target firn firn-verify)
run(${WORK}/build/bin/firn info)
run(${WORK}/build/bin/firn check)
run(${WORK}/build/bin/firn verify --filter Kernel.*)

run(${CMAKE_COMMAND} --install ${WORK}/build --prefix ${WORK}/prefix)
run(${WORK}/prefix/bin/firn info)
