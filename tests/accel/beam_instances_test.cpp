/// \file Beams among instances: every set and mode finds what the scalar code finds, and that is what asking
/// each instance by itself finds.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/accel/instance_cases.h"

namespace oktett::beam_instances_test {
namespace {

/// Rays from one point through n x n pixels in tiles of 16 x 16, which make beams. Some start late, some end
/// early, some cannot hit anything.
RayBatch camera(const Vec3d& from, const Vec3d& to, double angle, int n) {
  const Vec3d w = normalize(to - from), u = normalize(cross(w, Vec3d{0.1, 1, 0.2})), v = cross(u, w);
  const double f = std::tan(angle), far = length(to - from);
  RayBatch rays;
  const int side = n / 16;
  for (int i = 0; i < n * n; ++i) {
    const int tile = i / 256, k = i % 256;
    const int x = tile % side * 16 + (k >> 4 & 3) * 4 + (k & 3),
              y = tile / side * 16 + (k >> 6) * 4 + (k >> 2 & 3);
    const Vec3d d = w + u * ((2 * (x + 0.5) / n - 1) * f) + v * ((1 - 2 * (y + 0.5) / n) * f);
    Ray ray{Vec3f(from), 0, Vec3f(d * (i % 5 == 0 ? 3.0 : 1.0)), kInf};
    if (tile % 3 == 1 && i % 7 == 0) ray.tmin = static_cast<float>(far * 0.3);
    if (tile % 4 == 2) ray.tmax = static_cast<float>(far * (0.3 + 0.001 * k));
    if (i % 83 == 0) ray.tmax = 0;
    if (i % 97 == 0) ray.direction.x = std::numeric_limits<float>::quiet_NaN();
    rays.push_back(ray);
  }
  return rays;
}

/// Rays from near what `rays` hit to `light`, where they end.
RayBatch towards(const Accel& accel, const RayBatch& rays, const Vec3f& light) {
  RayBatch shadow;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Hit h = closest_hit(accel, rays[i], Isa::scalar);
    if (!h.valid()) continue;
    const Vec3f p = rays[i].origin + rays[i].direction * (h.t * 0.999f);
    shadow.push_back({p, 0, light - p, 1});
  }
  return shadow;
}

/// The rays of `rays` that hit anything, ending where they hit or just before, by turns.
RayBatch ending_at_hits(const Accel& accel, const RayBatch& rays) {
  RayBatch ended;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Ray ray = rays[i];
    const Hit h = closest_hit(accel, ray, Isa::scalar);
    if (h.valid()) ray.tmax = i % 2 == 0 ? h.t : std::nextafter(h.t, 0.0f);
    ended.push_back(ray);
  }
  return ended;
}

/// Checks camera rays, the same with ends at their hits, and shadow rays. Returns the number of camera hits.
int expect_beams(const Accel& accel, const RayBatch& rays, const Vec3f& light) {
  const int hits = expect_same_hits(accel, rays);
  expect_same_hits(accel, ending_at_hits(accel, rays));
  expect_same_hits(accel, towards(accel, rays, light));
  return hits;
}

// Thousands of instances, seen from outside and from among them, so that beams meet instances in front of the
// apex, around it and beside it.
TEST(BeamInstances, ManyThatOverlap) {
  const Crowd crowd;
  const RayBatch outside = camera({20, 13, -25}, {0, 0, 0}, 0.3, 48),
                 among = camera({1, 2, 3}, {0, 1, -5}, 0.4, 32);
  EXPECT_GT(expect_beams(*crowd.accel, outside, {-30, 20, 10}), 1000);
  EXPECT_GT(expect_beams(*crowd.accel, among, {0.5f, 0, 0}), 500);
  expect_asked_each(*crowd.accel, outside, 41, TraceMode::beam);
  expect_asked_each(*crowd.accel, among, 41, TraceMode::beam);
}

// So many and so small instances that few rays of a beam meet each: beams are given up on the way.
TEST(BeamInstances, SmallerThanThePixels) {
  const TriangleMesh mesh = soup(20, 21, 0.5);
  InstanceList list{{tree_of(mesh)}, {}};
  CaseRandom r(22);
  for (std::uint32_t k = 0; k < 20000; ++k)
    list.places.push_back(place(Affine::translation(r.vector() * 8.0) * turned(r, 0.02), 0));
  const AccelPtr accel = build_accel({{list, {}, kNoId}});
  EXPECT_GT(expect_beams(*accel, camera({20, 13, -25}, {0, 0, 0}, 0.3, 64), {-30, 20, 10}), 100);
}

