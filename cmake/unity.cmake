option(OKTETT_UNITY_BUILD "Compile several source files of a target at once" ON)

# Compiles the source files of a target in groups, each as if it were one file. Most files include far more than they hold, and a
# group reads that once. Two files of a group must not have helpers of the same name. Each file still includes what it uses; a
# build with OKTETT_UNITY_BUILD=OFF shows where one does not.
function(oktett_unity target)
  if(OKTETT_UNITY_BUILD)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
  endif()
endfunction()
