# The library oktett::oktett. Sources are found by folder: a new file needs no edit here.
file(GLOB OKTETT_SOURCES CONFIGURE_DEPENDS
  core/*.cpp kernels/*.cpp kernels/*/*.cpp accel/*.cpp render/*.cpp io/*.cpp)

# One translation unit per instruction set holds every instantiation of the hot code for it; the rest of the library is
# compiled for the baseline, so one binary runs everywhere. Fused multiply-adds happen only where the code asks for them.
file(GLOB OKTETT_ISA_SOURCES CONFIGURE_DEPENDS accel/isa/*.cpp)

add_library(oktett ${OKTETT_SOURCES} ${OKTETT_ISA_SOURCES})
add_library(oktett::oktett ALIAS oktett)
target_compile_features(oktett PUBLIC cxx_std_20)
target_compile_options(oktett PRIVATE -ffp-contract=off)
oktett_target_warnings(oktett)
set_target_properties(oktett PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR})
target_include_directories(oktett PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
target_compile_definitions(oktett PRIVATE OKTETT_VERSION="${PROJECT_VERSION}")
target_link_libraries(oktett
  PUBLIC TBB::tbb Threads::Threads
  PRIVATE OpenImageIO::OpenImageIO yaml-cpp fmt::fmt)
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
function(oktett_isa_flags file)
  set_source_files_properties(${PROJECT_SOURCE_DIR}/accel/isa/${file} PROPERTIES
    COMPILE_OPTIONS "${oktett_isa_optimization};-g0;${oktett_isa_warnings};${ARGN}")
endfunction()
oktett_isa_flags(scalar.cpp -O2 -fno-tree-vectorize)
oktett_isa_flags(exact_scalar.cpp -O2 -fno-tree-vectorize)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  # Without its flags a unit is empty, and the set counts as absent.
  set(oktett_avx2 -mavx2 -mfma -mbmi -mbmi2 -mlzcnt -mpopcnt -mf16c)
  set(oktett_avx512 -mavx512f -mavx512cd -mavx512dq -mavx512bw -mavx512vl ${oktett_avx2} -mprefer-vector-width=512)
  set(oktett_sse42 -msse4.2)
  foreach(set IN LISTS OKTETT_INSTRUCTION_SETS)
    if(NOT set MATCHES "^(sse42|avx2|avx512)$")
      message(FATAL_ERROR "OKTETT_INSTRUCTION_SETS: unknown set '${set}'; known are sse42, avx2 and avx512")
    endif()
    oktett_isa_flags(${set}.cpp ${oktett_${set}})
    oktett_isa_flags(exact_${set}.cpp ${oktett_${set}})
    string(TOUPPER ${set} upper)
    target_compile_definitions(oktett PRIVATE OKTETT_WITH_${upper})
  endforeach()
endif()
