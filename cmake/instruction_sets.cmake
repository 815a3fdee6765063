# The hot code is compiled once per instruction set, all else for the baseline, so one binary runs everywhere.

# The widest set that this machine has, in `result`; all sets where the machine does not tell.
function(oktett_native_set result)
  set(${result} sse42 avx2 avx512 PARENT_SCOPE)
  if(NOT EXISTS /proc/cpuinfo)
    return()
  endif()
  file(STRINGS /proc/cpuinfo line REGEX "^flags" LIMIT_COUNT 1)
  string(REGEX MATCHALL "[a-z0-9_]+" flags "${line}")
  set(needs_sse42 sse4_2)
  set(needs_avx2 avx2 fma bmi1 bmi2 popcnt)
  set(needs_avx512 ${needs_avx2} avx512f avx512cd avx512dq avx512bw avx512vl)
  set(widest "")
  foreach(set sse42 avx2 avx512)
    set(missing ${needs_${set}})
    list(REMOVE_ITEM missing ${flags})
    if(NOT missing)
      set(widest ${set})
    endif()
  endforeach()
  set(${result} ${widest} PARENT_SCOPE)
endfunction()

# OKTETT_SETS: what OKTETT_INSTRUCTION_SETS asks for, as a list.
set(known_sets "")
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  set(known_sets sse42 avx2 avx512)
elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "aarch64|arm64")
  set(known_sets neon)
endif()
if(OKTETT_INSTRUCTION_SETS STREQUAL "native" AND "avx2" IN_LIST known_sets)
  oktett_native_set(OKTETT_SETS)
elseif(OKTETT_INSTRUCTION_SETS MATCHES "^(all|native)$")
  set(OKTETT_SETS ${known_sets})
else()
  set(OKTETT_SETS ${OKTETT_INSTRUCTION_SETS})
endif()
set(oktett_with "")
foreach(set IN LISTS OKTETT_SETS)
  if(NOT set IN_LIST known_sets)
    list(JOIN known_sets ", " names)
    message(FATAL_ERROR "OKTETT_INSTRUCTION_SETS: unknown set '${set}'; this architecture has: ${names}; or all, or native, alone")
  endif()
  string(TOUPPER OKTETT_WITH_${set} definition)
  list(APPEND oktett_with ${definition})
endforeach()
# Only these files depend on the list, so that a build folder can get more sets without compiling anything twice.
set_source_files_properties(
  ${PROJECT_SOURCE_DIR}/core/isa.cpp ${PROJECT_SOURCE_DIR}/core/isa_tables.cpp ${PROJECT_SOURCE_DIR}/accel/isa_tables.cpp
  ${PROJECT_SOURCE_DIR}/render/isa_tables.cpp ${PROJECT_SOURCE_DIR}/verify/isa_tables.cpp
  PROPERTIES COMPILE_DEFINITIONS "${oktett_with}")

# Compiles the sources given once for each set, with OKTETT_ISA as its tag, and adds the objects to `target`. Code for the
# set is chosen at run time by core/isa_select.h.
function(oktett_compile_per_set target)
  oktett_compile_set(${target} scalar "${ARGN}" ScalarIsa -O2 -fno-tree-vectorize)
  set(flags_neon NeonIsa)
  set(flags_sse42 Sse42Isa -msse4.2)
  set(flags_avx2 Avx2Isa -mavx2 -mfma -mbmi -mbmi2 -mlzcnt -mpopcnt -mf16c)
  set(flags_avx512 Avx512Isa -mavx512f -mavx512cd -mavx512dq -mavx512bw -mavx512vl -mavx2 -mfma -mbmi -mbmi2
    -mlzcnt -mpopcnt -mf16c -mprefer-vector-width=512)
  foreach(set IN LISTS OKTETT_SETS)
    oktett_compile_set(${target} ${set} "${ARGN}" ${flags_${set}})
  endforeach()
endfunction()

# One object library per set.
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
  # Hot functions begin with a cache line: their speed does not depend on what the linker puts before them.
  target_compile_options(${code} PRIVATE
    ${OKTETT_PIC_OPTIONS} ${optimization} -falign-functions=64 -g0 ${warnings} ${ARGN})
  oktett_target_warnings(${code})
  oktett_precompile(${code})
  oktett_unity_surfaces(${code})
  target_link_libraries(${code} PRIVATE oktett_internal)
  set_target_properties(${code} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_sources(${target} PRIVATE $<TARGET_OBJECTS:${code}>)
endfunction()
