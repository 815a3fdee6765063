option(OKTETT_UNITY_BUILD "Compile several source files of a target at once" ON)

# Compiles the source files of a target in groups, each as if it were one file: a typical file includes fifty times as much as
# it holds, so a whole build takes two thirds of the time. Helpers with the same name in two files of a folder are an error
# then. A source file still includes what it uses; a build with OKTETT_UNITY_BUILD=OFF shows where one does not.
function(oktett_unity target)
  if(OKTETT_UNITY_BUILD)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
  endif()
endfunction()
