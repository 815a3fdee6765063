#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "accel/accel_data.h"
#include "accel/build/tree_store.h"
#include "tests/accel/child_box.h"
#include "tests/support/grid_triangles.h"
#include "tests/support/limits.h"
#include "verify/cases/kernel_cases.h"
#include "verify/checks/compare_mode.h"
#include "verify/oracles/mesh.h"

namespace oktett::build_test {
namespace {

std::shared_ptr<const Accel> build(const TriangleMesh& mesh, bool parallel = true) {
  BuildOptions options;
  options.parallel = parallel;
  return build_accel({{MeshGeometry{&mesh}, {}, kNoId}}, options);
}

void add(TriangleMesh& m, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  for (const Vec3f& p : {a, b, c}) {
    m.indices.push_back(static_cast<std::uint32_t>(m.positions.size()));
    m.positions.push_back(p);
  }
}

TriangleMesh random_triangles(int count, double spread, double size, std::uint64_t seed) {
  TriangleMesh m;
  CaseRandom r(seed);
  for (int i = 0; i < count; ++i) {
    const Vec3d c = r.vector() * spread;
    add(m, Vec3f(c + r.vector() * size), Vec3f(c + r.vector() * size), Vec3f(c + r.vector() * size));
  }
  return m;
}

/// Walks the tree and counts in how many leaves each triangle stands. Checks that boxes enclose their
/// children.
class TreeWalk {
 public:
  TreeWalk(const Accel& accel, std::size_t items) : count(items, 0), accel_(accel) {
    if (!accel.root.is_none()) visit(accel.root, accel.bounds, 0);
  }
  std::vector<int> count;
  int depth = 0;

