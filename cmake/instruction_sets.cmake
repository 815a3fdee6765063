# The hot code is compiled once per instruction set, all else for the baseline, so one binary runs everywhere.

# Compiles the sources given once for each set, with OKTETT_ISA as its tag, and adds the objects to `target`. Code for the
# set is chosen at run time by core/isa_select.h.
function(oktett_compile_per_set target)
  oktett_compile_set(${target} scalar "${ARGN}" ScalarIsa -O2 -fno-tree-vectorize)
  if(NOT CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    return()
  endif()
  set(flags_sse42 Sse42Isa -msse4.2)
  set(flags_avx2 Avx2Isa -mavx2 -mfma -mbmi -mbmi2 -mlzcnt -mpopcnt -mf16c)
  set(flags_avx512 Avx512Isa -mavx512f -mavx512cd -mavx512dq -mavx512bw -mavx512vl -mavx2 -mfma -mbmi -mbmi2
    -mlzcnt -mpopcnt -mf16c -mprefer-vector-width=512)
  foreach(set IN LISTS OKTETT_INSTRUCTION_SETS)
    if(NOT set MATCHES "^(sse42|avx2|avx512)$")
      message(FATAL_ERROR "OKTETT_INSTRUCTION_SETS: unknown set '${set}'; known are sse42, avx2 and avx512")
    endif()
    oktett_compile_set(${target} ${set} "${ARGN}" ${flags_${set}})
  endforeach()
endfunction()

# One object library per set. Fused multiply-adds happen only where the code asks for them.
function(oktett_compile_set target set sources tag)
  # -O3 in every build type, so that no small function of the standard library survives as a call and is shared across
  # sets; instrumented builds, which run on the machine that made them, need not care.
  set(optimization -O3)
  if(CMAKE_CXX_FLAGS MATCHES "-fsanitize")
    set(optimization -O1)
  endif()
  # GCC 12 sees uninitialised variables in its own intrinsics (bug 105593).
  set(warnings "")
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    set(warnings -Wno-uninitialized -Wno-maybe-uninitialized)
  endif()
  set(code ${target}_${set})
  add_library(${code} OBJECT ${sources})
  target_compile_definitions(${code} PRIVATE OKTETT_ISA=${tag})
  target_compile_options(${code} PRIVATE -ffp-contract=off ${optimization} -g0 ${warnings} ${ARGN})
  oktett_target_warnings(${code})
  target_link_libraries(${code} PRIVATE oktett_internal)
  if(BUILD_SHARED_LIBS)
    set_target_properties(${code} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  endif()
  target_sources(${target} PRIVATE $<TARGET_OBJECTS:${code}>)
  string(TOUPPER ${set} upper)
  # Not for the code of a set itself: that must not instantiate the code of another one.
  target_compile_definitions(${target} PUBLIC $<BUILD_INTERFACE:OKTETT_WITH_${upper}>)
endfunction()
