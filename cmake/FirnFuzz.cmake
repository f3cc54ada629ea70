# SPDX-License-Identifier: BSD-3-Clause
# Fuzz targets. A target is one source file with LLVMFuzzerTestOneInput.
#
# With FIRN_BUILD_FUZZERS (clang only) everything is compiled with coverage and
# the address and undefined-behaviour sanitizers, and NAME is a libFuzzer
# program:
#   build/fuzz/bin/fuzz_scene -dict=verification/fuzz/dictionaries/scene.dict NEW verification/fuzz/corpus/scene
# With any compiler replay_NAME runs the stored corpus through the same function
# as a test, so that what was found once stays mended.

option(FIRN_BUILD_FUZZERS "Build libFuzzer targets (clang only)" OFF)

if(FIRN_BUILD_FUZZERS)
  if(NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    message(FATAL_ERROR "FIRN_BUILD_FUZZERS needs clang: use the preset `fuzz`")
  endif()
  add_compile_options(-fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined
    -fno-omit-frame-pointer)
  add_link_options(-fsanitize=address,undefined)
endif()

# firn_add_fuzzer(NAME SOURCES… LIBS… CORPUS folders…)
function(firn_add_fuzzer name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBS;CORPUS" ${ARGN})
  set(programs "")
  if(FIRN_BUILD_FUZZERS)
    add_executable(${name} ${ARG_SOURCES})
    target_link_options(${name} PRIVATE -fsanitize=fuzzer)
    list(APPEND programs ${name})
  endif()
  if(FIRN_BUILD_TESTS)
    add_executable(replay_${name} ${ARG_SOURCES} ${PROJECT_SOURCE_DIR}/verification/fuzz/replay.cpp)
    add_test(NAME replay_${name} COMMAND replay_${name} ${ARG_CORPUS})
    set_tests_properties(replay_${name} PROPERTIES TIMEOUT 600)
    list(APPEND programs replay_${name})
  endif()
  foreach(program IN LISTS programs)
    target_include_directories(${program} PRIVATE ${PROJECT_SOURCE_DIR})
    target_link_libraries(${program} PRIVATE firn_arithmetic firn_warnings ${ARG_LIBS})
  endforeach()
endfunction()
