# Shared libraries that io/ loads when it needs them, because they bring others along, and finds from where the program or itself
# lies (io/library/loaded_library.h). Each shows one symbol and has its own copy of the little that both sides need. The file
# `user` gets the name of the library as the macro `definition`.
function(oktett_io_library target user definition)
  add_library(${target} SHARED ${ARGN})
  target_compile_features(${target} PRIVATE cxx_std_20)
  oktett_target_warnings(${target})
  oktett_unity(${target})
  target_link_libraries(${target} PRIVATE oktett_internal fmt::fmt)
  if(NOT CMAKE_CXX_FLAGS MATCHES "-fsanitize")
    target_link_options(${target} PRIVATE LINKER:--no-undefined)
  endif()
  set_target_properties(${target} PROPERTIES
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION} LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  add_dependencies(oktett ${target})
  set_property(SOURCE ${user} APPEND PROPERTY COMPILE_DEFINITIONS ${definition}="lib${target}.so.${PROJECT_VERSION}")
  set_property(GLOBAL APPEND PROPERTY OKTETT_IO_LIBRARIES ${target})
endfunction()

file(RELATIVE_PATH oktett_libraries ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR})
set(oktett_loader io/library/loaded_library.cpp)
set_property(SOURCE ${oktett_loader} APPEND PROPERTY COMPILE_DEFINITIONS OKTETT_LIBRARIES_FROM_PROGRAMS="${oktett_libraries}")
if(BUILD_SHARED_LIBS)
  set_property(SOURCE ${oktett_loader} APPEND PROPERTY COMPILE_DEFINITIONS OKTETT_SHARED)
endif()
if(NOT PROJECT_IS_TOP_LEVEL)
  # The programs of another project may be built anywhere.
  set_property(SOURCE ${oktett_loader} APPEND PROPERTY COMPILE_DEFINITIONS OKTETT_BUILT_LIBRARIES="${PROJECT_BINARY_DIR}/lib")
endif()

# Images of all kinds: OpenImageIO, see io/image/library.h.
file(GLOB OKTETT_IMAGE_SOURCES CONFIGURE_DEPENDS io/image/oiio/*.cpp)
oktett_io_library(oktett_images io/image/library.cpp OKTETT_IMAGE_LIBRARY
  ${OKTETT_IMAGE_SOURCES} core/error.cpp core/math.cpp core/pages.cpp io/image/color.cpp)
target_link_libraries(oktett_images PRIVATE OpenImageIO::OpenImageIO)

include(cmake/volumes.cmake)
include(cmake/threemf.cmake)
include(cmake/fonts.cmake)
