# Shared libraries that the command loads when it needs them, see app/own_library.cpp, because they bring others along. The
# file `user` gets the name of the library as the macro `definition`.
function(oktett_loaded_library target user definition)
  oktett_target_warnings(${target})
  target_compile_options(${target} PRIVATE -O1)
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR})
  set_target_properties(${target} PROPERTIES
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION} LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  add_dependencies(oktett_app ${target})
  set_property(SOURCE ${user} APPEND PROPERTY COMPILE_DEFINITIONS ${definition}="lib${target}.so.${PROJECT_VERSION}")
  install(TARGETS ${target} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} NAMELINK_SKIP COMPONENT command)
endfunction()
set_property(SOURCE own_library.cpp embree.cpp APPEND PROPERTY COMPILE_DEFINITIONS OKTETT_LIBRARIES_FROM_PROGRAMS="${oktett_libraries}")
