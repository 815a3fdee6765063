# What reads 3MF files, see io/threemf/threemf.h: a shared library that is loaded with the first such file. lib3mf has another
# interface from version 2 on.
option(OKTETT_3MF "Read 3MF files, if lib3mf 1.8 and libzip are found" ON)
if(OKTETT_3MF)
  find_path(OKTETT_LIB3MF_INCLUDE Model/COM/NMR_DLLInterfaces.h PATH_SUFFIXES lib3mf)
  find_library(OKTETT_LIB3MF_LIBRARY 3MF)
  find_path(OKTETT_LIBZIP_INCLUDE zip.h)
  find_library(OKTETT_LIBZIP_LIBRARY zip)
  mark_as_advanced(OKTETT_LIB3MF_INCLUDE OKTETT_LIB3MF_LIBRARY OKTETT_LIBZIP_INCLUDE OKTETT_LIBZIP_LIBRARY)
  if(OKTETT_LIB3MF_INCLUDE AND OKTETT_LIB3MF_LIBRARY AND OKTETT_LIBZIP_INCLUDE AND OKTETT_LIBZIP_LIBRARY)
    add_library(oktett_lib3mf INTERFACE)
    target_include_directories(oktett_lib3mf SYSTEM INTERFACE ${OKTETT_LIB3MF_INCLUDE} ${OKTETT_LIBZIP_INCLUDE})
    target_link_libraries(oktett_lib3mf INTERFACE ${OKTETT_LIB3MF_LIBRARY} ${OKTETT_LIBZIP_LIBRARY})
    file(GLOB OKTETT_3MF_SOURCES CONFIGURE_DEPENDS io/threemf/lib3mf/*.cpp)
    oktett_io_library(oktett_threemf io/threemf/threemf.cpp OKTETT_THREEMF_LIBRARY
      ${OKTETT_3MF_SOURCES} core/error.cpp core/math.cpp core/pages.cpp core/transform.cpp)
    target_link_libraries(oktett_threemf PRIVATE oktett_lib3mf)
  endif()
endif()
