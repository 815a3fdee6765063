#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include "accel/accel.h"
#include "core/error.h"
#include "tests/support/limits.h"

namespace oktett::query_test {
namespace {

/// A wavy sheet of triangles over the square [-3, 3]^2 of x and z.
TriangleMesh sheet() {
  constexpr std::uint32_t side = 40;
  TriangleMesh mesh;
  for (std::uint32_t j = 0; j <= side; ++j)
    for (std::uint32_t i = 0; i <= side; ++i) {
      const float x = 6.0f * i / side - 3, z = 6.0f * j / side - 3;
      mesh.positions.push_back({x, 0.3f * std::sin(3 * x) * std::cos(2 * z), z});
    }
  for (std::uint32_t j = 0; j < side; ++j)
    for (std::uint32_t i = 0; i < side; ++i) {
      const std::uint32_t a = j * (side + 1) + i, b = a + side + 1;
      for (const std::uint32_t v : {a, b, a + 1, a + 1, b, b + 1}) mesh.indices.push_back(v);
    }
  return mesh;
}

/// Triangles, spheres, a torus and an instance of them all.
std::shared_ptr<const Accel> mixed_scene(const TriangleMesh& mesh) {
  std::vector<Geometry> things(3);
  things[0].shape = MeshGeometry{&mesh};
  things[1].shape = SpheresShape{{{{1, 1, 0}, 0.5}, {{-1, 1, 1}, 0.25}}};
  things[2].shape = ExactShape{TorusShape{}};
  things[2].transform = Affine::translation({0, 1.5, -1});
  const auto child = build_accel(things);
  things.push_back({InstanceGeometry{child}, Affine::translation({4, 0.5, 2}), 7});
  return build_accel(things);
}

/// Half of the rays start at one point, half anywhere; some hit nothing by their numbers.
std::vector<Ray> mixed_rays(std::size_t count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> number(-1, 1);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3f target = Vec3f{number(random), number(random), number(random)} * 3.0f;
    Ray ray{{0, 5, 0}, 0, {}, i % 7 == 0 ? 0.9f : kInf};
    if (i >= count / 2) ray.origin = Vec3f{number(random), number(random), number(random)} * 6.0f;
    ray.direction = target - ray.origin;
    if (i % 97 == 5) ray.direction = {};
    if (i % 97 == 6) ray.origin.x = std::numeric_limits<float>::quiet_NaN();
    rays.push_back(ray);
  }
  return rays;
}

// Columns, arrays of structures and single rays are answered with the same bits, for batches around the sizes
// of packets, beams and pieces.
TEST(Query, AllWaysToAskGiveTheSameBits) {
  const TriangleMesh mesh = sheet();
  const auto accel = mixed_scene(mesh);
  std::size_t hit_count = 0;
  for (const std::size_t count : {0, 1, 2, 3, 7, 8, 9, 255, 257, 4096, 9001}) {
    const std::vector<Ray> rays = mixed_rays(count);
    RayBatch columns;
    for (const Ray& ray : rays) columns.push_back(ray);
    for (const Isa isa : available_isas()) {
      HitBatch expected;
      expected.resize_uninitialized(count);
      std::vector<std::uint8_t> occluded(count, 2), structures_occluded(count, 2);
      std::vector<Hit> hits(count, Hit{-1, -1, -1, 0, 0});
      closest_hit(*accel, columns, expected, isa);
      any_hit(*accel, columns, occluded, isa);
      closest_hit(*accel, rays, hits, isa);
      any_hit(*accel, rays, structures_occluded, isa);
      for (std::size_t i = 0; i < count; ++i) {
        ASSERT_EQ(hits[i], expected[i]) << to_string(isa) << ", ray " << i << " of " << count;
        ASSERT_EQ(closest_hit(*accel, rays[i], isa), expected[i]);
        ASSERT_EQ(occluded[i], expected[i].valid() ? 1 : 0);
        ASSERT_EQ(structures_occluded[i], occluded[i]);
        ASSERT_EQ(any_hit(*accel, rays[i], isa), occluded[i] == 1);
        hit_count += hits[i].valid();
      }
    }
  }
  EXPECT_GT(hit_count, 1000u);
}

/// The lists of a batch, in columns and as structures, against those of single rays.
void expect_same_lists(const Accel& accel, const std::vector<Ray>& rays, Isa isa) {
  RayBatch columns;
  for (const Ray& ray : rays) columns.push_back(ray);
  // What the lists hold from an earlier call must not matter.
  HitLists lists{{{1, 2, 3, 4, 5}}, {0, 1}}, structure_lists;
  std::vector<std::uint32_t> counts(rays.size(), 77), structure_counts(rays.size(), 77);
  all_hits(accel, columns, lists, isa);
  all_hits(accel, rays, structure_lists, isa);
  count_hits(accel, columns, counts, isa);
  count_hits(accel, rays, structure_counts, isa);
  ASSERT_EQ(lists.begin.size(), rays.size() + 1);
  ASSERT_EQ(lists.begin.back(), lists.hits.size());
  ASSERT_EQ(lists.begin, structure_lists.begin);
  ASSERT_EQ(lists.hits, structure_lists.hits);
  std::vector<Hit> one;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    all_hits(accel, rays[i], one, Isa::scalar);
    ASSERT_TRUE(std::ranges::equal(one, lists.of_ray(i))) << to_string(isa) << ", ray " << i;
    ASSERT_EQ(counts[i], one.size());
    ASSERT_EQ(structure_counts[i], one.size());
  }
}