 private:
  void visit(NodeRef ref, const Box& box, int level) {
    depth = std::max(depth, level);
    if (ref.is_triangles()) {
      const TriangleLeaf block = accel_.triangles(ref.triangle_leaf());
      for (int i = 0; i < ref.triangle_count(); ++i) {
        ++count[block.item(i)];
        for (int k = 0; k < 3; ++k) EXPECT_TRUE(box.contains(block.vertex(k, i)));
      }
      return;
    }
    if (ref.is_leaf()) return;
    const BvhNode& node = accel_.nodes[ref.node_index()];
    for (int i = 0; i < BvhNode::kWidth; ++i) {
      if (node.child[i].is_none()) continue;
      const Box child = child_box(node, i);
      EXPECT_TRUE(box.contains(child));
      visit(node.child[i], child, level + 1);
    }
  }
  const Accel& accel_;
};

void expect_whole_tree(const Accel& accel, std::size_t items) {
  const TreeWalk walk(accel, items);
  for (std::size_t i = 0; i < items; ++i) ASSERT_EQ(walk.count[i], 1) << "triangle " << i;
  EXPECT_LE(walk.depth, kMaxDepth);
}

/// Every lane of every block holds the corners of its triangle, bit by bit, or nothing. Returns how many
/// triangles the fullest block has.
int expect_corners(const Accel& accel, const TriangleMesh& mesh) {
  int most = 0;
  for (std::size_t b = 0; b < block_count(accel); ++b) {
    const TriangleLeaf block = accel.triangles(static_cast<std::uint32_t>(TriangleBlock::kLeaves * b));
    int count = 0;
    for (int lane = 0; lane < TriangleBlock::kSize; ++lane) {
      if (block.item(lane) == kNoId) {
        EXPECT_EQ(block.corners()[lane], 0);
        continue;
      }
      ++count;
      for (int k = 0; k < 3; ++k) {
        const Vec3f &has = mesh.positions[mesh.indices[3 * block.item(lane) + static_cast<std::size_t>(k)]],
                    got = block.vertex(k, lane);
        for (int axis = 0; axis < 3; ++axis)
          EXPECT_EQ(std::bit_cast<std::uint32_t>(got[axis]), std::bit_cast<std::uint32_t>(has[axis]));
      }
    }
    most = std::max(most, count);
  }
  return most;
}

/// A square of 40 x 40 cells of two triangles each.
TriangleMesh grid() {
  TriangleMesh m;
  for (int y = 0; y <= 40; ++y)
    for (int x = 0; x <= 40; ++x) m.positions.push_back({static_cast<float>(x), static_cast<float>(y), 0});
  add_grid_triangles(m, 40);
  return m;
}

TEST(Build, BlocksHoldTheCornersOfTheirTriangles) {
  const TriangleMesh shared = grid();
  EXPECT_EQ(expect_corners(*build(shared), shared), 8);
  // The same places under numbers of their own, as in files without indices.
  TriangleMesh apart;
  for (std::size_t i = 0; i < shared.indices.size(); i += 3)
    add(apart, shared.positions[shared.indices[i]], shared.positions[shared.indices[i + 1]],
        shared.positions[shared.indices[i + 2]]);
  EXPECT_EQ(expect_corners(*build(apart), apart), 8);
  // Sixteen corners are those of five triangles that share none.
  const TriangleMesh loose = random_triangles(2000, 1, 0.1, 5);
  EXPECT_EQ(expect_corners(*build(loose), loose), 5);
  // Zeros of both signs are one place, but not the same bits.
  TriangleMesh zeros = apart;
  for (std::size_t i = 0; i < zeros.positions.size(); i += 2) zeros.positions[i].z = -0.0f;
  expect_corners(*build(zeros), zeros);
}

TEST(Build, EmptySceneIsNeverHit) {
  const auto accel = build_accel({});
  EXPECT_TRUE(bounds(*accel).empty());
  RayBatch rays;
  for (int i = 0; i < 9; ++i) rays.push_back({{0, 0, 0}, 0, {1, 2, 3}, kInf});
  HitBatch hits;
  hits.resize_uninitialized(9);
  std::vector<Hit> all;
  for (const Isa isa : available_isas()) {
    std::uint8_t occluded[9];
    closest_hit(*accel, rays.span(), hits.span(), isa);
    any_hit(*accel, rays.span(), occluded, isa);
    all_hits(*accel, rays[0], all, isa);
    EXPECT_TRUE(all.empty());
    for (std::size_t i = 0; i < 9; ++i) EXPECT_TRUE(!hits[i].valid() && !occluded[i]);
  }
}

TEST(Build, EachTriangleStandsInOneLeafInsideItsBoxes) {
  for (const int count : {1, 2, 7, 8, 9, 63, 64, 65, 5000}) {
    const TriangleMesh m = random_triangles(count, 1, 0.1, static_cast<std::uint64_t>(count));
    expect_whole_tree(*build(m), m.triangle_count());
  }
}

TEST(Build, IdenticalTrianglesAndCentersEndInATree) {
  TriangleMesh same;
  for (int i = 0; i < 3000; ++i) add(same, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  expect_whole_tree(*build(same), 3000);
  TriangleMesh concentric;
  for (int i = 0; i < 100000; ++i) {
    const float s = static_cast<float>(i % 1000 + 1);
    add(concentric, {-s, -s, 0}, {s, -s, 0}, {0, s, 0});
  }
  expect_whole_tree(*build(concentric), 100000);
}

// At equal distance the lowest number wins, whatever the tree looks like.
TEST(Build, LowestOfIdenticalTrianglesIsHit) {
  TriangleMesh same;
  for (int i = 0; i < 300; ++i) add(same, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const auto accel = build(same);
  RayBatch rays;
  for (int i = 0; i < 16; ++i)
    rays.push_back({{0.2f, 0.3f, 1 + 0.01f * static_cast<float>(i)}, 0, {0, 0, -1}, kInf});
  HitBatch hits;
  hits.resize_uninitialized(16);
  for (const Isa isa : available_isas())
    for (const TraceMode mode : kTraceModes) {
      closest_hit(*accel, rays.span(), hits.span(), isa, mode);
      for (std::size_t i = 0; i < 16; ++i) EXPECT_EQ(hits[i].item, 0u);
    }
}

// Those with corners at one place stay: no ray hits them, but they may be the nearest to a point.
TEST(Build, TrianglesThatAreNotFiniteAreLeftOut) {
  TriangleMesh m;
  add(m, {kNan, 0, 0}, {1, 0, 0}, {0, 1, 0});
  add(m, {0, 0, 0}, {1, 0, kInf}, {0, 1, 0});
  add(m, {0, 0, 0}, {0, 0, 0}, {0, 1, 0});
  add(m, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const TreeWalk walk(*build(m), 4);
  EXPECT_EQ(walk.count, (std::vector<int>{0, 0, 1, 1}));
  TriangleMesh hopeless;
  for (int i = 0; i < 20; ++i) add(hopeless, {kNan, kNan, kNan}, {kInf, 0, 0}, {0, 1, 0});
  EXPECT_TRUE(bounds(*build(hopeless)).empty());
}

// A scene of any scale gets the same tree: areas neither overflow nor vanish.
TEST(Build, QualityDoesNotDependOnScale) {
  const TriangleMesh m = make_icosphere(3).mesh;
  const double cost = stats(*build(m)).sah_cost;
  for (const double scale : {0x1p70, 0x1p100, 0x1p-70, 0x1p-100}) {
    const TriangleMesh scaled = placed(m, scale, {0, 0, 0});
    EXPECT_NEAR(stats(*build(scaled)).sah_cost, cost, 1e-3 * cost) << scale;
  }
}

TEST(Build, HugeCoordinatesStayFinite) {
  TriangleMesh m = random_triangles(500, 1e38, 1e37, 5);
  add(m, {-3e38f, -3e38f, -3e38f}, {3e38f, 0, 0}, {0, 3e38f, 3e38f});
  expect_whole_tree(*build(m), m.triangle_count());
}

// Large enough for every step to be shared out among threads.
TEST(Build, ParallelAndSerialTreesGiveTheSameHits) {
  const TriangleMesh m = random_triangles(200000, 1, 0.01, 11);
  const auto parallel = build(m), serial = build(m, false);
  RayBatch rays;
  CaseRandom r(3);
  for (int i = 0; i < 4000; ++i) rays.push_back({Vec3f(r.vector() * 2.0), 0, Vec3f(r.vector()), kInf});
  HitBatch a, b;
  a.resize_uninitialized(rays.size()), b.resize_uninitialized(rays.size());
  closest_hit(*parallel, rays.span(), a.span(), default_isa());
  closest_hit(*serial, rays.span(), b.span(), default_isa());
  int hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(a[i], b[i]) << i;
    hits += a[i].valid();
  }
  EXPECT_GT(hits, 300);
}

TEST(Build, LeavesOfSpheresAreAligned) {
  CaseRandom r(7);
  SpheresShape spheres;
  for (int i = 0; i < 1000; ++i) spheres.spheres.push_back({r.vector() * 10.0, 0.1});
  const auto accel = build_accel({{spheres, {}, kNoId}});
  const auto& pool = std::get<Sphere::Pool>(accel->pools);
  std::vector<int> seen(spheres.spheres.size(), 0);
  for (const LeafEntry& leaf : accel->leaves) {
    EXPECT_EQ(leaf.begin % 8, 0u);
    for (std::uint32_t k = leaf.begin; k < leaf.begin + leaf.count; ++k) {
      const SphereShape& s = spheres.spheres[pool.item[k]];
      EXPECT_EQ(Sphere::shape(pool, k).center, s.center);
      EXPECT_EQ(Sphere::shape(pool, k).radius, s.radius);
      ++seen[pool.item[k]];
    }
  }
  EXPECT_TRUE(std::ranges::all_of(seen, [](int n) { return n == 1; }));
}

}  // namespace
}  // namespace oktett::build_test
