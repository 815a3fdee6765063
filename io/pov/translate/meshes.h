#pragma once
/// \file Objects that are meshes here: mesh, mesh2, smooth_triangle and polygon. Within io/ only.

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/mesh.h"
#include "io/pov/translate/context.h"

namespace oktett::pov {

/// A corner of a triangle.
struct MeshCorner {
  Vec3d position{};
  std::optional<Vec3d> normal{};
  std::optional<std::array<double, 2>> uv{};
};

/// What a mesh is made for.
enum class MeshUse {
  shown,
  camera,  ///< its triangles keep their order and that of their corners
};

/// Puts a mesh together, triangle by triangle.
class MeshMaker {
 public:
  explicit MeshMaker(MeshUse use = MeshUse::shown) : use_(use) {}

  /// The winding of what is shown is turned to where the normals point, if there are some.
  void add(std::array<MeshCorner, 3> corners);
  void add(const MeshMaker& more) {
    triangles_.insert(triangles_.end(), more.triangles_.begin(), more.triangles_.end());
  }
  bool empty() const { return triangles_.empty(); }
  /// As it would be read from a file.
  std::shared_ptr<const TriangleMesh> finish() const;

 private:
  MeshUse use_;
  std::vector<std::array<MeshCorner, 3>> triangles_;
};

/// Triangles of one texture.
struct MeshPart {
  MeshMaker mesh;
  std::shared_ptr<const Block> texture;  ///< null: that of the whole
};

/// What such a block shows, in parts of one texture each, or for cameras in one part, its arguments taken.
/// `solid`: whether it has an inside. Nothing, after a warning, if it shows nothing that is known here.
struct MadeMesh {
  std::vector<MeshPart> parts;
  bool solid = false;
};
std::optional<MadeMesh> make_mesh(Context& context, Arguments& arguments, MeshUse use = MeshUse::shown);

/// Adds a mesh to those of the scene. Returns the name by which the tree refers to it.
std::string add_mesh(Context& context, std::shared_ptr<const TriangleMesh> mesh, const std::string& wanted);

}  // namespace oktett::pov
