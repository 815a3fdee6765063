#pragma once
/// \file Scenes of the comparison with Embree, as data that either program can build.

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "accel/accel.h"

namespace oktett::bench {

/// What both programs trace, in one space.
struct PeerScene {
  using Mesh = std::shared_ptr<const TriangleMesh>;
  std::string name;
  std::string path;  ///< the OBJ file that is all of the scene; empty if there is more
  std::vector<Mesh> meshes;
  std::vector<SphereShape> spheres;
  std::vector<Mesh> models;           ///< what `places` show, each in a tree of its own
  std::vector<InstancePlace> places;  ///< InstancePlace::child is an index into `models`
  Box framed;                         ///< what cameras look at; empty: the bounds of the scene

  /// Triangles and spheres, those of a model counted once.
  std::size_t primitives() const;
  /// Bounds of the first mesh.
  Box bounds() const;
};

/// The triangles of an OBJ file. Throws Error if it cannot be read.
PeerScene file_scene(const std::string& path);
/// A mesh in a closed room of twelve triangles. Cameras that look at the mesh from outside stand in the room.
PeerScene room_scene(const PeerScene& mesh);
/// A mesh in many instances of random rotation that fill a cube.
PeerScene copies_scene(const PeerScene& mesh, std::size_t count);
/// The meadow of `plants`.
PeerScene meadow_scene(std::size_t plants);
/// Random spheres in a cube, or small ones in the bounds of a mesh.
PeerScene spheres_scene(std::size_t count);
PeerScene mixed_scene(const PeerScene& mesh, std::size_t count);

/// A scene as Oktett holds it.
struct OktettScene {
  std::shared_ptr<const Accel> accel;
  /// Of all trees, and of the positions and indices that they refer to. Embree gets no normals or texture
  /// coordinates, so these are not counted.
  std::size_t bytes = 0;
};

/// The scene must outlive what is built of it.
OktettScene build(const PeerScene& scene, const BuildOptions& options);

}  // namespace oktett::bench
