#include "accel/traverse/inflight/decide_pairs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <span>
#include <vector>

#include "accel/build/compact_blocks.h"
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

Vec3f vertex(const std::vector<TriangleBlock>& blocks, std::uint32_t triangle, int k) {
  return TriangleLeaf(blocks.data(), triangle / 8).vertex(k, static_cast<int>(triangle % 8));
}

/// The number of a triangle that there is, of a block below `end`.
std::uint32_t random_triangle(const std::vector<TriangleBlock>& blocks, TriangleRandom& random,
                              std::uint32_t begin = 0, std::uint32_t end = 9) {
  const std::uint32_t block = begin + random.below(end - begin);
  return 16 * block + random.below(blocks[block].is_packed() ? 16 : 8);
}

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
    p.triangle[i] = i > 0 && same ? p.triangle[0] : random_triangle(blocks, random);
    Vec3f v[3];
    for (int k = 0; k < 3; ++k) v[k] = vertex(blocks, p.triangle[i], k);
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

enum class Form { plain, packed, mixed };

/// Nine blocks. Corners that are packed together lie around (1, 1, 1), as not all are narrow enough.
std::vector<TriangleBlock> random_blocks(TriangleRandom& random, Form form) {
  std::vector<TriangleBlock> blocks(9);
  for (TriangleBlock& b : blocks) {
    const bool packed = form == Form::packed || (form == Form::mixed && random.below(2) == 0);
    for (int axis = 0; axis < 3; ++axis)
      for (float& x : std::span(b.row(axis), TriangleBlock::kCorners))
        x = packed ? 1 + 0.4f * random.sign() : random.sign();
    for (int lane = 0; lane < 8; ++lane) {
      std::uint32_t n[3];
      do
        for (std::uint32_t& corner : n) corner = random.below(16);
      while (n[0] == n[1] || n[1] == n[2] || n[2] == n[0]);
      // Neighbours share corners, so that rays through edges and corners matter.
      if (lane % 2 == 1) n[0] = b.first.corners[lane - 1] >> 4 & 15u, n[1] = b.first.corners[lane - 1] & 15u;
      b.first.corners[lane] = static_cast<std::uint16_t>(n[0] | n[1] << 4 | n[2] << 8);
    }
    if (!packed) continue;
    TriangleBlock other = b, both;
    std::reverse(other.first.corners, other.first.corners + TriangleBlock::kSize);
    EXPECT_TRUE(pack_leaves(b, other, both));
    b = both;
  }
  return blocks;
}

template <int N>
void expect_same_as_alone(Form form) {
  using One = Simd<float, 1, ScalarIsa>;
  TriangleRandom random(static_cast<std::uint64_t>(N));
  const std::vector<TriangleBlock> blocks = random_blocks(random, form);
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
          broadcast_triangle<One>({blocks.data(), p.triangle[i] / 8}, static_cast<int>(p.triangle[i] % 8), z),
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
  for (const Form form : {Form::plain, Form::packed, Form::mixed})
    expect_same_as_alone<8>(form), expect_same_as_alone<16>(form);
}

// Triangles by their numbers: all the same, near each other, and too far apart for one index.
TEST(DecidePairs, GathersNearAndFar) {
  constexpr int N = 16;
  constexpr std::uint32_t kNear = 32;  // two blocks
  TriangleRandom random(5);
  for (const Form form : {Form::plain, Form::packed, Form::mixed}) {
    const std::vector<TriangleBlock> blocks = random_blocks(random, form);
    int near = 0, far = 0;
    for (int repeat = 0; repeat < 3000; ++repeat) {
      const std::uint32_t begin = repeat % 3 == 2 ? 0 : 2 * random.below(4);
      const std::uint32_t one = random_triangle(blocks, random, begin, begin + 2);
      std::uint32_t ids[N], differing = 0;
      for (std::uint32_t& id : ids) {
        id = repeat % 3 == 0 ? one : random_triangle(blocks, random, begin, repeat % 3 == 1 ? begin + 2 : 9);
        differing |= id ^ ids[0];
      }
      ++(differing < kNear ? near : far);
      const auto tri = gather_triangles<N, ScalarIsa, kNear>(blocks.data(), ids);
      const Vec3<Simd<float, N, ScalarIsa>>* corners[3] = {&tri.a, &tri.b, &tri.c};
      for (int k = 0; k < 3; ++k) {
        float x[N], y[N], z[N];
        corners[k]->x.store(x), corners[k]->y.store(y), corners[k]->z.store(z);
        for (int i = 0; i < N; ++i) {
          const Vec3f v = vertex(blocks, ids[i], k);
          ASSERT_TRUE(same_bits(x[i], v.x) && same_bits(y[i], v.y) && same_bits(z[i], v.z))
              << repeat << ' ' << i;
        }
      }
    }
    EXPECT_GT(near, 1000);
    EXPECT_GT(far, 500);
  }
}

}  // namespace
}  // namespace oktett::decide_pairs_test
