# Installs the library, its headers and a CMake package: find_package(oktett CONFIG) gives oktett::oktett.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS oktett EXPORT oktett-targets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
if(TARGET oktett_app)
  install(TARGETS oktett_app RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
foreach(layer core kernels accel render io)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${layer} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/oktett
    FILES_MATCHING PATTERN "*.h")
endforeach()

install(EXPORT oktett-targets NAMESPACE oktett:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/oktett)
configure_package_config_file(cmake/oktett-config.cmake.in ${PROJECT_BINARY_DIR}/oktett-config.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/oktett)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/oktett-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/oktett-config.cmake ${PROJECT_BINARY_DIR}/oktett-config-version.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/oktett)

configure_file(cmake/oktett.pc.in ${PROJECT_BINARY_DIR}/oktett.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/oktett.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
