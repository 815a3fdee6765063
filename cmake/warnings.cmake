# Warnings for the project's own targets; never exported.
function(oktett_target_warnings target)
  target_compile_options(${target} PRIVATE
    -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Wcast-align -Wunused
    -Wno-sign-compare -Wno-ignored-attributes
    # GCC 12 warns about std::string's own concatenation (bug 105651), GCC 13 and later of references to what outlives a call
    # that also takes a temporary, as plane_of(picture, "R" + name).
    $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
    $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_GREATER_EQUAL:$<CXX_COMPILER_VERSION>,13>>:-Wno-dangling-reference>
    $<$<BOOL:${OKTETT_WERROR}>:-Werror>)
endfunction()
