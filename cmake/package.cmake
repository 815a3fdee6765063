# Debian packages by CPack: oktett (the command, its data and what reads images), liboktett-dev (the library) and
# python3-oktett. scripts/package builds them.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME oktett)
set(CPACK_PACKAGE_CONTACT "The Oktett authors <oktett@users.noreply.github.com>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL dev)
if(TARGET oktett_app)
  list(APPEND CPACK_COMPONENTS_ALL command)
endif()
if(OKTETT_BUILD_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
if(CMAKE_SYSTEM_PROCESSOR STREQUAL "aarch64")
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
endif()
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/package/compress_pages.cmake)
# Each description has its own first line.
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")
# Files belong to root, and folders may be entered by all, whoever builds the packages.
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

set(CPACK_DEBIAN_COMMAND_PACKAGE_NAME oktett)
set(CPACK_DEBIAN_COMMAND_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_COMMAND_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/cmake/package/triggers)
set(CPACK_COMPONENT_COMMAND_DESCRIPTION "ray tracer for triangle meshes and exact surfaces
Oktett traces rays in packets through one tree that holds large triangle
meshes and exact mathematical surfaces side by side: spheres, quadrics, tori,
polynomials, implicit functions, combinations of solids, height fields,
fractals and instances of all of them. Pictures and hits are the same bits
on every machine.")

set(CPACK_DEBIAN_DEV_PACKAGE_NAME liboktett-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS
  "oktett (= ${PROJECT_VERSION}), libtbb-dev, libfmt-dev, libyaml-cpp-dev, libpng-dev, libopenexr-dev, zlib1g-dev${OKTETT_DEB_GLTF}")
set(CPACK_COMPONENT_DEV_DESCRIPTION "ray tracing library - development files
Oktett is a C++20 library that builds trees over triangle meshes and exact
surfaces, traces batches of rays through them and renders pictures.
.
This package has the static library, its headers, and files for CMake and
pkg-config.")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-oktett)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA
  ${PROJECT_SOURCE_DIR}/cmake/package/python/postinst ${PROJECT_SOURCE_DIR}/cmake/package/python/prerm)
if(OKTETT_BUILD_PYTHON)
  # The modules are for one version of Python, that of the release. One of them uses the other.
  math(EXPR next_minor "${Python3_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "oktett (= ${PROJECT_VERSION}), python3-numpy, \
python3 (>= ${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}), python3 (<< ${Python3_VERSION_MAJOR}.${next_minor})")
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/python/oktett)
endif()
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "ray tracing of arrays of rays - Python 3
Oktett traces arrays of numpy through triangle meshes and exact surfaces, and
renders pictures to arrays. Adapters have the interfaces of Open3D's
RaycastingScene and of trimesh's RayMeshIntersector.")

# What Debian wants of each package.
configure_file(cmake/package/changelog ${PROJECT_BINARY_DIR}/package/changelog @ONLY)
execute_process(COMMAND gzip -9nf changelog WORKING_DIRECTORY ${PROJECT_BINARY_DIR}/package)
foreach(pair command:oktett dev:liboktett-dev python:python3-oktett)
  string(REGEX MATCH "(.*):(.*)" unused ${pair})
  install(FILES cmake/package/copyright ${PROJECT_BINARY_DIR}/package/changelog.gz
    DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/${CMAKE_MATCH_2} COMPONENT ${CMAKE_MATCH_1} EXCLUDE_FROM_ALL)
endforeach()
install(FILES cmake/package/lintian-overrides DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides RENAME oktett
  COMPONENT command EXCLUDE_FROM_ALL)
include(CPack)
