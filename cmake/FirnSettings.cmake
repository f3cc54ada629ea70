# SPDX-License-Identifier: BSD-3-Clause
# Compiler settings and the functions with which every folder declares itself.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release)
endif()
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin")

# Paths below the source tree count as relative, so that another clone finds what this one compiled.
find_program(FIRN_CCACHE ccache)
if(FIRN_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_C_COMPILER_LAUNCHER
      "${CMAKE_COMMAND}" -E env "CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}" "${FIRN_CCACHE}")
  set(CMAKE_CXX_COMPILER_LAUNCHER "${CMAKE_C_COMPILER_LAUNCHER}")
endif()

# Files of one target are compiled in batches, so that the headers of the standard library, Eigen and
# GoogleTest are read once for many. -DCMAKE_UNITY_BUILD=OFF, as in the preset `dev`, compiles each
# file alone and so shows where one lacks an #include.
if(NOT DEFINED CMAKE_UNITY_BUILD)
  set(CMAKE_UNITY_BUILD ON)
endif()
set(CMAKE_UNITY_BUILD_BATCH_SIZE 8)

# firn_warnings: warnings are errors. Private to our own targets.
add_library(firn_warnings INTERFACE)
target_compile_options(firn_warnings INTERFACE -Wall -Wextra -Wpedantic -Werror)
# From version 13 on, g++ takes the alternatives that a std::variant does not hold (firn/shape.hpp)
# for variables not initialized; g++ 12 and clang still look for those that are not.
target_compile_options(firn_warnings INTERFACE
  $<$<AND:$<COMPILE_LANG_AND_ID:CXX,GNU>,$<VERSION_GREATER_EQUAL:$<CXX_COMPILER_VERSION>,13>>:-Wno-maybe-uninitialized>)

# firn_arithmetic: the same bits from g++ and clang. No contraction of a*b+c, no
# vector code from Eigen (its alignment would differ between translation units
# compiled for different instruction sets).
add_library(firn_arithmetic INTERFACE)
target_compile_options(firn_arithmetic INTERFACE -ffp-contract=off)
target_compile_definitions(firn_arithmetic INTERFACE EIGEN_DONT_VECTORIZE)

# firn_add_library(NAME [INTERNAL] [ONE_BY_ONE] SOURCES… [LIBS…]): target firn_NAME, installed and
# exported as Firn::NAME unless it is INTERNAL. ONE_BY_ONE: no batches; for code whose instructions
# are counted, so that none of it is inlined across files.
function(firn_add_library name)
  cmake_parse_arguments(ARG "INTERNAL;ONE_BY_ONE" "" "SOURCES;LIBS;PRIVATE_LIBS" ${ARGN})
  add_library(firn_${name} ${ARG_SOURCES})
  add_library(Firn::${name} ALIAS firn_${name})
  set_target_properties(firn_${name} PROPERTIES EXPORT_NAME ${name})
  if(ARG_ONE_BY_ONE)
    set_target_properties(firn_${name} PROPERTIES UNITY_BUILD OFF)
  endif()
  if(NOT ARG_INTERNAL)
    set_property(GLOBAL APPEND PROPERTY FIRN_LIBRARIES firn_${name})  # FirnInstall.cmake
  endif()
  target_include_directories(firn_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:include> $<INSTALL_INTERFACE:include/firn>)
  target_link_libraries(firn_${name} PUBLIC firn_arithmetic ${ARG_LIBS}
    PRIVATE $<BUILD_INTERFACE:firn_warnings> ${ARG_PRIVATE_LIBS})
endfunction()

# firn_add_test(NAME SOURCES… LIBS… [LABELS…]): a GoogleTest program, one ctest per case.
# Label `long` keeps a program out of `./run test`. Compiled with -O1: the work is done in the
# libraries, and the bits are the same (firn_arithmetic).
function(firn_add_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBS;LABELS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE firn_arithmetic firn_warnings ${ARG_LIBS} GTest::gtest_main)
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  if(NOT ARG_LABELS)
    set(ARG_LABELS fast)  # an empty value would swallow the TIMEOUT that follows
  endif()
  gtest_discover_tests(${name} TEST_PREFIX "${name}." DISCOVERY_TIMEOUT 60
    PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT 600
    # Threads that wait do so asleep: tests share the machine with other tests.
    ENVIRONMENT OMP_WAIT_POLICY=passive)
endfunction()
