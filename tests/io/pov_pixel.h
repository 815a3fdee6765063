#pragma once
/// \file What is seen in the middle of a scene in POV-Ray's language.

#include <string>

#include "io/image/texture.h"
#include "io/scene/pov_scene.h"
#include "io/scene/scene_file.h"
#include "render/picture/render.h"

namespace oktett::test {

/// The colour of a picture of one pixel.
inline Vec3f pixel_of(const std::string& path) {
  Scene scene = load_scene(path);
  scene.film.width = scene.film.height = 1, scene.integrator.samples = 1;
  const ImageTextures textures(scene.textures, scene.texture_places);
  RenderOptions options;
  options.textures = &textures;
  const Picture picture = render(scene, options).picture;
  Vec3f color;
  int k = 0;
  for (const char* channel : {"R", "G", "B"}) color[k++] = picture.find(channel)->values[0];
  return color;
}

}  // namespace oktett::test
