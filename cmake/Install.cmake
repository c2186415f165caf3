# `cmake --install`: the library, its headers under include/sheaf/<module>/, the command, and what find_package(sheaf)
# reads.
include(CMakePackageConfigHelpers)

install(TARGETS sheaf EXPORT sheafTargets)
install(TARGETS sheaf_command)
foreach(module IN LISTS SHEAF_MODULES)
  install(
    DIRECTORY ${module}
    DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/sheaf
    FILES_MATCHING
    PATTERN "*.h"
    PATTERN "*-inl.h" EXCLUDE)
endforeach()

set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/sheaf)
install(EXPORT sheafTargets NAMESPACE sheaf:: DESTINATION ${config_dir})
configure_package_config_file(cmake/sheafConfig.cmake.in ${PROJECT_BINARY_DIR}/sheafConfig.cmake
                              INSTALL_DESTINATION ${config_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/sheafConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES cmake/Dependencies.cmake ${PROJECT_BINARY_DIR}/sheafConfig.cmake
              ${PROJECT_BINARY_DIR}/sheafConfigVersion.cmake DESTINATION ${config_dir})
