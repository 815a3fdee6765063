#pragma once
/// \file What a file shows that holds more than one mesh. Within io/ only.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/transform.h"
#include "io/mesh/mesh_file.h"
#include "render/scene.h"

namespace oktett {

/// A mesh that may be in several places.
struct SharedMesh {
  std::string name;
  std::shared_ptr<TriangleMesh> mesh;
  std::vector<std::uint32_t> slots;  ///< index into the materials per slot of the mesh; kNoId: none
  /// They are points and lines (MeshFile::strokes), in world space, which scales their places alone: a node
  /// that is stretched does not make balls of them ellipsoids.
  bool is_strokes = false;
  std::shared_ptr<const MeshBending> bending{};  ///< while the shutter is open; null: it is not bent by then
};

/// A place where a mesh is shown.
struct PlacedMesh {
  std::string name;
  std::uint32_t mesh = 0;
  Affine to_world;
  MotionPointer motion{};  ///< from time 0 to 1
};

/// All that a file shows.
struct FileScene {
  std::vector<SharedMesh> meshes;
  std::vector<PlacedMesh> placements;
  std::vector<Material> materials;
  std::vector<Texture> textures;
  std::vector<Medium> media;             ///< what Material::interior refers to
  std::vector<Location> texture_places;  ///< where each texture is named
  std::optional<Camera> camera;          ///< the first one
  double aspect = 0;                     ///< width by height of its picture; 0: not given
  std::vector<Light> lights;
  std::vector<Warning> warnings;
};

/// Whether points of a place stay within what coordinates in float can be, and the place can be undone.
bool is_usable_place(const Affine& map);

/// How wide points and lines are shown if nothing is said; 0 if there are none. Adds to the warnings how wide
/// that is.
double usual_stroke_width(FileScene& scene, const std::string& path);

/// Whether all placements together, each with triangles of its own, take little more than the meshes once: at
/// most four million triangles.
bool can_be_one_mesh(const FileScene& scene);

/// All placements as one mesh in world space, without cameras and lights. Throws Error unless
/// can_be_one_mesh.
MeshFile one_mesh(const std::string& path, FileScene scene);

/// The same, however many triangles that are. Throws Error beyond 2^32 - 2 of them.
MeshFile join_placements(const std::string& path, FileScene scene);

}  // namespace oktett
