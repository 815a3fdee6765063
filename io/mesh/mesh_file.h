#pragma once
/// \file What is read from a mesh file of any format.

#include <string>
#include <vector>

#include "core/error.h"
#include "core/mesh.h"
#include "render/material.h"
#include "render/medium/medium.h"

namespace oktett {

/// Everything in a mesh file that can be rendered.
struct MeshFile {
  TriangleMesh mesh;  ///< polygons are triangulated; mesh.material_slots indexes `materials`
  /// Points and lines, as triangles without area: the corners of a point are a, a, a, those of a line a, b,
  /// b. Slots are those of `mesh`.
  TriangleMesh strokes;
  std::vector<Material> materials;       ///< in order of first use; empty if no face names a material
  std::vector<Texture> textures;         ///< what the materials' texture indices refer to
  std::vector<Medium> media;             ///< what Material::interior refers to
  std::vector<Location> texture_places;  ///< where each texture is named first
  std::vector<Location>
      material_places;            ///< where a file defines each material, if it has lines; may be shorter
  std::vector<Warning> warnings;  ///< what was skipped
};

/// The material of an image that a file names without one; of a face without an image if `texture` is kNoId.
inline Material image_material(const std::string& name, std::uint32_t texture) {
  Material m;
  m.name = name;
  if (texture != kNoId) m.color = {1, 1, 1}, m.diffuse = 1, m.color_texture = texture;
  return m;
}

}  // namespace oktett
