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
  target_include_directories(oktett_http SYSTEM PRIVATE ${OKTETT_HTTPLIB_INCLUDE})
  target_link_libraries(oktett_http PRIVATE ${OKTETT_HTTPLIB_LIBRARY} Threads::Threads)
  oktett_loaded_library(oktett_http own_library.cpp OKTETT_HTTP_LIBRARY)
endif()
