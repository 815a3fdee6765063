#pragma once
/// \file Views of a mesh that shows nothing but itself: from outside by its vertices, from inside for rooms.

#include <optional>

#include "core/mesh.h"
#include "render/scene.h"

namespace oktett {

/// A perspective camera that looks along `forward`, as near as it can be with every vertex of every triangle
/// in the frame, of which the part `margin` is left free on each side. `up`, which is not parallel to
/// `forward`, points up in the picture; `fov` is the vertical angle in degrees. The mesh must have triangles.
Camera fit_mesh(const TriangleMesh& mesh, const Vec3d& forward, const Vec3d& up, double fov, double margin,
                const Film& film);

/// A view of a room.
struct InteriorView {
  Camera camera;
  /// Towards a sun that shines through openings on what the camera sees; nothing if hardly any sun could.
  std::optional<Vec3d> sun;
};

/// A camera inside the mesh, if it is a room or a building that hides much of itself from who stands outside:
/// less than 30 % of its surface can be seen from there from the front, and more than 30 % from neither side
/// (of a closed room 5 % and 10 %: what stands in it). The camera stands where it sees far and much.
std::optional<InteriorView> interior_view(const TriangleMesh& mesh, const Vec3d& up, const Film& film);

}  // namespace oktett
