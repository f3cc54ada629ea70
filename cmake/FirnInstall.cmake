# SPDX-License-Identifier: BSD-3-Clause
# Installation: the programs, every library made by firn_add_library() that is not INTERNAL, the
# public headers, and the package Firn for find_package(). Included last, when all targets exist.
#
# Verified by verification/tests/install, which builds an outside project against it.

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

get_property(firn_libraries GLOBAL PROPERTY FIRN_LIBRARIES)
set_target_properties(firn_arithmetic PROPERTIES EXPORT_NAME arithmetic)
install(TARGETS ${firn_libraries} firn_arithmetic EXPORT FirnTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS firn firn-guest RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})

# `./run demo` builds no more than it runs; what it built can be installed all the same.
install(TARGETS firn-verify RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} OPTIONAL)
install(CODE "if(NOT EXISTS \"$<TARGET_FILE:firn-verify>\")
  message(STATUS \"Without `firn verify`, which was not built: ./run build builds it\")
endif()")

# Everything is below include/firn, so that no folder called io/ or cli/ lands in a system's
# include/. An #include reads the same inside and outside: "firn/solver.hpp" is found from
# include/, "io/trajectory/reader.hpp" from include/firn/ (firn_add_library() names both).
file(GLOB firn_public_headers RELATIVE ${PROJECT_SOURCE_DIR} CONFIGURE_DEPENDS
  ${PROJECT_SOURCE_DIR}/firn/*.hpp ${PROJECT_SOURCE_DIR}/firn/*.h ${PROJECT_SOURCE_DIR}/simulation/*.hpp)
list(APPEND firn_public_headers
  io/mesh/mesh_shape.hpp io/mesh/triangle_mesh.hpp
  io/output_error.hpp
  io/results/results.hpp io/results/results_file.hpp
  io/scene/builtin_scenes.hpp io/scene/scene_file.hpp
  io/trajectory/compare.hpp io/trajectory/diagnostics_row.hpp io/trajectory/format.hpp
  io/trajectory/reader.hpp io/trajectory/writer.hpp
  optimized/optimized_solver.hpp
  reference/kernel.hpp reference/reference_solver.hpp reference/stencil.hpp reference/steps.hpp
  solvers/solvers.hpp
  verification/check/check.hpp verification/check/check_set.hpp verification/check/error_map.hpp
  verification/check/exercised.hpp verification/check/not_judged.hpp verification/check/cause.hpp
  verification/check/windows.hpp)
foreach(header IN LISTS firn_public_headers)
  cmake_path(GET header PARENT_PATH folder)
  if(folder STREQUAL "firn")
    set(folder "")
  endif()
  install(FILES ${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/firn/${folder})
endforeach()
if(EXISTS ${PROJECT_SOURCE_DIR}/LICENSE)
  install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
endif()

# What our libraries link against must be found before FirnTargets is read: those of
# the following that this build found.
get_property(found GLOBAL PROPERTY PACKAGES_FOUND)
set(FIRN_DEPENDENCIES "")
foreach(package IN ITEMS "Eigen3 CONFIG" "fmt CONFIG" "nlohmann_json CONFIG" "tomlplusplus CONFIG"
                         "hwy CONFIG" "spdlog CONFIG" "Threads" "OpenMP" "HDF5 COMPONENTS C" "TBB CONFIG"
                         "OpenVDB")
  string(REGEX MATCH "^[^ ]+" name "${package}")
  if(name IN_LIST found)
    string(APPEND FIRN_DEPENDENCIES "find_dependency(${package})\n")
  endif()
endforeach()

set(firn_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/Firn)
configure_package_config_file(cmake/FirnConfig.cmake.in ${PROJECT_BINARY_DIR}/FirnConfig.cmake
  INSTALL_DESTINATION ${firn_package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/FirnConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)  # 0.x: a minor version may change the interface
install(EXPORT FirnTargets NAMESPACE Firn:: DESTINATION ${firn_package_dir})
install(FILES ${PROJECT_BINARY_DIR}/FirnConfig.cmake ${PROJECT_BINARY_DIR}/FirnConfigVersion.cmake
  DESTINATION ${firn_package_dir})
