# The library oktett::oktett. Sources are found by folder: a new file needs no edit here.

# What the project's own targets are compiled with. Programs that use the library know the public headers alone.
set(OKTETT_GENERATED ${PROJECT_BINARY_DIR}/generated)
include(cmake/surfaces.cmake)
add_library(oktett_internal INTERFACE)
target_include_directories(oktett_internal INTERFACE ${PROJECT_SOURCE_DIR} ${OKTETT_GENERATED})
target_include_directories(oktett_internal SYSTEM INTERFACE ${xsimd_INCLUDE_DIRS})
target_link_libraries(oktett_internal INTERFACE TBB::tbb Threads::Threads)

file(GLOB_RECURSE OKTETT_SOURCES CONFIGURE_DEPENDS core/*.cpp kernels/*.cpp accel/*.cpp render/*.cpp)
list(FILTER OKTETT_SOURCES EXCLUDE REGEX "/isa/")
file(GLOB_RECURSE OKTETT_IO_SOURCES CONFIGURE_DEPENDS io/*.cpp)
# These belong to libraries of their own: cmake/io_libraries.cmake.
list(FILTER OKTETT_IO_SOURCES EXCLUDE REGEX "/io/(image/oiio|volume/openvdb|threemf/lib3mf|font/freetype)/")
# These include what no others do: cmake/gltf.cmake.
file(GLOB OKTETT_GLTF_SOURCES CONFIGURE_DEPENDS io/gltf/*.cpp)
list(REMOVE_ITEM OKTETT_IO_SOURCES ${OKTETT_GLTF_SOURCES})

# The static library, too, may become part of a shared one, such as the Python module. Its functions are never replaced by
# others of the same name, so they may be inlined as in a program.
set(OKTETT_PIC_OPTIONS -fno-semantic-interposition)
# The objects of io/ are compiled apart from the others, so that who uses nothing of io/ links nothing that it needs.
add_library(oktett_io OBJECT ${OKTETT_IO_SOURCES})
add_library(oktett_gltf OBJECT ${OKTETT_GLTF_SOURCES})
add_library(oktett ${OKTETT_SOURCES} ${OKTETT_SURFACE_SOURCES} $<TARGET_OBJECTS:oktett_io> $<TARGET_OBJECTS:oktett_gltf>)
add_library(oktett::oktett ALIAS oktett)
foreach(target oktett oktett_io oktett_gltf)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE ${OKTETT_PIC_OPTIONS})
  target_compile_definitions(${target} PRIVATE OKTETT_VERSION="${PROJECT_VERSION}")
  target_link_libraries(${target}
    PRIVATE $<BUILD_INTERFACE:oktett_internal> TBB::tbb Threads::Threads yaml-cpp fmt::fmt PNG::PNG ZLIB::ZLIB OpenEXR::OpenEXR
    ${OKTETT_GLTF_LIBRARIES} ${CMAKE_DL_LIBS})
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  oktett_target_warnings(${target})
  oktett_unity(${target})
endforeach()
set_target_properties(oktett PROPERTIES
  VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib)
include(cmake/public_headers.cmake)
target_include_directories(oktett PUBLIC $<BUILD_INTERFACE:${OKTETT_PUBLIC_INCLUDE_DIR}>)

target_compile_definitions(oktett_gltf PRIVATE ${OKTETT_GLTF_DEFINITIONS})
target_compile_options(oktett_gltf PRIVATE ${OKTETT_GLTF_INCLUDES})
# Adds the implementation of tinygltf by a macro, which has no effect after another file has included tinygltf.
set_source_files_properties(${PROJECT_SOURCE_DIR}/io/gltf/tiny.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)

# Holds a copy of the scalar traversal: compiled as that is. GCC 12 warns of lanes that a mask leaves out.
set_source_files_properties(${PROJECT_SOURCE_DIR}/accel/traverse/trace_counts.cpp
  PROPERTIES COMPILE_OPTIONS "-O2;-fno-tree-vectorize;$<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>")
include(cmake/instruction_sets.cmake)
file(GLOB OKTETT_ISA_SOURCES CONFIGURE_DEPENDS core/isa/*.cpp accel/isa/*.cpp render/isa/*.cpp)
oktett_compile_per_set(oktett ${OKTETT_ISA_SOURCES} ${OKTETT_SURFACE_ISA_SOURCES})

include(cmake/io_libraries.cmake)

# Oracles, cases and checks: `oktett verify`, the tests and the benchmarks link them.
if(OKTETT_BUILD_APP OR OKTETT_BUILD_TESTS OR OKTETT_BUILD_BENCH)
  file(GLOB_RECURSE OKTETT_VERIFY_SOURCES CONFIGURE_DEPENDS verify/*.cpp)
  list(FILTER OKTETT_VERIFY_SOURCES EXCLUDE REGEX "/isa/")
  file(GLOB OKTETT_VERIFY_ISA_SOURCES CONFIGURE_DEPENDS verify/isa/*.cpp)
  add_library(oktett_verify STATIC ${OKTETT_VERIFY_SOURCES})
  target_link_libraries(oktett_verify PUBLIC oktett::oktett oktett_internal fmt::fmt)
  oktett_target_warnings(oktett_verify)
  oktett_unity(oktett_verify)
  oktett_compile_per_set(oktett_verify ${OKTETT_VERIFY_ISA_SOURCES})
endif()