// Two trees of the same triangles, shown several times at the same places: the first of the nearest counts,
// wherever a ray goes first. The triangles of the structure itself come before those of its instances.
TEST(BeamInstances, Ties) {
  const TriangleMesh mesh = soup(60, 6, 0.3);
  const AccelPtr one = tree_of(mesh), two = tree_of(mesh, BuildQuality::fast);
  const Geometry plain{MeshGeometry{&mesh}, {}, kNoId};
  const RayBatch rays = camera({3, 2, -4}, {0, 0, 0}, 0.3, 48);
  for (const bool with_mesh : {false, true}) {
    std::vector<Geometry> geometries;
    for (int k = 0; k < 3; ++k) {
      add_instance(geometries, two);
      if (k == 1 && with_mesh) geometries.push_back(plain);
      add_instance(geometries, one);
    }
    EXPECT_GT(expect_beams(*build_accel(geometries), rays, {-3, 4, 1}), 500);
  }
}

// Mirrored, nearly flat, sheared and unevenly scaled instances, of trees whose own scale is unusual.
TEST(BeamInstances, UnusualMaps) {
  const TriangleMesh unit = soup(100, 9, 0.2);
  CaseRandom r(10);
  for (const double scale : {1.0, 1e-4, 1e-13, 1e-20, 1e6, 1e12}) {
    TriangleMesh mesh = unit;
    for (Vec3f& p : mesh.positions) p = Vec3f(Vec3d(p) * scale);
    const auto [mixed, listed] = unusual_maps(mesh, scale, r);
    const RayBatch rays = camera({5, 3, -4}, {0, 0, 0}, 0.35, 32);
    EXPECT_GT(expect_beams(*mixed, rays, {-4, 5, 3}), 300) << scale;
    expect_asked_each(*listed, rays, 11, TraceMode::beam);
    if (HasFailure()) return;
  }
}

// Instances of instances, of closed forms, of exact surfaces, of planes, of textbook triangles and of trees
// of one leaf, next to a mesh, a plane and spheres.
TEST(BeamInstances, NestedAndOfOtherShapes) {
  const TriangleMesh mesh = soup(150, 12, 0.2), one = soup(1, 13, 0.5);
  const AccelPtr leaf = tree_of(mesh);
  CaseRandom r(14);
  std::vector<SphereShape> balls;
  for (int k = 0; k < 20; ++k) balls.push_back({r.vector(), 0.2});
  std::vector<Geometry> mixed = {{MeshGeometry{&mesh, true, TriangleTest::badouel}, {}, kNoId},
                                 {SpheresShape{balls}, {}, kNoId}};
  add_instance(mixed, leaf, turned(r, 0.7));
  const AccelPtr children[] = {
      build_accel(mixed), build_accel({{PlaneShape{{0, 0, 1}, -3}, {}, 8}, {MeshGeometry{&mesh}, {}, kNoId}}),
      tree_of(one),
      build_accel({{ExactShape{TorusShape{0.8, 0.3}}, {}, 7}, {ExactShape{TorusShape{0.4, 0.1}}, {}, 7}}),
      leaf};
  for (const bool with_plane : {false, true}) {
    std::vector<Geometry> geometries = {
        {MeshGeometry{&mesh}, {}, kNoId},
        {SpheresShape{{{{2, 1, 0}, 0.5}, {{-2, 1, 0.3}, 0.4}}}, {}, kNoId},
        {PlaneShape{{0, 1, 0}, -3.5}, {}, kNoId},
    };
    if (!with_plane) geometries.pop_back();
    for (std::size_t k = 0; k < 60; ++k) {
      const Affine at = Affine::translation(r.vector() * 3.0) * turned(r, 0.6);
      const std::size_t child = k % 5 == 1 && (k > 10 || !with_plane) ? 0 : k % 5;
      add_instance(geometries, children[child], at);
    }
    const AccelPtr inner = build_accel(geometries);
    const RayBatch rays = camera({7, 4, -6}, {0, 0, 0}, 0.35, 64);
    EXPECT_GT(expect_beams(*inner, rays, {-6, 7, 2}), 1000);
    std::vector<Geometry> outer;
    add_instance(outer, inner, turned(r, 0.9));
    add_instance(outer, leaf, turned(r, 2));
    add_instance(outer, inner, Affine::translation({1, 0, 2}));
    EXPECT_GT(expect_beams(*build_accel(outer), rays, {-6, 7, 2}), 1000);
  }
}

