# Headers of libraries that most files of the code of a set include, parsed once per set: reading them takes half of the time of
# a typical file. The project's own headers are left out, since editing one shall rebuild only what includes it.
# A source file still includes what it uses; a build with CMAKE_DISABLE_PRECOMPILE_HEADERS shows where one does not.
function(oktett_precompile target)
  if(CMAKE_DISABLE_PRECOMPILE_HEADERS)
    return()
  endif()
  target_precompile_headers(${target} PRIVATE
    <algorithm> <array> <cmath> <cstdint> <cstring> <filesystem> <functional> <limits> <map> <memory> <numeric> <optional>
    <span> <string> <string_view> <system_error> <utility> <variant> <vector> <xsimd/xsimd.hpp>)
  # From a precompiled <string> GCC 12 warns of copies in the library's own code that are too long (bug 105329).
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread)
    # ccache can tell what a precompiled header stands for with this (its manual, "Precompiled headers").
    target_compile_options(${target} PRIVATE -fpch-preprocess)
  elseif(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    target_compile_options(${target} PRIVATE "SHELL:-Xclang -fno-pch-timestamp")
  endif()
endfunction()
