#include "render/strokes.h"

#include <algorithm>
#include <utility>

#include "core/mesh_geometry.h"

namespace oktett {

MeshPoint StrokeParts::at(const SurfaceInteraction& surface, const Vec3d& place) const {
  // Alone, the balls are no structure of their own, and `geometry` is where they stand in another one.
  std::uint32_t number = surface.primitive;
  if (!cylinders.empty() && surface.geometry > 0)
    number = cylinders[surface.geometry - 1];
  else if (!balls.empty())
    number = balls[surface.primitive];
  const Vec3d from = corner(*strokes, number, 0), axis = corner(*strokes, number, 1) - from;
  const double square = dot(axis, axis);
  const double part = square > 0 ? std::clamp(dot(place - from, axis) / square, 0.0, 1.0) : 0;
  return {strokes.get(), number, static_cast<float>(part), 0};
}

StrokeParts add_strokes(std::shared_ptr<const TriangleMesh> strokes, double radius, std::uint32_t user,
                        std::vector<Geometry>& out) {
  StrokeParts parts;
  const TriangleMesh& mesh = *strokes;
  SpheresShape balls;
  const auto count = static_cast<std::uint32_t>(mesh.triangle_count());
  const auto is_line = [&](std::uint32_t i) { return mesh.indices[3 * i] != mesh.indices[3 * i + 1]; };
  const auto add = [&](auto shape) {
    Geometry& geometry = out.emplace_back();
    geometry.shape = std::move(shape), geometry.user = user;
  };
  bool has_lines = false;
  for (std::uint32_t i = 0; i < count && !has_lines; ++i) has_lines = is_line(i);
  if (!has_lines) {
    balls.spheres.reserve(count);
    for (std::uint32_t i = 0; i < count; ++i) balls.spheres.push_back({corner(mesh, i, 0), radius});
    add(std::move(balls));
    parts.strokes = std::move(strokes);
    return parts;
  }
  // Lines that meet at a vertex share a ball.
  std::vector<bool> has_ball(mesh.positions.size());
  add(SpheresShape{});
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3d ends[2] = {corner(mesh, i, 0), corner(mesh, i, 1)};
    for (std::uint32_t k = 0; k < 2; ++k) {
      const std::uint32_t vertex = mesh.indices[3 * i + k];
      if (has_ball[vertex]) continue;
      has_ball[vertex] = true;
      balls.spheres.push_back({ends[k], radius});
      parts.balls.push_back(i);
    }
    if (!(length(ends[1] - ends[0]) > 0)) continue;
    add(ExactShape{CylinderShape{ends[0], ends[1], radius, true}});
    parts.cylinders.push_back(i);
  }
  out[0].shape = std::move(balls);
  parts.strokes = std::move(strokes);
  return parts;
}

}  // namespace oktett