// For batches around the sizes of the groups and pieces in which they are traced.
TEST(Query, EveryHitOfABatchIsThatOfSingleRays) {
  const TriangleMesh mesh = sheet();
  const auto mixed = mixed_scene(mesh), meshes = build_accel({{MeshGeometry{&mesh}, {}, kNoId}});
  std::vector<Geometry> with_plane = {{MeshGeometry{&mesh}, {}, kNoId}, {PlaneShape{}, {}, kNoId}};
  const auto unbounded = build_accel(with_plane);
  for (const Isa isa : available_isas())
    for (const std::size_t count : {0, 1, 2, 15, 255, 256, 257, 4096, 4097, 9001}) {
      expect_same_lists(*meshes, mixed_rays(count), isa);
      if (count > 4096) continue;
      expect_same_lists(*mixed, mixed_rays(count), isa);
      expect_same_lists(*unbounded, mixed_rays(count), isa);
    }
}

// Trees whose root is a leaf, or that hold nothing.
TEST(Query, EveryHitInTheSmallestTrees) {
  TriangleMesh one;
  for (const Vec3f& p : {Vec3f{-2, 0, -2}, Vec3f{2, 0, -2}, Vec3f{0, 0, 3}}) one.positions.push_back(p);
  for (std::uint32_t c = 0; c < 3; ++c) one.indices.push_back(c);
  const auto triangle = build_accel({{MeshGeometry{&one}, {}, kNoId}});
  const auto sphere = build_accel({{SpheresShape{{{{0, 1, 0}, 1}}}, {}, kNoId}});
  for (const Isa isa : available_isas())
    for (const auto& accel : {triangle, sphere, build_accel({})})
      expect_same_lists(*accel, mixed_rays(300), isa);
}

// A ray in the plane of many triangles meets thousands of boxes, and one through a stack of sheets thousands
// of triangles: the lists of pairs must have room.
TEST(Query, EveryHitAmongThousands) {
  TriangleMesh stack;
  for (std::uint32_t k = 0; k < 5000; ++k) {
    const float y = 0.001f * static_cast<float>(k);
    for (const Vec3f& p : {Vec3f{-1, y, -1}, Vec3f{1, y, -1}, Vec3f{0, y, 1}}) stack.positions.push_back(p);
    for (std::uint32_t c = 0; c < 3; ++c) stack.indices.push_back(3 * k + c);
  }
  const auto accel = build_accel({{MeshGeometry{&stack}, {}, kNoId}});
  std::vector<Ray> rays;
  for (int i = 0; i < 600; ++i) {
    const float x = 0.0005f * static_cast<float>(i);
    rays.push_back(i % 3 == 0 ? Ray{{-5, 2, x}, 0, {1, 0, 0}, kInf} : Ray{{x, -1, 0}, 0, {0, 1, 0}, kInf});
  }
  std::vector<std::uint32_t> counts(rays.size());
  count_hits(*accel, rays, counts);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (i % 3 != 0) {
      ASSERT_EQ(counts[i], 5000u) << i;
    }
  }
  for (const Isa isa : available_isas()) expect_same_lists(*accel, {rays.begin(), rays.begin() + 40}, isa);
}

TEST(Query, DefaultInstructionSetGivesTheSameBits) {
  const TriangleMesh mesh = sheet();
  const auto accel = mixed_scene(mesh);
  std::vector<Hit> all;
  for (const Ray& ray : mixed_rays(100)) {
    EXPECT_EQ(closest_hit(*accel, ray), closest_hit(*accel, ray, Isa::scalar));
    all_hits(*accel, ray, all);
    EXPECT_EQ(any_hit(*accel, ray), !all.empty());
  }
}

TEST(Query, SizesThatDifferAreErrors) {
  const auto accel = build_accel({});
  const std::vector<Ray> rays(3);
  RayBatch columns;
  for (const Ray& ray : rays) columns.push_back(ray);
  for (const std::size_t room : {0, 2, 4}) {
    std::vector<Hit> hits(room);
    HitBatch hit_columns;
    hit_columns.resize_uninitialized(room);
    std::vector<std::uint8_t> occluded(room);
    EXPECT_THROW(closest_hit(*accel, rays, hits), Error);
    EXPECT_THROW(closest_hit(*accel, columns, hit_columns), Error);
    EXPECT_THROW(any_hit(*accel, rays, occluded), Error);
    EXPECT_THROW(any_hit(*accel, columns, occluded), Error);
    std::vector<std::uint32_t> counts(room);
    EXPECT_THROW(count_hits(*accel, rays, counts), Error);
    EXPECT_THROW(count_hits(*accel, columns, counts), Error);
  }
  try {
    std::vector<Hit> hits(4);
    closest_hit(*accel, rays, hits);
    FAIL();
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(), "closest_hit: 3 rays, but room for 4 answers");
  }
  const std::vector<std::uint32_t> which(InteractionBlock::kMost + 1, 0);
  InteractionBlock block;
  HitBatch hits;
  hits.resize_uninitialized(3);
  EXPECT_THROW(surface_interactions(*accel, columns, hits, which, block), Error);
}

}  // namespace
}  // namespace oktett::query_test
