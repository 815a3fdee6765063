# The public headers, <oktett/NAME.h>. They lie in the folders of their layers like all others; this list says which are
# public. Each is copied to the build tree's include/oktett, from where it is installed, with `#include "folder/name.h"`
# turned into `#include <oktett/name.h>`. A public header may include public headers and the standard library only.
set(OKTETT_PUBLIC_HEADERS
  core/platform.h core/noise_generator.h core/vec3.h core/box.h core/transform.h core/soa.h core/mesh_attributes.h core/mesh.h core/ray.h core/isa.h core/error.h
  core/surface_interaction.h
  kernels/closed/shape_data.h kernels/exact/polynomial_expression.h kernels/roots/root_method.h
  kernels/heights/make_height_grid.h
  accel/accel.h accel/dynamic_accel.h accel/trace_scene.h accel/point_shapes.h accel/interaction_block.h accel/point_query.h
  render/scene.h render/material.h render/pattern.h render/pattern_kinds.h render/warp.h render/medium/medium.h render/medium/density_grid.h render/bsdf/principled_parameters.h render/light/environment_picture.h
  render/light/light_profile.h render/light/light_fade.h render/fog.h render/rainbow.h
  render/sampling/filter_kind.h render/tone.h render/motion.h render/camera.h render/picture.h render/render_options.h render/picture/render.h render/texture_sampler.h
  io/scene/scene_file.h io/gltf/gltf_options.h io/mesh/mesh_file.h io/mesh/load/load_mesh.h io/obj/obj.h io/image/image.h io/image/metadata.h io/image/texture.h io/image/heights.h)
# What describes the exact surfaces.
file(GLOB data_headers RELATIVE ${PROJECT_SOURCE_DIR} CONFIGURE_DEPENDS core/description.h kernels/*/*_data.h)
list(APPEND OKTETT_PUBLIC_HEADERS kernels/exact_form.h kernels/exact/normal_method.h ${data_headers})
list(REMOVE_DUPLICATES OKTETT_PUBLIC_HEADERS)

set(OKTETT_PUBLIC_INCLUDE_DIR ${PROJECT_BINARY_DIR}/include)

# Writes `text` to `<oktett/NAME>` if that differs, so that nobody compiles again for nothing.
function(oktett_write_public_header name text)
  set(file ${OKTETT_PUBLIC_INCLUDE_DIR}/oktett/${name})
  if(EXISTS ${file})
    file(READ ${file} present)
    if(present STREQUAL text)
      return()
    endif()
  endif()
  file(WRITE ${file} "${text}")
endfunction()

# Writes all public headers and <oktett/oktett.h>, which includes them all.
function(oktett_write_public_headers)
  set(names "")
  set(umbrella "#pragma once\n/// \\file All public headers of Oktett.\n\n")
  foreach(header IN LISTS OKTETT_PUBLIC_HEADERS)
    set(source ${PROJECT_SOURCE_DIR}/${header})
    if(NOT EXISTS ${source} AND OKTETT_GENERATED)
      set(source ${OKTETT_GENERATED}/${header})
    endif()
    set_property(DIRECTORY ${PROJECT_SOURCE_DIR} APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${source})
    get_filename_component(name ${header} NAME)
    if(name IN_LIST names OR name STREQUAL "oktett.h")
      message(FATAL_ERROR "${header}: there is another public header of the name ${name}")
    endif()
    list(APPEND names ${name})
    string(APPEND umbrella "#include <oktett/${name}>\n")

    file(READ ${source} text)
    string(REGEX MATCHALL "#include \"[^\"]*\"" includes "${text}")
    foreach(include IN LISTS includes)
      string(REGEX REPLACE "#include \"(.*)\"" "\\1" included "${include}")
      if(NOT included IN_LIST OKTETT_PUBLIC_HEADERS)
        message(FATAL_ERROR "${header} is a public header and includes ${included}, which is none: "
          "see cmake/public_headers.cmake")
      endif()
      get_filename_component(included_name ${included} NAME)
      string(REPLACE "${include}" "#include <oktett/${included_name}>" text "${text}")
    endforeach()
    oktett_write_public_header(${name} "${text}")
  endforeach()
  oktett_write_public_header(version.h "#pragma once
/// \\file The version of Oktett that a program is compiled with.

#define OKTETT_VERSION_MAJOR ${PROJECT_VERSION_MAJOR}
#define OKTETT_VERSION_MINOR ${PROJECT_VERSION_MINOR}
#define OKTETT_VERSION_PATCH ${PROJECT_VERSION_PATCH}
")
  string(APPEND umbrella "#include <oktett/version.h>\n")
  oktett_write_public_header(oktett.h "${umbrella}")

  # What is no longer public must not be found, either.
  file(GLOB present RELATIVE ${OKTETT_PUBLIC_INCLUDE_DIR}/oktett ${OKTETT_PUBLIC_INCLUDE_DIR}/oktett/*)
  list(REMOVE_ITEM present ${names} version.h oktett.h)
  foreach(name IN LISTS present)
    file(REMOVE ${OKTETT_PUBLIC_INCLUDE_DIR}/oktett/${name})
  endforeach()
endfunction()

oktett_write_public_headers()
