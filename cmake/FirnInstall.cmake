# Installation: every library made by firn_add_library(), the program, the headers,
# and the package Firn for find_package(). Included last, when all targets exist.
#
# Verified by verification/tests/install, which builds an outside project against it.

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

get_property(firn_libraries GLOBAL PROPERTY FIRN_LIBRARIES)
set_target_properties(firn_arithmetic PROPERTIES EXPORT_NAME arithmetic)
install(TARGETS ${firn_libraries} firn_arithmetic EXPORT FirnTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS firn firn-verify firn-guest RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})

# Headers keep their place under the project's root, so that an #include reads the
# same inside and outside.
foreach(folder IN ITEMS firn io simulation)
  install(DIRECTORY ${folder} DESTINATION include
    FILES_MATCHING PATTERN "*.hpp" PATTERN "*.h" PATTERN "scene" EXCLUDE)
endforeach()
foreach(header IN ITEMS io/scene/builtin_scenes.hpp io/scene/scene_file.hpp
        reference/reference_solver.hpp reference/kernel.hpp reference/stencil.hpp reference/steps.hpp
        optimized/optimized_solver.hpp
        solvers/solvers.hpp verification/check/check.hpp)
  if(EXISTS ${PROJECT_SOURCE_DIR}/${header})
    cmake_path(GET header PARENT_PATH folder)
    install(FILES ${header} DESTINATION include/${folder})
  endif()
endforeach()

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
