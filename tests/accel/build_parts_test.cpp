// Trees that are built in parts, since they hold more than is built at once.

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>
#include <limits>
#include <vector>

#include "accel/accel_data.h"
#include "accel/build/build_parts.h"
#include "accel/build/tree_store.h"
#include "core/error.h"
#include "tests/accel/child_box.h"
#include "tests/accel/same_hits.h"
#include "tests/support/triangle_cases.h"
#include "verify/oracles/mesh.h"

namespace oktett::build_parts_test {
namespace {

std::shared_ptr<const Accel> build(const std::vector<Geometry>& geometries, std::size_t together,
                                   BuildQuality quality = BuildQuality::balanced, bool parallel = true) {
  BuildOptions options{quality, parallel};
  options.together = together;
  return build_accel(geometries, options);
}

void add(TriangleMesh& mesh, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  for (const Vec3f& p : {a, b, c}) {
    mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
    mesh.positions.push_back(p);
  }
}

/// Small triangles around `center`, within `radius`.
void add_cloud(TriangleMesh& mesh, TriangleRandom& random, int count, const Vec3f& center, float radius) {
  for (int i = 0; i < count; ++i) {
    const Vec3f at = center + random.vector() * radius;
    add(mesh, at, at + random.vector() * (0.1f * radius), at + random.vector() * (0.1f * radius));
  }
}

RayBatch random_rays(std::uint64_t seed, float size) {
  TriangleRandom random(seed);
  RayBatch rays;
  for (int i = 0; i < 2000; ++i) {
    Ray ray;
    ray.origin = random.vector() * size, ray.direction = random.vector() * size - ray.origin;
    rays.push_back(ray);
  }
  return rays;
}

/// Walks a tree: boxes nest, and each node, block and entry of the table is reached once.
class Walk {
 public:
  explicit Walk(const Accel& accel)
      : accel_(accel),
        nodes_(accel.stats.nodes),
        leaves_(TriangleBlock::kLeaves * block_count(accel)),
        entries_(accel.leaves.size()) {
    visit(accel.root, accel.bounds, 0);
    EXPECT_EQ(std::ranges::count(nodes_, 1), std::ssize(nodes_));
    EXPECT_EQ(std::ranges::count(entries_, 1), std::ssize(entries_));
    EXPECT_EQ(depth_, accel.stats.depth);
  }
  std::vector<std::uint32_t> items;  ///< of triangles

 private:
  void visit(NodeRef ref, const Box& box, int depth) {
    ASSERT_LE(depth, kMaxDepth);
    if (ref.is_none()) return;
    if (!ref.is_leaf()) {
      depth_ = std::max(depth_, depth + 1);
      ++nodes_[ref.node_index()];
      const BvhNode& node = accel_.nodes[ref.node_index()];
      for (int i = 0; i < BvhNode::kWidth; ++i) {
        if (node.child[i].is_none()) continue;
        const Box child = child_box(node, i);
        EXPECT_TRUE(box.contains(child));
        visit(node.child[i], child, depth + 1);
      }
      return;
    }
    if (ref.is_triangles()) return triangles(ref.triangle_leaf(), ref.triangle_count(), box);
    ++entries_[ref.table_index()];
    const LeafEntry& entry = accel_.leaves[ref.table_index()];
    if (entry.kind == Kind::triangle) triangles(entry.begin, entry.count, box);
  }

  void triangles(std::uint32_t number, int count, const Box& box) {
    ASSERT_EQ(leaves_[number]++, 0);
    const TriangleLeaf leaf = accel_.triangles(number);
    for (int i = 0; i < count; ++i) {
      items.push_back(leaf.item(i));
      for (int k = 0; k < 3 && !accel_.pieces; ++k) EXPECT_TRUE(box.contains(leaf.vertex(k, i)));
    }
  }

