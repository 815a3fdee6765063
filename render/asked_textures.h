#pragma once
/// \file Which images a picture needs.

#include <vector>

#include "render/scene.h"

namespace oktett {

/// Scene::textures, without the images that nothing in a picture of the scene's integrator asks for: they
/// need not be read. `data_layers`: the picture has normals and colours beside.
std::vector<Texture> asked_textures(const Scene& scene, bool data_layers);

}  // namespace oktett
