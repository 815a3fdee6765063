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

/// A camera inside the mesh, where it sees far and much, if the mesh is an interior:
///
/// - Its walls face inwards: of what is visible from outside more than two thirds are backs of triangles.
/// - Something stands in it whose front faces these walls. Without this test a mesh that is turned inside out
///   would count as an interior. An empty mesh must have the shape of a room: a level floor and ceiling,
///   upright walls, and no side shorter than a twentieth of the longest.
///
/// A mesh that shows its front to the outside is no interior, whatever it hides: a car, a box with something
/// in it, a house with thick walls.
std::optional<InteriorView> interior_view(const TriangleMesh& mesh, const Vec3d& up, const Film& film);

/// Such a camera whatever the mesh is; nothing if rays cannot hit it.
std::optional<InteriorView> inside_view(const TriangleMesh& mesh, const Vec3d& up, const Film& film);

}  // namespace oktett