// Rays through the corners and edges of closed surfaces, shown turned by right angles, so that the rays go
// through the same corners inside: none slips through.
TEST(BeamInstances, CornersAndEdges) {
  TriangleMesh sheet;
  constexpr int kSide = 16;
  for (int y = 0; y <= kSide; ++y)
    for (int x = 0; x <= kSide; ++x)
      sheet.positions.push_back({float(x - kSide / 2), float(y - kSide / 2), float((x * 7 + y * 3) % 5) / 4});
  for (std::uint32_t y = 0; y < kSide; ++y)
    for (std::uint32_t x = 0; x < kSide; ++x) {
      const std::uint32_t a = y * (kSide + 1) + x, b = a + kSide + 1;
      for (const std::uint32_t corner : {a, a + 1, b + 1, a, b + 1, b}) sheet.indices.push_back(corner);
    }
  std::vector<Geometry> geometries;
  const AccelPtr child = tree_of(sheet);
  for (int k = 0; k < 8; ++k) {
    Affine quarter;
    for (int turn = 0; turn < k % 4; ++turn) {
      Affine once;
      once.m = {{{0, -1, 0, 0}, {1, 0, 0, 0}, {0, 0, 1, 0}}};
      quarter = once * quarter;
    }
    const Affine at = Affine::translation({0, 0, 4.0 * k}) * quarter;
    add_instance(geometries, child, at);
  }
  const AccelPtr accel = build_accel(geometries);
  // At the corners of the sheet nearest to the apex, and at the middles of its edges.
  const Vec3f apex{0.5f, 0.25f, -40};
  RayBatch rays;
  for (int tile = 0; tile < 4; ++tile)
    for (int k = 0; k < 256; ++k) {
      const int x = tile % 2 * 16 + k % 16, y = tile / 2 * 16 + k / 16;
      const Vec3f p = sheet.positions[std::size_t(y / 2) * (kSide + 1) + std::size_t(x / 2)];
      const Vec3f q = sheet.positions[std::size_t((y + 1) / 2) * (kSide + 1) + std::size_t((x + 1) / 2)];
      rays.push_back({apex, 0, (p + q) * 0.5f - apex, kInf});
    }
  const int hits = expect_beams(*accel, rays, {3, 60, -80});
  EXPECT_GE(hits, 31 * 31);
}

// Instances far from the origin of their own space, and rays that come from far away.
TEST(BeamInstances, FarAway) {
  TriangleMesh mesh = soup(200, 16, 0.2);
  for (Vec3f& p : mesh.positions) p = p + Vec3f{3000, -200, 0};
  std::vector<Geometry> geometries;
  CaseRandom r(17);
  for (int k = 0; k < 40; ++k)
    add_instance(geometries, tree_of(mesh),
                 Affine::translation(r.vector() * 4.0) * turned(r, 1) * Affine::translation({-3000, 200, 0}));
  const AccelPtr accel = build_accel(geometries);
  EXPECT_GT(expect_beams(*accel, camera({9, 6, -8}, {0, 0, 0}, 0.3, 48), {-9, 6, 2}), 500);
  EXPECT_GT(expect_beams(*accel, camera({9e4, 6e4, -8e4}, {0, 0, 0}, 3e-5, 48), {-9e4f, 6e4f, 2e4f}), 500);
}

// Batches that end in a part of a beam or of a group, and beams of one batch after the other.
TEST(BeamInstances, PartsOfBeams) {
  const TriangleMesh mesh = soup(100, 18, 0.2);
  InstanceList list{{tree_of(mesh)}, {}};
  CaseRandom r(19);
  for (int k = 0; k < 100; ++k)
    list.places.push_back(place(Affine::translation(r.vector() * 2.0) * turned(r, 0.5), 0));
  const AccelPtr accel = build_accel({{list, {}, kNoId}});
  const RayBatch all = camera({5, 3, -4}, {0, 0, 0}, 0.3, 32);
  for (const std::size_t count : {64, 65, 100, 250, 255, 257, 300, 511, 513, 1000}) {
    RayBatch rays;
    for (std::size_t i = 0; i < count; ++i) rays.push_back(all[i]);
    expect_beams(*accel, rays, {-4, 4, 4});
    if (HasFailure()) FAIL() << count;
  }
}

}  // namespace
}  // namespace oktett::beam_instances_test
