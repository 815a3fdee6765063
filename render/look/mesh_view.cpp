#include "render/look/mesh_view.h"

#include <algorithm>
#include <cmath>

#include "core/math.h"
#include "render/camera.h"

namespace oktett {
namespace {

/// The greatest values of four linear functions over the points: what bounds them on each side of a frustum.
struct FrustumExtent {
  double right = -kInfinity, left = -kInfinity, top = -kInfinity, bottom = -kInfinity;
  double nearest = kInfinity, farthest = -kInfinity;
};

FrustumExtent extent_of(const TriangleMesh& mesh, const CameraFrame& frame, double tan_x, double tan_y) {
  FrustumExtent e;
  for (const std::uint32_t index : mesh.indices) {
    const Vec3d p(mesh.positions[index]);
    const double x = dot(p, frame.right), y = dot(p, frame.up), z = dot(p, frame.forward);
    e.right = std::max(e.right, x - tan_x * z), e.left = std::max(e.left, -x - tan_x * z);
    e.top = std::max(e.top, y - tan_y * z), e.bottom = std::max(e.bottom, -y - tan_y * z);
    e.nearest = std::min(e.nearest, z), e.farthest = std::max(e.farthest, z);
  }
  return e;
}

}  // namespace

Camera fit_mesh(const TriangleMesh& mesh, const Vec3d& forward, const Vec3d& up, double fov, double margin,
                const Film& film) {
  Camera camera;
  camera.up = up, camera.fov = fov;
  camera.from = {}, camera.at = forward;
  const CameraFrame frame = camera_frame(camera, film);
  const double tan_y = portable::tan(fov * kDegree / 2) * (1 - 2 * margin);
  const double tan_x = tan_y * std::max(film.width, 1u) / std::max(film.height, 1u);
  const FrustumExtent e = extent_of(mesh, frame, tan_x, tan_y);
  // Each side of the frustum is a plane through the camera (x, y, z): x - tan_x z >= e.right, and so on. The
  // nearest camera is where two opposite sides both touch the mesh.
  const double x = (e.right - e.left) / 2, y = (e.top - e.bottom) / 2;
  double z = std::min(-(e.right + e.left) / (2 * tan_x), -(e.top + e.bottom) / (2 * tan_y));
  const double size = std::max(e.farthest - e.nearest, 1e-6 * std::max(std::abs(e.farthest), 1e-12));
  if (!(z < e.nearest)) z = e.nearest - size;
  camera.from = frame.right * x + frame.up * y + frame.forward * z;
  camera.at = camera.from + frame.forward * ((e.nearest + e.farthest) / 2 - z);
  return camera;
}

}  // namespace oktett
