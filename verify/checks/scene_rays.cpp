#include <algorithm>
#include <cmath>

#include "accel/query.h"
#include "core/random.h"
#include "render/geometry.h"
#include "verify/cases/kernel_cases.h"
#include "verify/checks/scenes.h"

namespace oktett {
namespace {

/// Rays through a scene that start elsewhere than on its surfaces.
constexpr std::size_t kRaysPerScene = 320;

/// Rays that leave the surfaces which `rays` hit, in random directions.
void add_second_rays(const Accel& accel, CaseRandom& random, RayBatch& rays) {
  HitBatch hits;
  hits.resize_uninitialized(rays.size());
  closest_hit(accel, rays.span(), hits.span(), Isa::scalar, TraceMode::single);
  for (std::size_t i = 0, end = rays.size(); i < end; i += 4) {
    if (!hits[i].valid()) continue;
    const SurfaceInteraction s = surface_interaction(accel, rays[i], hits[i]);
    const Vec3f d(random.vector());
    rays.push_back({offset_origin(s, d), 0, d});
  }
}

}  // namespace

RayBatch draw_rays(const Scene& scene, std::uint64_t number) {
  const World world = build_world(scene, {BuildQuality::fast, false});
  CaseRandom random(mix_bits(number) + 5);
  Vec3d middle{0, 0, 0}, half{1, 1, 1};
  if (!world.bounds.empty()) middle = Vec3d(world.bounds.center()), half = Vec3d(world.bounds.extent()) * 0.5;
  const double size = std::max(length(half), 1e-30);
  const auto around = [&](double reach) { return middle + normalize(random.vector()) * (size * reach); };
  RayBatch rays;
  while (rays.size() < kRaysPerScene) {
    // Runs from one point exercise beams and packets.
    const bool camera = random.unit() < 0.5;
    const Vec3d eye = around(1.2 + random.unit()), towards = middle + half * random.vector() * 0.7;
    const double spread = random.unit();
    for (int k = 0; k < (camera ? 64 : 32); ++k) {
      const Vec3d at = camera ? towards + half * random.vector() * spread : middle + half * random.vector();
      Vec3d from = camera ? eye : random.unit() < 0.3 ? middle + half * random.vector() : around(1.5);
      Ray ray;
      ray.direction = Vec3f(at - from);
      if (!camera && random.unit() < 0.2) {
        const int axis = static_cast<int>(random.unit() * 3);
        const double side = random.sign() < 0 ? -1 : 1;
        from = at, from[axis] -= side * 2 * size;
        ray.direction = {0, 0, 0}, ray.direction[axis] = static_cast<float>(side);
      }
      ray.origin = Vec3f(from);
      const double reach = size / std::max(1e-30, double(max_component(abs(ray.direction))));
      if (random.unit() < 0.1) ray.tmin = static_cast<float>(reach * random.unit());
      if (random.unit() < 0.1) ray.tmax = static_cast<float>(3 * reach * random.unit());
      rays.push_back(ray);
    }
  }
  add_second_rays(*world.accel, random, rays);
  return rays;
}

}  // namespace oktett