  const Accel& accel_;
  std::vector<int> nodes_, leaves_, entries_;
  int depth_ = 0;
};

// Several meshes, one of them seldom finite, with triangles tested otherwise, shapes and an instance among
// them.
TEST(BuildParts, HoldEverythingOnceAndHaveTheSameHits) {
  TriangleRandom random(1);
  TriangleMesh ball = make_icosphere(5).mesh, cloud, textbook;  // 20 480 triangles
  add_cloud(cloud, random, 5000, {2, 0, 0}, 1);
  for (std::size_t i = 0; i < cloud.positions.size(); i += 30)
    cloud.positions[i].y =
        i % 60 == 0 ? std::numeric_limits<float>::infinity() : std::numeric_limits<float>::quiet_NaN();
  add_cloud(textbook, random, 3000, {-2, 0, 0}, 1);
  const auto child = build_accel({{MeshGeometry{&ball}, {}, kNoId}});
  std::vector<Geometry> geometries = {{MeshGeometry{&ball}, {}, kNoId}};
  SpheresShape spheres;
  for (int i = 0; i < 700; ++i)
    geometries.push_back({SpheresShape{{{Vec3d(random.vector() * 4), 0.05}}}, {}, kNoId});
  geometries.push_back({MeshGeometry{&cloud}, Affine::translation({0, 1, 0}), kNoId});
  geometries.push_back({MeshGeometry{&textbook, true, TriangleTest::moller_trumbore}, {}, kNoId});
  geometries.push_back({PlaneShape{{0, 1, 0}, -4}, {}, kNoId});
  geometries.push_back({InstanceGeometry{child}, Affine::translation({0, 3, 0}), kNoId});
  const RayBatch rays = random_rays(2, 5);
  for (const BuildQuality quality :
       {BuildQuality::fast, BuildQuality::balanced, BuildQuality::best, BuildQuality::compact}) {
    const auto whole = build(geometries, 1u << 25, quality);
    const HitBatch expected = scalar_hits(*whole, rays);
    for (const std::size_t together : {800u, 12000u}) {
      const auto parts = build(geometries, together, quality);
      EXPECT_EQ(parts->bounds.lo, whole->bounds.lo);
      EXPECT_EQ(parts->bounds.hi, whole->bounds.hi);
      std::vector<std::uint32_t> items = Walk(*parts).items, others = Walk(*whole).items;
      std::ranges::sort(items), std::ranges::sort(others);
      if (!whole->pieces && !parts->pieces) {
        EXPECT_EQ(items, others);
      }
      EXPECT_GT(expect_hits(*parts, rays, expected, {TraceMode::single, TraceMode::automatic}), 300);
      EXPECT_LT(parts->stats.sah_cost, 1.35 * whole->stats.sah_cost);
    }
  }
}

TEST(BuildParts, AreTheSameForAnyNumberOfThreads) {
  const TriangleMesh ball = make_icosphere(6).mesh;
  const std::vector<Geometry> geometries = {{MeshGeometry{&ball}, {}, kNoId}};
  for (const BuildQuality quality : {BuildQuality::fast, BuildQuality::compact}) {
    const auto serial = build(geometries, 10000, quality, false);
    for (const std::size_t threads : {1, 2, 5}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      const auto parallel = build(geometries, 10000, quality);
      ASSERT_EQ(parallel->stats.node_bytes, serial->stats.node_bytes);
      ASSERT_EQ(parallel->stats.leaf_bytes, serial->stats.leaf_bytes);
      EXPECT_EQ(std::memcmp(parallel->nodes.data(), serial->nodes.data(), serial->stats.node_bytes), 0);
      EXPECT_EQ(std::memcmp(parallel->blocks.data(), serial->blocks.data(), serial->stats.leaf_bytes), 0);
    }
  }
}

// Most triangles in one cell of the grid, all in one place, in a row, and nearly all far away.
TEST(BuildParts, CrowdsAreDividedWhereThatIsPossible) {
  TriangleRandom random(3);
  std::vector<TriangleMesh> meshes(4);
  add_cloud(meshes[0], random, 20000, {0, 0, 0}, 1e-4f);
  add_cloud(meshes[0], random, 100, {0, 0, 0}, 1);
  for (int i = 0; i < 5000; ++i) add(meshes[1], {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  for (int i = 0; i < 5000; ++i) {
    const auto x = static_cast<float>(i);
    add(meshes[2], {x, 0, 0}, {x + 0.5f, 0, 0}, {x, 0.5f, 0});
  }
  add_cloud(meshes[3], random, 5000, {3e38f, 0, 0}, 1e36f);
  add_cloud(meshes[3], random, 50, {-3e38f, 0, 0}, 1e30f);
  for (const TriangleMesh& mesh : meshes) {
    const std::vector<Geometry> geometries = {{MeshGeometry{&mesh}, {}, kNoId}};
    const auto whole = build(geometries, 1u << 25), parts = build(geometries, 1000);
    std::vector<std::uint32_t> items = Walk(*parts).items, others = Walk(*whole).items;
    // Large triangles may stand in several leaves.
    for (auto* list : {&items, &others}) {
      std::ranges::sort(*list);
      list->erase(std::unique(list->begin(), list->end()), list->end());
    }
    EXPECT_EQ(items, others);
    const RayBatch rays = random_rays(4, 1);
    expect_hits(*parts, rays, scalar_hits(*whole, rays), {TraceMode::automatic});
  }
  // None of them at all.
  TriangleMesh none;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (int i = 0; i < 20; ++i) add(none, {nan, 0, 0}, {1, 0, 0}, {0, 1, 0});
  EXPECT_TRUE(build({{MeshGeometry{&none}, {}, kNoId}}, 10)->root.is_none());
}

// Too little memory is told before anything is built, with what it would take.
TEST(BuildParts, TooLittleMemoryIsTold) {
  BuildOptions options;
  const std::size_t triangles = 268'000'000;
  const std::uint64_t needed = build_bytes(triangles, options);
  expect_memory(triangles, options, needed);
  try {
    expect_memory(triangles, options, needed - 1);
    ADD_FAILURE();
  } catch (const Error& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("268000000 triangles takes up to 14.5 GB"), std::string::npos) << text;
    EXPECT_NE(text.find("'compact' it takes 11.1 GB"), std::string::npos) << text;
  }
  options.quality = BuildQuality::compact;
  expect_memory(triangles, options, needed - 1);
  EXPECT_THROW(expect_memory(triangles, options, needed / 2), Error);
}

}  // namespace
}  // namespace oktett::build_parts_test
