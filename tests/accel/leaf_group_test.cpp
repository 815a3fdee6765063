#include "accel/traverse/inflight/inflight_traversal.h"

#include <gtest/gtest.h>

#include <memory>
#include <type_traits>
#include <vector>

#include "tests/accel/same_hits.h"
#include "tests/support/limits.h"
#include "verify/cases/kernel_cases.h"

namespace oktett::leaf_group_test {
namespace {

/// Triangles of which every second one is level, at each of `heights` in turn.
TriangleMesh triangles_in_planes(CaseRandom& random, int count, double size,
                                 const std::vector<double>& heights) {
  TriangleMesh mesh;
  for (int i = 0; i < count; ++i) {
    const Vec3d center = random.vector();
    for (int k = 0; k < 3; ++k) {
      Vec3d corner = center + random.vector() * size;
      if (i % 2 == 0) corner.z = heights[static_cast<std::size_t>(i) / 2 % heights.size()];
      mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
      mesh.positions.push_back(Vec3f(corner));
    }
  }
  return mesh;
}

/// Ray `i` of a batch in which some rays end at `to`, start half way, are level, or are not valid.
Ray ray_between(int i, const Vec3d& from, const Vec3d& to) {
  Ray ray{Vec3f(from), 0, Vec3f(to - from), i % 5 == 0 ? 1.0f : kInf};
  if (i % 7 == 0) ray.tmin = 0.5f;
  if (i % 11 == 0) ray.direction.z = 0;
  if (i % 113 == 0) ray.direction.x = kNan;
  return ray;
}

// Without instances nothing sets the tree that a ray is in, so whatever is there must not part the rays.
TEST(Interleaved, RaysAtOneLeafOfExactSurfacesGoTogether) {
  constexpr std::size_t kRays = 6;
  const auto accel = build_accel({{ExactShape{TorusShape{}}, {}, kNoId}});
  ASSERT_TRUE(accel->root.is_leaf());
  const NodeRef elsewhere = NodeRef::leaf(accel->root.table_index() + 1, Kind::plane);
  std::vector<InflightRay> inflight(kRays);
  const auto gather = [&](auto instances, std::uint32_t instance, int most) {
    InflightRay* rays[kRays];
    for (std::uint32_t i = 0; i < kRays; ++i) {
      rays[i] = &inflight[i];
      inflight[i].current = i == 1 || i == 2 ? elsewhere : accel->root;
      inflight[i].in.instance = instance;
    }
    const int count = rays_at_leaf<instances.value>(rays, rays + kRays, most);
    for (int i = 0; i < count; ++i) EXPECT_EQ(rays[i]->current.bits(), accel->root.bits()) << i;
    return count;
  };
  for (const std::uint32_t instance : {0u, 77u, kNoInstance})
    EXPECT_EQ(gather(std::false_type{}, instance, 8), 4) << instance;
  EXPECT_EQ(gather(std::false_type{}, 0, 3), 3);
  EXPECT_EQ(gather(std::true_type{}, kNoInstance, 8), 4);
  EXPECT_EQ(gather(std::true_type{}, 0, 8), 0);
}

/// Spheres, planes and triangles, many of which are there twice, so that their items decide which is hit.
/// Planes that pass through the triangles tie with them.
TEST(Interleaved, SpheresAndPlanesAmongTriangles) {
  CaseRandom random(41);
  const TriangleMesh mesh = triangles_in_planes(random, 60, 0.2, {0.25});
  std::vector<SphereShape> balls;
  for (int i = 0; i < 200; ++i) balls.push_back({random.vector(), i % 3 == 0 ? 0.2 : 0.03});
  RayBatch rays;
  for (int i = 0; i < 3000; ++i) {
    const Vec3d from = random.vector() * (i % 4 == 0 ? 20 : 1.2);
    const Vec3d to = i % 2 == 0 ? random.vector() : balls[random.bits() % balls.size()].center;
    rays.push_back(ray_between(i, from, to));
  }
  // With planes and without, in either order, and spheres before and after the triangles.
  for (int order = 0; order < 4; ++order) {
    std::vector<Geometry> geometries;
    const auto add_planes = [&] {
      for (const double height : {0.25, -0.9, 0.25})
        geometries.push_back({PlaneShape{{0, 0, 1}, height}, {}, kNoId});
    };
    if (order == 1) add_planes();
    if (order % 2 == 0) geometries.push_back({MeshGeometry{&mesh}, {}, kNoId});
    geometries.push_back({SpheresShape{balls}, {}, kNoId});
    if (order % 2 == 1) geometries.push_back({MeshGeometry{&mesh}, {}, kNoId});
    geometries.push_back({SpheresShape{balls}, {}, kNoId});
    if (order == 2) add_planes();
    const auto accel = build_accel(geometries);
    const int hits = expect_hits(*accel, rays, scalar_hits(*accel, rays),
                                 {TraceMode::interleaved, TraceMode::single, TraceMode::automatic},
                                 "order " + std::to_string(order));
    EXPECT_GT(hits, 1500);
  }
}

/// With few shapes of each closed form, many rays in flight are at the same leaf. All shapes are there twice,
/// so that their items decide which is hit. Triangles in the planes of polygons and of faces of boxes tie
/// with them. One, three and eight shapes of a kind fill a leaf in part or whole.
TEST(Interleaved, RaysAtOneLeafOfClosedFormsAndCombinationsGoTogether) {
  CaseRandom random(43);
  const TriangleMesh mesh = triangles_in_planes(random, 40, 0.3, {0.25, -0.5});
  RayBatch rays;
  for (int i = 0; i < 3000; ++i) {
    const Vec3d from = random.vector() * (i % 4 == 0 ? 20 : 1.2);
    rays.push_back(ray_between(i, from, random.vector()));
  }
  auto bite = std::make_shared<CsgExpression>();
  bite->op = CsgOp::subtract;
  bite->children.push_back({CsgOp::operand, {{BoxShape{{-0.9, -0.9, -0.5}, {-0.2, -0.2, 0.25}}, {}, 0}}, {}});
  bite->children.push_back({CsgOp::operand, {{SpheresShape{{{{-0.3, -0.3, 0}, 0.3}}}, {}, 1}}, {}});
  for (const int count : {1, 3, 8}) {
    std::vector<Geometry> once;
    for (int i = 0; i < count; ++i) {
      const double at = 0.2 * i - 0.7;
      once.push_back(
          {PolygonShape{{{at, -0.8, 0.25}, {at + 0.5, -0.8, 0.25}, {at + 0.2, 0.9, 0.25}}}, {}, kNoId});
      once.push_back({BoxShape{{at, 0.1, -0.5}, {at + 0.15, 0.6, 0.25}}, {}, kNoId});
      once.push_back({DiskShape{{at, 0, -0.5}, {0, 0, 1}, 0.3}, {}, kNoId});
      once.push_back({SpheresShape{{{{at, 0.5, 0.5}, 0.2}}}, {}, kNoId});
      if (i < 2) once.push_back({CsgGeometry{bite}, {}, kNoId});
    }
    std::vector<Geometry> geometries = once;
    geometries.push_back({MeshGeometry{&mesh}, {}, kNoId});
    geometries.insert(geometries.end(), once.begin(), once.end());
    const auto accel = build_accel(geometries);
    const int hits = expect_hits(*accel, rays, scalar_hits(*accel, rays),
                                 {TraceMode::interleaved, TraceMode::single, TraceMode::automatic},
                                 std::to_string(count) + " of each");
    EXPECT_GT(hits, 800);
  }
}

}  // namespace
}  // namespace oktett::leaf_group_test
