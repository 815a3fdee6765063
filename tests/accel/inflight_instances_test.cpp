/// \file Rays in flight through instances: every set and mode finds what the scalar code finds, and that is
/// what asking each instance by itself finds.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "accel/accel_data.h"
#include "accel/traverse/inflight/triangle_steps.h"
#include "tests/accel/instance_cases.h"
#include "tests/support/triangle_cases.h"

namespace oktett::inflight_instances_test {
namespace {

/// Rays from and to points of a cube of half edge `far`. Some start or end where others do, some run along an
/// axis, some are not rays, some have a direction that is `stretch` times as long.
RayBatch rays_in(double far, int count, std::uint64_t seed, float stretch = 1e14f) {
  RayBatch rays;
  CaseRandom r(seed);
  for (int i = 0; i < count; ++i) {
    const Vec3f from(i / 64 % 3 == 0 ? Vec3d{far, far / 2, -far} : r.vector() * far), to(r.vector() * far);
    Ray ray{from, i % 9 == 0 ? 0.2f : 0, to - from, i % 4 == 0 ? 1 : i % 4 == 1 ? 0.3f : kInf};
    if (i % 11 == 0) ray.direction[static_cast<int>(r.bits() % 3)] = i % 2 == 0 ? 0.0f : 1e-39f;
    if (i % 13 == 0) ray.direction = {0, 0, i % 2 == 0 ? 1.0f : -3.0f};
    if (i % 97 == 0) ray.direction.y = std::numeric_limits<float>::quiet_NaN();
    if (i % 89 == 0) ray.origin.x = kInf;
    if (i % 101 == 0) ray.direction = ray.direction * stretch;
    rays.push_back(ray);
  }
  return rays;
}

// Thousands of instances that overlap, of trees of few triangles, of many, and of triangles in pieces: all
// places in flight are in instances at once.
TEST(InflightInstances, ManyThatOverlap) {
  const Crowd crowd;
  const RayBatch rays = rays_in(9, 6000, 5);
  EXPECT_GT(expect_same_hits(*crowd.accel, rays), 3000);
  expect_asked_each(*crowd.accel, rays, 23, TraceMode::interleaved);
}

// The same instance several times, and instances of meshes that hold the same triangles: the first of the
// nearest counts, wherever the ray goes first.
TEST(InflightInstances, Ties) {
  TriangleMesh twice = soup(60, 6, 0.3);
  const TriangleMesh once = twice;
  for (const std::uint32_t i : once.indices) twice.indices.push_back(i);
  InstanceList list{{tree_of(once), tree_of(twice), tree_of(twice, BuildQuality::best)}, {}};
  CaseRandom r(7);
  for (int i = 0; i < 40; ++i) {
    const Affine at = Affine::translation(r.vector() * 2.0) * turned(r, 0.5);
    for (std::uint32_t k = 0; k < 7; ++k) list.places.push_back(place(at, (k + r.bits()) % 3));
  }
  const AccelPtr accel = build_accel({{list, {}, kNoId}});
  const RayBatch rays = rays_in(3, 4000, 8);
  EXPECT_GT(expect_same_hits(*accel, rays), 1500);
  expect_asked_each(*accel, rays, 7, TraceMode::interleaved);
}

// Maps that mirror, shear, flatten nearly, or scale to where the fast arithmetic is not made for. What is
// inside is scaled so that all of them stand about the origin.
TEST(InflightInstances, UnusualMaps) {
  const TriangleMesh unit = soup(100, 9, 0.2);
  CaseRandom r(10);
  for (const double scale : {1.0, 1e-4, 1e-13, 1e-20, 1e6, 1e12}) {
    TriangleMesh mesh = unit;
    for (Vec3f& p : mesh.positions) p = Vec3f(Vec3d(p) * scale);
    const auto [mixed, listed] = unusual_maps(mesh, scale, r);
    const RayBatch rays = rays_in(3, 1500, 11, scale > 1 ? 10 : 1e14f);
    EXPECT_GT(expect_same_hits(*mixed, rays), 300) << scale;
    expect_asked_each(*listed, rays, 11, TraceMode::interleaved);
    if (HasFailure()) return;
  }
}

/// Triangles that are hard to decide, each in a tree of its own that is shown as it is, and rays at them.
TEST(InflightInstances, AdversarialTriangles) {
  for (const float scale : {1.0f, 1e-9f, 1e10f}) {
    TriangleRandom random(static_cast<std::uint64_t>(std::ilogb(scale) + 500));
    std::vector<TriangleMesh> meshes(40);
    RayBatch rays;
    for (TriangleMesh& mesh : meshes)
      for (int i = 0; i < 12; ++i) add_case(adversarial_case(random, scale), mesh, rays);
    std::vector<Geometry> plain, shown;
    for (const TriangleMesh& mesh : meshes) {
      plain.push_back({MeshGeometry{&mesh}, {}, kNoId});
      shown.push_back({InstanceGeometry{tree_of(mesh)}, {}, kNoId});
    }
    const AccelPtr a = build_accel(plain), b = build_accel(shown);
    EXPECT_GT(expect_same_hits(*b, rays), 400);
    // An instance that moves nothing changes no bit of a distance.
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Hit h = closest_hit(*a, rays[i]), k = closest_hit(*b, rays[i]);
      ASSERT_TRUE(h.valid() == k.valid() &&
                  (!h.valid() || std::bit_cast<std::uint32_t>(h.t) == std::bit_cast<std::uint32_t>(k.t)))
          << scale << " ray " << i;
    }
  }
}

// Instances of instances, of closed forms, of planes, of textbook triangles and of trees of one leaf, next to
// meshes, also as leaves of several instances.
TEST(InflightInstances, NestedAndOfOtherShapes) {
  const TriangleMesh mesh = soup(150, 12, 0.2), one = soup(1, 13, 0.5);
  const AccelPtr leaf = tree_of(mesh);
  CaseRandom r(14);
  std::vector<Geometry> mixed = {{MeshGeometry{&mesh, true, TriangleTest::badouel}, {}, kNoId}};
  for (int k = 0; k < 20; ++k) mixed.push_back({SpheresShape{{{r.vector(), 0.2}}}, {}, kNoId});
  mixed.push_back({InstanceGeometry{leaf}, turned(r, 0.7), kNoId});
  const AccelPtr children[] = {
      build_accel(mixed), build_accel({{PlaneShape{{0, 0, 1}, -3}, {}, 8}, {MeshGeometry{&mesh}, {}, kNoId}}),
      tree_of(one), leaf, build_accel({{SpheresShape{{{{0, 0, 0}, 1}}}, {}, 7}})};
  std::vector<Geometry> geometries = {{MeshGeometry{&mesh}, {}, kNoId}};
  for (std::size_t k = 0; k < 80; ++k) {
    const Affine at = Affine::translation(r.vector() * 3.0) * turned(r, 0.6);
    if (k % 16 == 1)
      geometries.push_back({InstanceGeometry{children[1]}, at, kNoId});
    else
      for (int copies = k % 3 == 0 ? 3 : 1; copies > 0; --copies)
        geometries.push_back({InstanceGeometry{children[k % 16 == 1  ? 1
                                                        : k % 5 == 1 ? 0
                                                                     : k % 5]},
                              at, kNoId});
  }
  const RayBatch rays = rays_in(4, 3000, 15);
  const AccelPtr inner = build_accel(geometries);
  EXPECT_GT(expect_same_hits(*inner, rays), 1000);
  const AccelPtr outer = build_accel({{InstanceGeometry{inner}, turned(r, 0.9), kNoId},
                                      {InstanceGeometry{leaf}, turned(r, 2), kNoId},
                                      {InstanceGeometry{inner}, Affine::translation({1, 0, 2}), kNoId}});
  EXPECT_GT(expect_same_hits(*outer, rays), 1000);
}

// What the ray has on its stack from outside is compared with a limit that allows for the errors on both
// sides, in an instance near the origin of its child as in one far from it.
TEST(InflightInstances, LimitsAllowForBothSides) {
  using A = ScalarIsa;
  constexpr int W = 8;
  const TriangleMesh mesh = soup(20, 16, 0.3);
  TriangleMesh far = mesh;
  for (Vec3f& p : far.positions) p = p + Vec3f{5000, 0, 0};
  const AccelPtr accel =
      build_accel({{InstanceGeometry{tree_of(mesh)}, Affine::translation({1000, 0, 0}), kNoId},
                   {InstanceGeometry{tree_of(far)}, Affine::translation({-5000, 0, 0}), kNoId}});
  ASSERT_EQ(accel->instances.size(), 2u);
  bool greater_inside = false, greater_outside = false;
  for (std::uint32_t number = 0; number < 2; ++number) {
    const Vec3f target{accel->instances[number].item == 0 ? 1000.0f : 0.0f, 0, 0};
    RayBatch rays;
    rays.push_back({target + Vec3f{0, 3, 4}, 0, {0, -3, -4}, kInf});
    const auto chunk = std::make_unique<RayChunk<W, A>>();
    chunk->set(rays.span(), 0, box_extent(accel->bounds));
    const auto ray = std::make_unique<InflightRay>();
    start_ray(*ray, *chunk, 0, accel->root, true);
    ray->in.set(*accel);
    const InflightHead outer = *ray;
    const auto entering = std::make_unique<EnteringRays<W, A>>();
    EXPECT_FALSE(entering->add(*ray, outer, number, *accel));
    int entered = 0;
    entering->go(
        *accel, [&](InflightRay&, NodeRef) { ++entered; }, [](InflightRay&) {},
        [](InflightRay&, std::uint32_t) {});
    ASSERT_EQ(entered, 1);
    EXPECT_EQ(ray->in.instance, number);
    const float size = length(Vec3f{ray->o[0], ray->o[1], ray->o[2]});
    (size > 4000 ? greater_inside : greater_outside) = true;
    EXPECT_TRUE(size > 4000 ? ray->slack > outer.slack : ray->slack == outer.slack);
    leave_instance(*ray, outer, *accel);
    EXPECT_EQ(ray->in.instance, kNoInstance);
    EXPECT_EQ(ray->slack, outer.slack);
    EXPECT_EQ(ray->size, outer.size + 1);  // the way out stays on the stack until it is popped
  }
  EXPECT_TRUE(greater_inside && greater_outside);
}

}  // namespace
}  // namespace oktett::inflight_instances_test
