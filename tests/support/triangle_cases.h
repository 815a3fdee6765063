#pragma once
/// \file Pairs of a ray and a triangle that are hard to decide.

#include <cmath>

#include "core/mesh.h"
#include "core/random.h"
#include "core/ray.h"

namespace oktett {

/// Random numbers that depend on a counter alone.
class TriangleRandom {
 public:
  explicit TriangleRandom(std::uint64_t seed) : key_(mix_bits(seed)) {}
  float unit() { return random_float(key_, 0, next_++); }
  float sign() { return 2 * unit() - 1; }
  Vec3f vector() {
    const float x = sign(), y = sign(), z = sign();
    return {x, y, z};
  }
  std::uint64_t bits() { return random_bits(key_, 1, next_++); }
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(bits() % n); }

 private:
  std::uint64_t key_;
  std::uint32_t next_ = 0;
};

struct TriangleCase {
  Vec3f corner[3];
  Ray ray;
};

/// A triangle of about size `scale`, often a needle or a sliver, and a ray towards a point, an edge point or
/// a corner of it: from about as far, from near a corner, or from the triangle's own plane.
inline TriangleCase adversarial_case(TriangleRandom& r, float scale) {
  TriangleCase c;
  Vec3f& a = c.corner[0];
  for (Vec3f& p : c.corner) p = r.vector() * scale;
  const std::uint64_t choice = r.bits();
  const auto shrunk = [&](const Vec3f& p) { return a + (p - a) * std::exp2(13 * r.sign() - 13); };
  if (choice & 1) c.corner[1] = shrunk(c.corner[1]);
  if (choice & 2) c.corner[2] = shrunk(c.corner[2]);
  float u = r.unit(), v = r.unit();
  if (u + v > 1) u = 1 - u, v = 1 - v;
  if (choice & 4) u = 0;
  if (choice & 8) v = 0;
  const Vec3f e1 = c.corner[1] - a, e2 = c.corner[2] - a, target = a + e1 * u + e2 * v;
  switch (choice >> 4 & 3) {
    case 0:
      c.ray.origin = a + r.vector() * (scale * 1e-6f);
      break;
    case 1:
      c.ray.origin = a + e1 * (3 * r.sign()) + e2 * (3 * r.sign());
      break;
    default:
      c.ray.origin = r.vector() * (3 * scale);
  }
  c.ray.direction = target - c.ray.origin;
  const float length = max_component(abs(c.ray.direction));
  if (choice & 64) c.ray.direction = c.ray.direction / length;
  return c;
}

/// Adds the triangle to `mesh`, `copies` times, and to `rays` its ray, endless and up to the target.
inline void add_case(const TriangleCase& c, TriangleMesh& mesh, RayBatch& rays, int copies = 1) {
  for (; copies > 0; --copies)
    for (const Vec3f& p : c.corner) {
      mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
      mesh.positions.push_back(p);
    }
  rays.push_back(c.ray);
  Ray up_to_target = c.ray;
  up_to_target.tmax = 1;
  rays.push_back(up_to_target);
}

}  // namespace oktett
