# Warnings for the project's own targets; never exported. GCC 12 sees overlapping copies in its own std::string (bug 105651).
function(oktett_target_warnings target)
  target_compile_options(${target} PRIVATE
    -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Wcast-align -Wunused
    -Wno-sign-compare -Wno-ignored-attributes
    $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-restrict>
    # GCC 12 warns about std::string's own concatenation (bug 105651).
    $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
    $<$<BOOL:${OKTETT_WERROR}>:-Werror>)
endfunction()
