# Installs the library, its public headers and a CMake package: find_package(oktett CONFIG) gives oktett::oktett. The
# components are the packages of cmake/package.cmake.
include(CMakePackageConfigHelpers)
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME dev)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/oktett)
target_include_directories(oktett PUBLIC $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)

install(TARGETS oktett EXPORT oktett-targets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT command NAMELINK_COMPONENT dev
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
get_property(oktett_io_libraries GLOBAL PROPERTY OKTETT_IO_LIBRARIES)
install(TARGETS ${oktett_io_libraries} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} NAMELINK_SKIP COMPONENT command)
if(TARGET oktett_app)
  set(data ${CMAKE_INSTALL_DATADIR})
  install(TARGETS oktett_app RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT command)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/pages/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT command
    FILES_MATCHING PATTERN "*.1")
  install(FILES ${PROJECT_BINARY_DIR}/pages/oktett.bash
    DESTINATION ${data}/bash-completion/completions RENAME oktett COMPONENT command)
  install(FILES ${PROJECT_BINARY_DIR}/pages/oktett.zsh
    DESTINATION ${data}/zsh/vendor-completions RENAME _oktett COMPONENT command)
  install(FILES ${PROJECT_BINARY_DIR}/pages/oktett.fish
    DESTINATION ${data}/fish/vendor_completions.d COMPONENT command)
  # The scenes name the schema of their files as ../docs/oktett.schema.json.
  install(DIRECTORY scenes DESTINATION ${data}/oktett COMPONENT command)
  install(FILES docs/oktett.schema.json DESTINATION ${data}/oktett/docs COMPONENT command)
  # Files NAME.oktett.yaml have a type of their own on desktops.
  install(FILES cmake/package/oktett.xml DESTINATION ${data}/mime/packages COMPONENT command)
endif()
install(DIRECTORY ${OKTETT_PUBLIC_INCLUDE_DIR}/oktett DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})

get_target_property(oktett_type oktett TYPE)
install(EXPORT oktett-targets NAMESPACE oktett:: DESTINATION ${package_dir})
configure_package_config_file(cmake/oktett-config.cmake.in ${PROJECT_BINARY_DIR}/oktett-config.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/oktett-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/oktett-config.cmake ${PROJECT_BINARY_DIR}/oktett-config-version.cmake
  DESTINATION ${package_dir})

# The pkg-config file finds its prefix from where it lies, so the whole tree may be moved. Whoever links the static
# library links what it uses; a shared library brings that itself.
if(oktett_type STREQUAL "STATIC_LIBRARY")
  set(OKTETT_PC_REQUIRES "Requires")
  set(OKTETT_PC_THREADS " -pthread")
else()
  set(OKTETT_PC_MESHOPTIMIZER "")
  set(OKTETT_PC_REQUIRES "Requires.private")
endif()
file(RELATIVE_PATH OKTETT_PC_PREFIX /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
configure_file(cmake/oktett.pc.in ${PROJECT_BINARY_DIR}/oktett.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/oktett.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
