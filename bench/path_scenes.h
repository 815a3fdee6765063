#pragma once
/// \file Mesh scenes for path tracers, described for Oktett, for Blender's Cycles and for Embree's
/// pathtracer.

#include <string>
#include <vector>

#include "core/mesh.h"
#include "render/scene.h"

namespace oktett::bench {

/// What the surfaces of a scene are made of. All programs have these by the same equations.
struct PathMaterial {
  enum class Kind { diffuse, metal, glass, lamp };
  std::string name;
  Kind kind = Kind::diffuse;
  Color color{0.8f, 0.8f, 0.8f};  ///< albedo; of a lamp the radiance of both sides
  float roughness = 0;            ///< of metal, in GGX's parametrization by the root of the width
  float ior = 1.5f;               ///< of glass
  std::uint32_t texture = 0;      ///< edge in pixels of the picture that multiplies the colour; 0: none
};

/// One mesh whose material slots are `materials`, under lamps of the mesh or light from all around.
struct PathScene {
  std::string name;
  TriangleMesh mesh;
  std::vector<PathMaterial> materials;
  Camera camera;
  std::uint32_t depth = 8;  ///< bounces after the camera ray
  Color background{0, 0, 0};
  std::shared_ptr<const EnvironmentPicture> environment;  ///< may be null
};

/// The five scenes, with `model` in them: its box is moved and scaled to fit.
std::vector<PathScene> path_scenes(const TriangleMesh& model);

/// Ten hills of a million triangles each, every one with a picture of 4096 x 4096 pixels of its own.
PathScene textured_scene();

/// The pictures of its materials are those that write_path_scene has written to `directory`.
Scene oktett_scene(const PathScene& scene, std::uint32_t width, std::uint32_t height,
                   const std::string& directory);

/// Writes scene.json, the columns of the mesh, the pictures of materials and, if it has one, environment.exr
/// to `directory`, for blender_scene.py; and scene.obj and scene.mtl for Embree, unless the mesh has uv. The
/// columns of the environment are where Cycles looks for them.
void write_path_scene(const PathScene& scene, std::uint32_t width, std::uint32_t height,
                      const std::string& directory);

}  // namespace oktett::bench
