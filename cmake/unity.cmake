option(OKTETT_UNITY_BUILD "Compile several source files of a target at once" ON)

# Compiles the source files of a target in groups, each as if it were one file. Most files include far more than they hold, and a
# group reads that once. Two files of a group must not have helpers of the same name. Each file still includes what it uses; a
# build with OKTETT_UNITY_BUILD=OFF shows where one does not.
function(oktett_unity target)
  if(OKTETT_UNITY_BUILD)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
  endif()
endfunction()

# The same for the code of exact surfaces, five in a group, of which each is half includes: an edit of a surface then compiles its
# group. All other files of the target are compiled by themselves.
function(oktett_unity_surfaces target)
  if(NOT OKTETT_UNITY_BUILD)
    return()
  endif()
  set(n 0)
  foreach(source IN LISTS OKTETT_SURFACE_ISA_SOURCES)
    math(EXPR group "${n} / 5")
    math(EXPR n "${n} + 1")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP surfaces_${group})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
endfunction()
