#include "accel/traverse/leaf.h"

#include <gtest/gtest.h>

#include "tests/support/limits.h"
#include "verify/checks/kernels.h"

namespace oktett::sphere_filter_test {
namespace {

using F = Simd<float, 1, ScalarIsa>;
using D = Simd<double, 1, ScalarIsa>;

struct Counts {
  int hits = 0, misses = 0, left_out = 0;
};

/// The ray, its length changed by a power of two, against a pool with one sphere.
void expect_no_hit_is_left_out(const Ray& whole, const Sphere::Pool& pool, int power, Counts& counts) {
  Ray ray = whole;
  for (int k = 0; k < 3; ++k) ray.direction[k] = std::ldexp(ray.direction[k], power);
  ray.tmin = 0, ray.tmax = kInf;
  if (!is_finite(ray.direction) || !is_finite(ray.origin)) return;
  const RayLanes<F> lanes{broadcast<F>(ray.origin), broadcast<F>(ray.direction), F(ray.tmin), F(ray.tmax)};
  SphereFilter<F>::Spheres spheres;
  spheres.set(pool, 0);
  HitLanes<F> hit;
  const bool met = any(first_root<Sphere>(lanes, to_double(lanes), Sphere::broadcast<D>(pool, 0), hit));
  const bool maybe = (SphereFilter<F>(lanes).may_meet(spheres, 0) & 1u) != 0;
  const SphereShape s = Sphere::shape(pool, 0);
  EXPECT_TRUE(maybe || !met) << exact_text(ray) << " sphere " << s.center.x << ' ' << s.center.y << ' '
                             << s.center.z << ' ' << s.radius;
  ++(met ? counts.hits : counts.misses);
  counts.left_out += maybe ? 0 : 1;
}

// Rays at silhouettes, far away, of huge, tiny and subnormal length: whatever the test in double finds, the
// filter leaves in.
TEST(SphereFilter, LeavesOutNoHit) {
  constexpr std::size_t kCount = 8192;
  for (int c = 0; c < kCaseClasses; ++c) {
    KernelCases cases;
    cases.fill(KernelId::sphere_geometric, static_cast<CaseClass>(c), 0, kCount);
    Counts counts;
    for (std::size_t i = 0; i < kCount; ++i) {
      Sphere::Pool pool;
      const auto column = [&](int k) { return cases.shape[k][i]; };
      Sphere::add(pool, SphereShape{{column(0), column(1), column(2)}, column(3)}, 0);
      Sphere::finish(pool);
      for (const int power : {0, -40, 40, -60, 60, -120, 100})
        expect_no_hit_is_left_out(cases.rays[i], pool, power, counts);
    }
    EXPECT_GT(counts.hits, counts.misses / 10) << c;
    if (static_cast<CaseClass>(c) == CaseClass::random) {
      EXPECT_GT(counts.misses, counts.hits / 10);
      EXPECT_GT(counts.left_out, counts.misses / 3);
    }
  }
}

}  // namespace
}  // namespace oktett::sphere_filter_test
