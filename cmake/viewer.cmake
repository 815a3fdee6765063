# The page of `oktett view`, which becomes a part of the command, and what serves it: a shared library that only this verb
# loads, because cpp-httplib brings several others along. Without cpp-httplib the verb says that there is no viewer.
file(GLOB page_files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/app/view/page/*)
set(page_source ${OKTETT_GENERATED}/app/view/page_files.cpp)
add_custom_command(OUTPUT ${page_source}
  COMMAND ${CMAKE_COMMAND} -DOUTPUT=${page_source} "-DFILES=${page_files}" -P ${PROJECT_SOURCE_DIR}/cmake/embed.cmake
  DEPENDS ${page_files} ${PROJECT_SOURCE_DIR}/cmake/embed.cmake VERBATIM)
target_sources(oktett_app PRIVATE ${page_source})

find_path(OKTETT_HTTPLIB_INCLUDE httplib.h)
find_library(OKTETT_HTTPLIB_LIBRARY cpp-httplib)
find_package(OpenSSL QUIET)
mark_as_advanced(OKTETT_HTTPLIB_INCLUDE OKTETT_HTTPLIB_LIBRARY)
if(OKTETT_HTTPLIB_INCLUDE AND OKTETT_HTTPLIB_LIBRARY AND OPENSSL_FOUND)
  add_library(oktett_http SHARED ${PROJECT_SOURCE_DIR}/app/view/httplib/server.cpp)
  target_compile_options(oktett_http PRIVATE -O1)
  target_include_directories(oktett_http PRIVATE ${PROJECT_SOURCE_DIR})
  target_include_directories(oktett_http SYSTEM PRIVATE ${OKTETT_HTTPLIB_INCLUDE})
  target_link_libraries(oktett_http PRIVATE ${OKTETT_HTTPLIB_LIBRARY} Threads::Threads)
  oktett_target_warnings(oktett_http)
  set_target_properties(oktett_http PROPERTIES
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION} LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  add_dependencies(oktett_app oktett_http)
  set_property(SOURCE view/http.cpp APPEND PROPERTY COMPILE_DEFINITIONS
    OKTETT_HTTP_LIBRARY="liboktett_http.so.${PROJECT_VERSION}" OKTETT_LIBRARIES_FROM_PROGRAMS="${oktett_libraries}")
  install(TARGETS oktett_http LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} NAMELINK_SKIP COMPONENT command)
endif()
