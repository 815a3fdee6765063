# Installs into a prefix inside the build tree, looks at the headers there, then builds and runs separate programs against
# it: with CMake's package, and with the pkg-config file if there is a pkg-config. The last steps use the library from its
# source folder, and compare the example of README.md with the program that is run.
if(TARGET oktett_app)
  set(install_needs oktett_app)
endif()
find_program(OKTETT_PKG_CONFIG NAMES pkgconf pkg-config)
mark_as_advanced(OKTETT_PKG_CONFIG)

function(add_install_test name)
  add_test(NAME install.${name} COMMAND ${CMAKE_COMMAND}
    -D STEP=${name} -D SOURCE=${CMAKE_CURRENT_LIST_DIR} -D ROOT=${PROJECT_SOURCE_DIR} -D BUILD=${PROJECT_BINARY_DIR}
    -D WORK=${CMAKE_CURRENT_BINARY_DIR}/install -D LIBDIR=${CMAKE_INSTALL_LIBDIR}
    -D INCLUDEDIR=${CMAKE_INSTALL_INCLUDEDIR}
    -D GENERATOR=${CMAKE_GENERATOR} -D CXX=${CMAKE_CXX_COMPILER} -D CXX_FLAGS=${CMAKE_CXX_FLAGS}
    -D PKG_CONFIG=${OKTETT_PKG_CONFIG} -D OBJDUMP=${CMAKE_OBJDUMP} -D PROCESSOR=${CMAKE_SYSTEM_PROCESSOR} -P ${CMAKE_CURRENT_LIST_DIR}/run_install_test.cmake)
  # What is installed knows no folder of the build, but oneTBB may be in one (scripts/test --tsan).
  set_tests_properties(install.${name} PROPERTIES TIMEOUT 600
    ENVIRONMENT_MODIFICATION LD_LIBRARY_PATH=path_list_append:$<TARGET_FILE_DIR:TBB::tbb>)
endfunction()

include(GNUInstallDirs)
add_install_test(prefix)
set_tests_properties(install.prefix PROPERTIES FIXTURES_SETUP installed)
add_install_test(headers)
add_install_test(cmake_package)
set_tests_properties(install.headers install.cmake_package PROPERTIES FIXTURES_REQUIRED installed)
if(TARGET oktett_app)
  add_install_test(command)
  add_install_test(components)
  set_tests_properties(install.command PROPERTIES FIXTURES_REQUIRED installed)
endif()
if(OKTETT_PKG_CONFIG)
  add_install_test(pkg_config)
  set_tests_properties(install.pkg_config PROPERTIES FIXTURES_REQUIRED installed)
endif()
# Instrumented code is not inlined, so it has such functions, and is linked with nothing else.
if(CMAKE_OBJDUMP AND NOT sanitized)
  add_install_test(fused_client)
  set_tests_properties(install.fused_client PROPERTIES FIXTURES_REQUIRED installed)
endif()
add_install_test(subdirectory)
add_install_test(readme)
