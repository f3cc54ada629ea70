file(REMOVE_RECURSE ${WORK})

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "failed (${status}): ${ARGN}")
  endif()
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK}/prefix)
# The source tree must not be needed: nothing installed may name it.
file(GLOB package_files ${WORK}/prefix/lib*/cmake/Firn/*.cmake ${WORK}/prefix/lib/*/cmake/Firn/*.cmake)
if(NOT package_files)
  message(FATAL_ERROR "no package files under ${WORK}/prefix")
endif()
cmake_path(GET OUTSIDE PARENT_PATH install_dir)
cmake_path(GET install_dir PARENT_PATH verification_dir)
cmake_path(GET verification_dir PARENT_PATH source_dir)
foreach(file IN LISTS package_files)
  file(READ ${file} text)
  string(FIND "${text}" "${source_dir}/" at)
  if(NOT at EQUAL -1)
    message(FATAL_ERROR "${file} names the source tree ${source_dir}")
  endif()
endforeach()

# Copied away from the tree, so that no header is found by accident.
file(COPY ${OUTSIDE} DESTINATION ${WORK})
run(${CMAKE_COMMAND} -S ${WORK}/outside -B ${WORK}/build -G ${GENERATOR} -DCMAKE_PREFIX_PATH=${WORK}/prefix
  -DCMAKE_C_COMPILER=${C_COMPILER} -DCMAKE_CXX_COMPILER=${CXX_COMPILER}
  -DCMAKE_CXX_FLAGS=${CXX_FLAGS} -DCMAKE_BUILD_TYPE=Release)
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/outside)
# The installed program finds the one behind `firn verify` beside itself.
run(${WORK}/prefix/bin/firn verify --list)
