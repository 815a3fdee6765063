# Warnings for the project's own targets; never exported.
function(oktett_target_warnings target)
  target_compile_options(${target} PRIVATE
    -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Wcast-align -Wunused
    -Wno-sign-compare -Wno-ignored-attributes
    $<$<BOOL:${OKTETT_WERROR}>:-Werror>)
endfunction()
