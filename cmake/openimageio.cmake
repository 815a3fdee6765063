# Debian 12's OpenImageIO target names OpenCV's include directory, which only a package that it does not depend on creates;
# CMake refuses a target with a directory that does not exist.
find_package(OpenImageIO REQUIRED)
get_target_property(oiio_includes OpenImageIO::OpenImageIO INTERFACE_INCLUDE_DIRECTORIES)
set(oiio_existing "")
foreach(directory IN LISTS oiio_includes)
  if(directory MATCHES "^\\$<" OR EXISTS "${directory}")
    list(APPEND oiio_existing "${directory}")
  endif()
endforeach()
set_target_properties(OpenImageIO::OpenImageIO PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${oiio_existing}")
