# The library oktett::oktett. Sources are found by folder: a new file needs no edit here.
file(GLOB OKTETT_SOURCES CONFIGURE_DEPENDS
  core/*.cpp kernels/*.cpp kernels/*/*.cpp accel/*.cpp render/*.cpp io/*.cpp)

# The hot code is compiled once per instruction set, the rest of the library for the baseline, so one binary runs everywhere.
file(GLOB OKTETT_ISA_SOURCES CONFIGURE_DEPENDS accel/isa/*.cpp)

add_library(oktett ${OKTETT_SOURCES})
add_library(oktett::oktett ALIAS oktett)
target_compile_features(oktett PUBLIC cxx_std_20)
target_compile_options(oktett PRIVATE -ffp-contract=off)
oktett_target_warnings(oktett)
set_target_properties(oktett PROPERTIES
  VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR} LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib)
target_include_directories(oktett PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
target_compile_definitions(oktett PRIVATE OKTETT_VERSION="${PROJECT_VERSION}")
target_link_libraries(oktett
  PUBLIC TBB::tbb Threads::Threads
  PRIVATE yaml-cpp fmt::fmt ${CMAKE_DL_LIBS})
target_include_directories(oktett SYSTEM PUBLIC $<BUILD_INTERFACE:${xsimd_INCLUDE_DIRS}>)

# -O3 in every build type, so that no small function of the standard library survives as a call and is shared across sets;
# instrumented builds, which run on the machine that made them, need not care.
set(oktett_isa_optimization -O3)
if(CMAKE_CXX_FLAGS MATCHES "-fsanitize")
  set(oktett_isa_optimization -O1)
endif()
# GCC 12 sees uninitialised variables in its own intrinsics (bug 105593).
set(oktett_isa_warnings "")
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  set(oktett_isa_warnings -Wno-uninitialized -Wno-maybe-uninitialized)
endif()
# Loops over columns become vector code only where nobody asks for errno and traps; the values are the same.
set_source_files_properties(${PROJECT_SOURCE_DIR}/accel/surfaces.cpp ${PROJECT_SOURCE_DIR}/render/whitted_block.cpp PROPERTIES
  COMPILE_OPTIONS "-O3;-fno-math-errno;-fno-trapping-math")
# One object library per set. Fused multiply-adds happen only where the code asks for them.
function(oktett_isa_code set tag)
  set(code oktett_${set})
  add_library(${code} OBJECT ${OKTETT_ISA_SOURCES})
  target_compile_definitions(${code} PRIVATE OKTETT_ISA=${tag})
  target_compile_options(${code} PRIVATE -ffp-contract=off ${oktett_isa_optimization} -g0 ${oktett_isa_warnings} ${ARGN})
  oktett_target_warnings(${code})
  target_include_directories(${code} PRIVATE ${PROJECT_SOURCE_DIR})
  target_include_directories(${code} SYSTEM PRIVATE ${xsimd_INCLUDE_DIRS})
  target_link_libraries(${code} PRIVATE TBB::tbb)
  if(BUILD_SHARED_LIBS)
    set_target_properties(${code} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  endif()
  target_sources(oktett PRIVATE $<TARGET_OBJECTS:${code}>)
  string(TOUPPER ${set} upper)
  target_compile_definitions(oktett PRIVATE OKTETT_WITH_${upper})
endfunction()
oktett_isa_code(scalar ScalarIsa -O2 -fno-tree-vectorize)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  set(oktett_flags_sse42 Sse42Isa -msse4.2)
  set(oktett_flags_avx2 Avx2Isa -mavx2 -mfma -mbmi -mbmi2 -mlzcnt -mpopcnt -mf16c)
  set(oktett_flags_avx512 Avx512Isa -mavx512f -mavx512cd -mavx512dq -mavx512bw -mavx512vl -mavx2 -mfma -mbmi -mbmi2
    -mlzcnt -mpopcnt -mf16c -mprefer-vector-width=512)
  foreach(set IN LISTS OKTETT_INSTRUCTION_SETS)
    if(NOT set MATCHES "^(sse42|avx2|avx512)$")
      message(FATAL_ERROR "OKTETT_INSTRUCTION_SETS: unknown set '${set}'; known are sse42, avx2 and avx512")
    endif()
    oktett_isa_code(${set} ${oktett_flags_${set}})
  endforeach()
endif()

# What uses OpenImageIO, see io/image_library.h: a shared library that oktett loads when it is needed, and finds from where
# the program or itself lies. It shows one symbol and has its own copy of the little that both need.
file(GLOB OKTETT_IMAGE_SOURCES CONFIGURE_DEPENDS io/oiio/*.cpp)
add_library(oktett_images SHARED ${OKTETT_IMAGE_SOURCES} core/error.cpp io/image_color.cpp)
target_compile_features(oktett_images PRIVATE cxx_std_20)
target_compile_options(oktett_images PRIVATE -ffp-contract=off)
oktett_target_warnings(oktett_images)
target_include_directories(oktett_images PRIVATE ${PROJECT_SOURCE_DIR})
target_include_directories(oktett_images SYSTEM PRIVATE ${xsimd_INCLUDE_DIRS})
target_link_libraries(oktett_images PRIVATE OpenImageIO::OpenImageIO TBB::tbb fmt::fmt Threads::Threads)
if(NOT CMAKE_CXX_FLAGS MATCHES "-fsanitize")
  target_link_options(oktett_images PRIVATE LINKER:--no-undefined)
endif()
set_target_properties(oktett_images PROPERTIES
  VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION} LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib
  CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
add_dependencies(oktett oktett_images)
file(RELATIVE_PATH oktett_libraries ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR})
set_property(SOURCE io/image_library.cpp APPEND PROPERTY COMPILE_DEFINITIONS
  OKTETT_IMAGE_LIBRARY="liboktett_images.so.${PROJECT_VERSION}" OKTETT_LIBRARIES_FROM_PROGRAMS="${oktett_libraries}")
if(BUILD_SHARED_LIBS)
  set_property(SOURCE io/image_library.cpp APPEND PROPERTY COMPILE_DEFINITIONS OKTETT_SHARED)
endif()
if(NOT PROJECT_IS_TOP_LEVEL)
  # The programs of another project may be built anywhere.
  set_property(SOURCE io/image_library.cpp APPEND PROPERTY COMPILE_DEFINITIONS
    OKTETT_BUILT_LIBRARIES="${PROJECT_BINARY_DIR}/lib")
endif()
