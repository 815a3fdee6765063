#include "accel/traverse/inflight/decide_pairs.h"

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "tests/support/triangle_cases.h"
#include "verify/checks/compare_mode.h"

namespace oktett::decide_pairs_test {
namespace {

template <int N>
struct Pairs {
  RayLanes<Simd<float, N, ScalarIsa>> rays;
  std::uint32_t triangle[N];
  HitLanes<Simd<float, N, ScalarIsa>> hit;
};

/// Rays towards a point, an edge point or a corner of a triangle of `blocks` each.
template <int N>
Pairs<N> make_pairs(const std::vector<TriangleBlock>& blocks, TriangleRandom& random,
                    std::vector<Ray>& rays) {
  using F = Simd<float, N, ScalarIsa>;
  Pairs<N> p;
  rays.clear();
  float column[8][N];
  const bool same = random.below(4) == 0;  // one triangle for all
  for (int i = 0; i < N; ++i) {
    p.triangle[i] =
        i > 0 && same ? p.triangle[0] : random.below(static_cast<std::uint32_t>(blocks.size()) * 8);
    Vec3f v[3];
    for (int k = 0; k < 3; ++k)
      v[k] = blocks[p.triangle[i] / 8].vertex(k, static_cast<int>(p.triangle[i] % 8));
    const float w[3] = {random.sign(), random.below(2) ? random.sign() : 0, random.below(2) ? 0.5f : 0};
    const float sum = w[0] + w[1] + w[2];
    Ray r;
    r.origin = random.vector() * 3;
    r.tmin = random.below(4) == 0 ? 0.9f : 0;
    r.tmax = random.below(4) == 0 ? 1.0f : std::numeric_limits<float>::infinity();
    for (int k = 0; k < 3; ++k) {
      const float target = (w[0] * v[0][k] + w[1] * v[1][k] + w[2] * v[2][k]) / sum;
      r.direction[k] = target - r.origin[k];
      column[k][i] = r.origin[k], column[3 + k][i] = r.direction[k];
    }
    if (random.below(8) == 0) column[3 + random.below(3)][i] = 0;
    for (int k = 0; k < 3; ++k) r.direction[k] = column[3 + k][i];
    column[6][i] = r.tmin, column[7][i] = r.tmax;
    rays.push_back(r);
  }
  const auto vec = [&](int k) {
    return Vec3<F>{F::load(column[k]), F::load(column[k + 1]), F::load(column[k + 2])};
  };
  p.rays = {vec(0), vec(3), F::load(column[6]), F::load(column[7])};
  return p;
}

std::vector<TriangleBlock> random_blocks(TriangleRandom& random) {
  std::vector<TriangleBlock> blocks(9);
  for (TriangleBlock& b : blocks) {
    for (auto& axis : b.point)
      for (float& x : axis) x = random.sign();
    for (int lane = 0; lane < 8; ++lane) {
      std::uint32_t n[3];
      do
        for (std::uint32_t& corner : n) corner = random.below(16);
      while (n[0] == n[1] || n[1] == n[2] || n[2] == n[0]);
      // Neighbours share corners, so that rays through edges and corners matter.
      if (lane % 2 == 1)
        n[0] = static_cast<std::uint32_t>(b.corner(1, lane - 1)),
        n[1] = static_cast<std::uint32_t>(b.corner(0, lane - 1));
      b.corners[lane] = static_cast<std::uint16_t>(n[0] | n[1] << 4 | n[2] << 8);
    }
  }
  return blocks;
}

template <int N>
void expect_same_as_alone() {
  using One = Simd<float, 1, ScalarIsa>;
  TriangleRandom random(static_cast<std::uint64_t>(N));
  const std::vector<TriangleBlock> blocks = random_blocks(random);
  int hits = 0, misses = 0, axes[3] = {};
  std::vector<Ray> rays;
  for (int repeat = 0; repeat < 20000 / N; ++repeat) {
    Pairs<N> p = make_pairs<N>(blocks, random, rays);
    const unsigned met = decide_pairs<N, ScalarIsa>(p.rays, blocks.data(), p.triangle, p.hit);
    float t[N], u[N], v[N];
    p.hit.t.store(t), p.hit.u.store(u), p.hit.v.store(v);
    for (int i = 0; i < N; ++i) {
      const Ray& ray = rays[static_cast<std::size_t>(i)];
      RayState<1, ScalarIsa> alone;
      if (alone.set(broadcast<One>(ray.origin), broadcast<One>(ray.direction), One(ray.tmin), One(ray.tmax),
                    Box{}) == 0)
        continue;
      const int z = alone.z_axis_of(0);
      HitLanes<One> h{One(0.0f), One(0.0f), One(0.0f)};
      const bool expected = any(decide_watertight(
          load_shear(alone, z),
          broadcast_triangle<One>(blocks[p.triangle[i] / 8], static_cast<int>(p.triangle[i] % 8), z),
          One(ray.tmin), One(ray.tmax), h));
      ASSERT_EQ((met >> i & 1) != 0, expected) << repeat << ' ' << i;
      ++(expected ? hits : misses), ++axes[z];
      if (!expected) continue;
      ASSERT_TRUE(same_bits(t[i], h.t.part[0].v) && same_bits(u[i], h.u.part[0].v) &&
                  same_bits(v[i], h.v.part[0].v));
    }
  }
  EXPECT_GT(hits, 3000);
  EXPECT_GT(misses, 3000);
  for (const int count : axes) EXPECT_GT(count, 3000);
}

// Rays of all axes side by side get the bits that each gets alone.
TEST(DecidePairs, SameAsOneRayAndOneTriangle) {
  expect_same_as_alone<8>();
  expect_same_as_alone<16>();
}

// Triangles by their numbers: all the same, near each other, and too far apart for one index.
TEST(DecidePairs, GathersNearAndFar) {
  constexpr int N = 16;
  constexpr std::uint32_t kNear = 16;  // two blocks
  TriangleRandom random(5);
  const std::vector<TriangleBlock> blocks = random_blocks(random);
  int near = 0, far = 0;
  for (int repeat = 0; repeat < 3000; ++repeat) {
    const std::uint32_t spread = repeat % 3 == 0 ? 1 : repeat % 3 == 1 ? kNear : 72;
    const std::uint32_t first = random.below(72 / spread) * spread;
    std::uint32_t ids[N], differing = 0;
    for (std::uint32_t& id : ids) id = first + random.below(spread), differing |= id ^ ids[0];
    ++(differing < kNear ? near : far);
    const auto tri = gather_triangles<N, ScalarIsa, kNear>(blocks.data(), ids);
    const Vec3<Simd<float, N, ScalarIsa>>* corners[3] = {&tri.a, &tri.b, &tri.c};
    for (int k = 0; k < 3; ++k) {
      float x[N], y[N], z[N];
      corners[k]->x.store(x), corners[k]->y.store(y), corners[k]->z.store(z);
      for (int i = 0; i < N; ++i) {
        const Vec3f v = blocks[ids[i] / 8].vertex(k, static_cast<int>(ids[i] % 8));
        ASSERT_TRUE(x[i] == v.x && y[i] == v.y && z[i] == v.z) << repeat << ' ' << i;
      }
    }
  }
  EXPECT_GT(near, 1000);
  EXPECT_GT(far, 500);
}

}  // namespace
}  // namespace oktett::decide_pairs_test
