#include "app/scene_loading.h"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "app/command_line.h"
#include "app/text.h"
#include "app/unused_options.h"
#include "core/error.h"
#include "io/scene/scene_file.h"
#include "render/look/default_look.h"

namespace oktett {

/// The scene with what was asked for, where options may still contradict each other.
static Scene load_overridden(const RenderArguments& arguments) {
  // A mistyped option should not cost the time to read a large scene.
  Scene none;
  override_scene(arguments, none);
  const std::optional<Look> look = look_of(arguments);
  const std::optional<Vec3d> up = up_of(arguments);
  const Viewpoint viewpoint = viewpoint_of(arguments);
  std::optional<IntegratorKind> integrator;
  if (is_given(arguments.settings, "--integrator")) integrator = none.integrator.kind;
  PovOptions pov;
  pov.files = arguments.pov_files;
  if (!arguments.quiet) pov.said = say_as_is;
  if (is_given(arguments.settings, "--size"))
    pov.film.width = none.film.width, pov.film.height = none.film.height;
  Scene scene = load_scene(arguments.scene, parse_definitions(arguments.definitions), integrator,
                           gltf_options(arguments.gltf), pov);
  override_scene(arguments, scene);
  if (!look && !up) return scene;
  if (!is_mesh_alone(scene)) {
    if (look && scene.camera_given && !scene.lights_given) light_as_look(scene);
    for (const auto& [option, value] :
         {std::pair{"--look", &arguments.look}, {"--up", &arguments.up}, {"--view", &arguments.viewpoint}})
      if (!value->empty())
        throw Error(
            fmt::format("{} is for meshes given alone; {} has a camera, lights or instances of its own",
                        option, arguments.scene));
    return scene;
  }
  if (up) scene.camera.up = *up;
  if (!look) return scene;
  apply_look(scene, *look, viewpoint);
  // The look chooses the number of samples.
  override_scene(arguments, scene);
  return scene;
}

Scene load_as_asked(const RenderArguments& arguments) {
  Scene scene = load_overridden(arguments);
  check_light_options(arguments, scene);
  return scene;
}

ImageMetadata first_metadata(const std::string& command_line, const RenderArguments& arguments,
                             const Scene& scene) {
  ImageMetadata metadata;
  metadata.software = program_version();
  metadata.command_line = command_line;
  metadata.scene = arguments.scene;
  metadata.samples = scene.integrator.samples;
  metadata.origin = scene.origin;
  return metadata;
}

}  // namespace oktett
