# The libraries that Oktett is built with, and the oldest version of each that it is built and tested with; newer ones may be
# of any major version. Some packages refuse a newer major version than the one that is asked for, so versions are compared
# here. Optional libraries are found where they are used: cmake/gltf.cmake, viewer.cmake, terminal.cmake, python.cmake.
macro(oktett_require package least)
  find_package(${package} REQUIRED ${ARGN})
  if(${package}_VERSION AND ${package}_VERSION VERSION_LESS ${least})
    message(FATAL_ERROR "Oktett needs ${package} ${least} or later, found ${${package}_VERSION}")
  endif()
endmacro()

find_package(Threads REQUIRED)
oktett_require(xsimd 8.1)       # lanes of all instruction sets: core/simd_native.h alone names it
oktett_require(TBB 2021.8)      # tasks
oktett_require(fmt 9.1)         # messages
oktett_require(yaml-cpp 0.7)    # scene files
oktett_require(PNG 1.6)         # pictures in 8 bits
oktett_require(ZLIB 1.2.13)     # packed meshes
oktett_require(OpenEXR 3.1.5)   # pictures in floats
oktett_require(OpenImageIO 2.4.7)  # textures and all other kinds of pictures
if(OKTETT_BUILD_APP)
  oktett_require(CLI11 2.1)     # the command line
endif()
if(OKTETT_BUILD_TESTS)
  oktett_require(GTest 1.12)
  oktett_require(rapidcheck 0)  # states no version
endif()
if(OKTETT_BUILD_BENCH)
  oktett_require(benchmark 1.7)
endif()

# Debian 12's OpenImageIO target names OpenCV's include directory, which only a package that it does not depend on creates;
# CMake refuses a target with a directory that does not exist.
get_target_property(oiio_includes OpenImageIO::OpenImageIO INTERFACE_INCLUDE_DIRECTORIES)
set(oiio_existing "")
foreach(directory IN LISTS oiio_includes)
  if(directory MATCHES "^\\$<" OR EXISTS "${directory}")
    list(APPEND oiio_existing "${directory}")
  endif()
endforeach()
set_target_properties(OpenImageIO::OpenImageIO PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${oiio_existing}")
