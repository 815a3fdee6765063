#include "bench/bench_rays.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace oktett::bench {
namespace {

float radius_of(const Box& b) { return 0.5f * length(b.extent()); }

/// The hit point, moved a little off the surface to the side of the ray, and the normal on that side.
SurfaceInteraction lifted_surface(const Accel& accel, const Ray& ray, const Hit& hit, float lift) {
  SurfaceInteraction s = surface_interaction(accel, ray, hit);
  if (dot(s.geometric_normal, ray.direction) > 0) s.geometric_normal = -s.geometric_normal;
  s.position += s.geometric_normal * lift;
  return s;
}

}  // namespace

RayBatch primary_rays(const Box& bounds, const View& view) {
  const Vec3f center = bounds.center();
  const float radius = radius_of(bounds);
  const Vec3f from = view.inside ? center : center + normalize(Vec3f{0.6f, 0.45f, 1}) * (radius * 2.2f);
  const Vec3f w = view.inside ? normalize(Vec3f{1, 0.05f, 0.1f}) : normalize(center - from);
  const Vec3f u = normalize(cross(w, Vec3f{0, 1, 0})), v = cross(u, w);
  const float f = std::tan(25 * std::numbers::pi_v<float> / 180);
  const int n = view.resolution;
  RayBatch rays;
  rays.resize_uninitialized(static_cast<std::size_t>(n) * n);
  std::size_t i = 0;
  for (int tile = 0; tile < (n / 16) * (n / 16); ++tile)
    for (int k = 0; k < 256; ++k) {
      // Bits of k from the top: block row, block column, row, column.
      const int x = tile % (n / 16) * 16 + (k >> 4 & 3) * 4 + (k & 3),
                y = tile / (n / 16) * 16 + (k >> 6) * 4 + (k >> 2 & 3);
      const float sx = (2 * (static_cast<float>(x) + 0.5f) / static_cast<float>(n) - 1) * f;
      const float sy = (1 - 2 * (static_cast<float>(y) + 0.5f) / static_cast<float>(n)) * f;
      rays.set(i++, {from, 0, normalize(w + u * sx + v * sy)});
    }
  return rays;
}

RayBatch shadow_rays(const Accel& accel, const RayBatch& rays, HitBatch& hits, const Box& bounds,
                     const View& view) {
  const float radius = radius_of(bounds);
  Vec3f light = bounds.center() + normalize(Vec3f{-0.3f, 1, 0.5f}) * (radius * 3);
  if (view.inside) light = {bounds.center().x, bounds.hi.y * 0.9f, bounds.center().z};
  RayBatch out;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!hits[i].valid()) continue;
    const Vec3f p = lifted_surface(accel, rays[i], hits[i], radius * 1e-4f).position;
    const float distance = length(light - p);
    out.push_back({p, 0, (light - p) / distance, distance});
  }
  return out;
}

RayBatch diffuse_rays(const Accel& accel, const RayBatch& rays, HitBatch& hits, const Box& bounds, int count,
                      float reach, std::uint32_t seed) {
  const float lift = radius_of(bounds) * 1e-4f;
  RayBatch out;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!hits[i].valid()) continue;
    const SurfaceInteraction s = lifted_surface(accel, rays[i], hits[i], lift);
    Vec3f t, b;
    make_basis(s.geometric_normal, t, b);
    for (int k = 0; k < count; ++k) {
      const std::uint64_t key = pixel_key(seed, i);
      const float a = 2 * std::numbers::pi_v<float> * random_float(key, static_cast<std::uint32_t>(k), 0);
      const float q = random_float(key, static_cast<std::uint32_t>(k), 1), r = std::sqrt(q);
      const Vec3f d = t * (r * std::cos(a)) + b * (r * std::sin(a)) + s.geometric_normal * std::sqrt(1 - q);
      out.push_back({s.position, 0, normalize(d), reach});
    }
  }
  return out;
}

RayBatch bounce_rays(const Accel& accel, const RayBatch& rays, HitBatch& hits, const Box& bounds, Isa isa) {
  constexpr std::uint32_t kLast = 4;
  const float infinity = std::numeric_limits<float>::infinity();
  RayBatch bounce = diffuse_rays(accel, rays, hits, bounds, 1, infinity), out;
  for (std::uint32_t number = 2; number <= kLast; ++number) {
    HitBatch found;
    found.resize_uninitialized(bounce.size());
    closest_hit(accel, bounce.span(), found.span(), isa);
    bounce = diffuse_rays(accel, bounce, found, bounds, 1, infinity, number);
    for (std::size_t i = 0; i < bounce.size(); ++i) out.push_back(bounce[i]);
  }
  return out;
}

RayBatch random_segments(const Box& bounds, std::size_t count) {
  // Walls and floors often lie in the faces of the bounds. There, rounding would decide.
  const Vec3f inset = bounds.extent() * (1.0f / 64);
  const Box box{bounds.lo + inset, bounds.hi - inset};
  const auto point = [&](std::uint64_t key, std::uint32_t which, int face) {
    Vec3f p = box.lo;
    for (int k = 0; k < 3; ++k) {
      const float random = random_float(key, which, static_cast<std::uint32_t>(k));
      p[k] += box.extent()[k] * (k == face / 2 ? static_cast<float>(face % 2) : random);
    }
    return p;
  };
  RayBatch out;
  out.resize_uninitialized(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t key = pixel_key(0, i);
    const int face = static_cast<int>(random_bits(key, 2, 0) % 6);
    const int other = (face + 1 + static_cast<int>(random_bits(key, 2, 1) % 5)) % 6;
    const Vec3f from = point(key, 0, face), way = point(key, 1, other) - from;
    out.set(i, {from, 0, normalize(way), length(way)});
  }
  return out;
}

}  // namespace oktett::bench
