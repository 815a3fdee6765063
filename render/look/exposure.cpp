#include "render/look/exposure.h"

#include <algorithm>
#include <cmath>

#include "core/math.h"
#include "core/mesh_triangle.h"
#include "core/random.h"
#include "render/sampling/owen_sobol.h"
#include "render/sampling/warp.h"

namespace oktett {
namespace {

constexpr std::uint32_t kPoints = 1024;
/// From each point to its front and to its back. More to the back: where a single way leads out there, the
/// point is no content of a room. To the front it may lead through a window.
constexpr std::uint32_t kFrontRays = 4, kBackRays = 16, kRays = kFrontRays + kBackRays;

/// Rays from a random point of the triangle, first to the front, then to the back.
void add_rays(const MeshExplorer& mesh, std::uint32_t triangle, std::uint32_t number,
              std::vector<Ray>& rays) {
  const SquareSample place = sobol_point(number, mix_bits(1));
  const double root = std::sqrt(place.x), u = root * place.y, v = 1 - root;
  const auto at = [&](std::size_t k) { return corner(mesh.mesh(), triangle, k); };
  const Vec3d a = at(0), p = a + (at(1) - a) * u + (at(2) - a) * v;
  const Vec3d n = normalize(area_normal(mesh.mesh(), triangle));
  for (int side = 0; side < 2; ++side)
    for (std::uint32_t i = 0, count = side == 0 ? kFrontRays : kBackRays; i < count; ++i) {
      const Vec3f out(side == 0 ? n : -n);
      Ray ray;
      ray.direction = cosine_direction(out, sobol_point(number * count + i, mix_bits(2 + side)));
      ray.origin = Vec3f(p + Vec3d(out) * (1e-5 * mesh.size()));
      rays.push_back(ray);
    }
}

/// For each ray 1 if it hits the front of a wall behind which there is nothing, else 0.
std::vector<std::uint8_t> reach_walls(const MeshExplorer& mesh, const std::vector<Ray>& rays) {
  const std::vector<Hit> hits = mesh.hits(rays);
  std::vector<Ray> onwards;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Ray ray = rays[i];
    const double beyond = hits[i].valid() ? hits[i].t + 1e-5 * mesh.size() : 0;
    ray.origin = Vec3f(Vec3d(ray.origin) + Vec3d(ray.direction) * beyond);
    onwards.push_back(ray);
  }
  std::vector<std::uint8_t> reached = mesh.occluded(onwards);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const bool front =
        hits[i].valid() && dot(area_normal(mesh.mesh(), hits[i].item), Vec3d(rays[i].direction)) < 0;
    reached[i] = front && reached[i] == 0;
  }
  return reached;
}

}  // namespace

Exposure exposure_of(const MeshExplorer& mesh, const Vec3d& up) {
  const std::vector<std::uint32_t> triangles = mesh.triangles_by_area(kPoints);
  std::vector<Ray> rays;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) add_rays(mesh, triangles[i], i, rays);
  const std::vector<std::uint8_t> occluded = mesh.occluded(rays);
  Exposure e;
  std::vector<Ray> inner;  // of what is hidden
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto first = rays.begin() + static_cast<std::ptrdiff_t>(kRays * i);
    const std::uint8_t* const to_front = &occluded[kRays * i];
    const bool front = std::count(to_front, to_front + kFrontRays, 0) > 0;
    const bool back = std::count(to_front + kFrontRays, to_front + kRays, 0) > 0;
    e.front += front, e.back += back && !front, e.hidden += !front && !back;
    if (!front && !back) inner.insert(inner.end(), first, first + 2 * kFrontRays);
    const double rise = std::abs(dot(normalize(area_normal(mesh.mesh(), triangles[i])), up));
    e.square += rise < 0.05 || rise > 0.995;
  }
  const std::vector<std::uint8_t> walls = reach_walls(mesh, inner);
  // As many to the back as to the front.
  for (std::size_t i = 0; i < inner.size(); ++i)
    (i / kFrontRays % 2 == 0 ? e.facing : e.averted) += static_cast<double>(walls[i]) / kFrontRays;
  const double count = std::max(1.0, static_cast<double>(triangles.size()));
  for (double* share : {&e.front, &e.back, &e.hidden, &e.facing, &e.averted, &e.square}) *share /= count;
  return e;
}

}  // namespace oktett
