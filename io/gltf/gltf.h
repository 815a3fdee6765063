#pragma once
/// \file Scenes in glTF 2.0 files, read and written. Within io/ only.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/transform.h"
#include "io/gltf/gltf_options.h"
#include "io/mesh/mesh_file.h"
#include "io/mesh/mesh_output.h"
#include "render/scene.h"

namespace oktett {

/// A mesh that nodes show.
struct GltfSharedMesh {
  std::string name;
  std::shared_ptr<TriangleMesh> mesh;
  std::vector<std::uint32_t> slots;  ///< index into the materials per slot of the mesh; kNoId: none
  /// They are points and lines (MeshFile::strokes), in world space, which scales their places alone: a node
  /// that is stretched does not make balls of them ellipsoids.
  bool is_strokes = false;
  std::shared_ptr<const MeshBending>
      bending{};  ///< as GltfOptions::shutter says; null: it is not bent by then
};

/// A node that shows a mesh.
struct GltfPlacement {
  std::string name;
  std::uint32_t mesh = 0;
  Affine to_world;
  MotionPointer motion{};  ///< as GltfOptions::shutter says: from time 0 to 1
};

/// The default scene of a file.
struct GltfScene {
  std::vector<GltfSharedMesh> meshes;
  std::vector<GltfPlacement> placements;
  std::vector<Material> materials;
  std::vector<Texture> textures;
  std::vector<Medium> media;             ///< what Material::interior refers to
  std::vector<Location> texture_places;  ///< where each texture is named
  std::optional<Camera> camera;          ///< the first one
  double aspect = 0;                     ///< width by height of its picture; 0: not given
  std::vector<Light> lights;
  std::vector<Warning> warnings;
};

/// Reads a .gltf or .glb file, and the buffers beside it. Throws Error, with ErrorKind::io if a file cannot
/// be read. Image files are not read.
GltfScene load_gltf_scene(const std::string& path, const GltfOptions& options = {});

/// How wide points and lines are shown if nothing is said; 0 if there are none. Adds to the warnings how wide
/// that is.
double usual_stroke_width(GltfScene& scene, const std::string& path);

/// Whether all nodes together, each with triangles of its own, take little more than the meshes once: at most
/// four million triangles.
bool can_be_one_mesh(const GltfScene& scene);

/// All that the nodes show as one mesh in world space, without cameras and lights. Throws Error unless
/// can_be_one_mesh.
MeshFile one_mesh(const std::string& path, GltfScene scene);

/// Whether the name of a file is that of a glTF file.
bool is_gltf_file(const std::string& path);

/// Writes the mesh as one node of a glTF 2.0 file of bytes, with its materials and their images. Returns what
/// glTF cannot say. Throws Error of kind io if that fails.
MeshLosses write_glb(const std::string& path, const MeshFile& file);

}  // namespace oktett
