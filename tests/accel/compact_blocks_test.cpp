#include "accel/build/compact_blocks.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "accel/accel.h"
#include "accel/build/tree_store.h"
#include "accel/query.h"
#include "tests/accel/same_hits.h"
#include "tests/support/triangle_cases.h"
#include "verify/oracles/mesh.h"

namespace oktett::compact_blocks_test {
namespace {

constexpr int kSize = TriangleBlock::kSize;

bool same(float a, float b) { return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b); }

/// A plain block of `count` triangles with the corners point(n), of which the first `corners` are used.
template <class Point>
TriangleBlock make_block(TriangleRandom& random, int count, int corners, const Point& point) {
  TriangleBlock block{};
  for (int n = 0; n < TriangleBlock::kCorners; ++n) {
    const Vec3f p = point(n < corners ? n : 0);
    block.x[n] = p.x, block.y[n] = p.y, block.z[n] = p.z;
  }
  int next = 0;  // all corners are used
  for (int i = 0; i < kSize; ++i) {
    block.first.item[i] = i < count ? random.below(1u << 30) : kNoId;
    for (int k = 0; k < 3 && i < count; ++k, ++next) {
      const auto n = static_cast<std::uint32_t>(
          next < corners ? next : random.below(static_cast<std::uint32_t>(corners)));
      block.first.corners[i] = static_cast<std::uint16_t>(block.first.corners[i] | n << 4 * k);
    }
  }
  return block;
}

void expect_same_leaf(const TriangleLeaf& got, const TriangleBlock& block, int count) {
  const TriangleLeaf expected(&block, 0);
  const CornerRows<ScalarIsa> rows(got);
  for (int i = 0; i < kSize; ++i) {
    ASSERT_EQ(got.item(i), block.first.item[i]);
    for (int k = 0; k < 3; ++k) {
      const Vec3f a = got.vertex(k, i), b = expected.vertex(k, i);
      for (int axis = 0; axis < 3 && i < count; ++axis) {
        ASSERT_TRUE(same(a[axis], b[axis])) << a[axis] << ' ' << b[axis];
        ASSERT_TRUE(same(rows[axis][got.corner(k, i)], b[axis]));
      }
    }
    if (i >= count) {
      ASSERT_EQ(got.corner(0, i), got.corner(1, i));
      ASSERT_EQ(got.corner(0, i), got.corner(2, i));
    }
  }
}

TEST(CompactBlocks, NumbersOfFloatsCountThem) {
  EXPECT_EQ(float_number(0.0f), 0);
  EXPECT_EQ(float_number(-0.0f), -1);
  EXPECT_EQ(float_number(std::numeric_limits<float>::denorm_min()), 1);
  for (int exponent = -149; exponent <= 127; ++exponent)
    for (const float sign : {1.0f, -1.0f}) {
      const float x = sign * std::ldexp(1.0f, exponent);
      const float next = std::nextafter(x, std::numeric_limits<float>::infinity());
      EXPECT_TRUE(same(float_of_number(float_number(x)), x));
      EXPECT_EQ(float_number(next) - float_number(x), 1);
    }
}

// Around every float there is, as far apart as a packed block can hold, no bit of a corner changes.
TEST(CompactBlocks, CornersKeepTheirBitsAtEveryExponent) {
  TriangleRandom random(1);
  std::size_t packed = 0;
  for (int exponent = -149; exponent <= 127; ++exponent)
    for (const float sign : {1.0f, -1.0f})
      for (const std::uint32_t span : {TriangleBlock::kMostDistance, 1u << 12, 0u}) {
        std::int32_t base[3];
        for (std::int32_t& b : base) {
          const std::int64_t middle = float_number(sign * std::ldexp(1.0f, exponent));
          // Finite floats only; blocks that begin below zero and end above it among them.
          constexpr std::int64_t kMost = 0x7f7fffff;
          b = static_cast<std::int32_t>(std::clamp<std::int64_t>(middle - random.below(span + 1), -kMost - 1,
                                                                 kMost - static_cast<std::int64_t>(span)));
        }
        std::vector<Vec3f> points;
        for (int n = 0; n < TriangleBlock::kCorners; ++n)
          for (int axis = 0; axis < 3; ++axis) {
            const std::uint32_t distance = n == 0 ? 0 : n == 1 ? span : random.below(span + 1);
            if (axis == 0) points.emplace_back();
            points.back()[axis] = float_of_number(base[axis] + static_cast<std::int32_t>(distance));
          }
        // The leaves share two corners, but for blocks of points.
        const int ca = 4 + static_cast<int>(random.below(6)),
                  cb = std::min(TriangleBlock::kCorners - ca + 2, 12);
        const int na = 4 + static_cast<int>(random.below(5)), nb = 4 + static_cast<int>(random.below(5));
        const TriangleBlock a =
            make_block(random, na, ca, [&](int n) { return points[static_cast<std::size_t>(n)]; });
        const TriangleBlock b = make_block(
            random, nb, cb, [&](int n) { return points[static_cast<std::size_t>(n < 2 ? n : ca + n - 2)]; });
        TriangleBlock both;
        ASSERT_TRUE(pack_leaves(a, b, both)) << exponent << ' ' << ca << ' ' << cb;
        ASSERT_TRUE(both.is_packed());
        expect_same_leaf({&both, 0}, a, na);
        expect_same_leaf({&both, 1}, b, nb);
        ++packed;
      }
  EXPECT_EQ(packed, 277u * 2 * 3);
}

TEST(CompactBlocks, CornersTooFarApartAreNotPacked) {
  TriangleRandom random(2);
  for (int axis = 0; axis < 3; ++axis)
    for (const std::int32_t base : {float_number(1.0f), float_number(-1.0f), -5}) {
      const auto block = [&](std::int32_t number) {
        return make_block(random, 1, 3, [&](int n) {
          Vec3f p{1, 1, 1};
          p[axis] = float_of_number(n == 2 ? number : base);
          return p;
        });
      };
      const auto most = static_cast<std::int32_t>(TriangleBlock::kMostDistance);
      TriangleBlock both;
      EXPECT_TRUE(pack_leaves(block(base), block(base + most), both));
      EXPECT_FALSE(pack_leaves(block(base), block(base + most + 1), both));
      EXPECT_FALSE(pack_leaves(block(base + most + 1), block(base), both));
    }
  // The greatest distance that there is does not overflow.
  const auto far = [&](float x) { return make_block(random, 1, 3, [&](int) { return Vec3f{x, x, x}; }); };
  constexpr float kMost = std::numeric_limits<float>::max();
  TriangleBlock both;
  EXPECT_FALSE(pack_leaves(far(-kMost), far(kMost), both));
}

TEST(CompactBlocks, SeventeenCornersAreNotPacked) {
  TriangleRandom random(3);
  const auto block = [&](int corners, float from) {
    return make_block(random, kSize, corners, [&](int n) {
      return Vec3f{1, from + 0.001f * static_cast<float>(n), 1};
    });
  };
  TriangleBlock both;
  EXPECT_TRUE(pack_leaves(block(8, 1), block(8, 1.5f), both));
  EXPECT_FALSE(pack_leaves(block(8, 1), block(9, 1.5f), both));
  EXPECT_FALSE(pack_leaves(block(9, 1), block(8, 1.5f), both));
  EXPECT_TRUE(pack_leaves(block(16, 1), block(16, 1), both));  // the same corners
}

TEST(CompactBlocks, ScansTakeLessMemoryAndHaveTheSameHits) {
  const TriangleMesh ball = make_icosphere(6).mesh;  // 81 920 triangles
  const std::vector<Geometry> geometries = {{MeshGeometry{&ball}, {}, kNoId}};
  const auto plain = build_accel(geometries), compact = build_accel(geometries, {BuildQuality::compact});
  EXPECT_LT(compact->stats.leaf_bytes, 0.7 * static_cast<double>(plain->stats.leaf_bytes));
  EXPECT_EQ(compact->stats.leaves, plain->stats.leaves);
  EXPECT_EQ(compact->stats.node_bytes, plain->stats.node_bytes);
  std::size_t packed = 0;
  for (std::size_t b = 0; b < block_count(*compact); ++b) packed += compact->blocks[b].is_packed();
  EXPECT_EQ(block_count(*compact) + packed, block_count(*plain));

  TriangleRandom random(4);
  RayBatch rays;
  for (int i = 0; i < 3000; ++i) {
    Ray ray;
    ray.origin = random.vector() * 2, ray.direction = random.vector() * 2 - ray.origin;
    rays.push_back(ray);
  }
  const HitBatch expected = scalar_hits(*plain, rays);
  EXPECT_GT(expect_hits(*compact, rays, expected,
                        {TraceMode::single, TraceMode::packet8, TraceMode::packet16, TraceMode::interleaved,
                         TraceMode::beam, TraceMode::automatic}),
            1000);
}

}  // namespace
}  // namespace oktett::compact_blocks_test
