#include <gtest/gtest.h>

#include <bit>
#include <vector>

#include "accel/accel.h"
#include "tests/support/limits.h"
#include "verify/cases/kernel_cases.h"
#include "verify/oracles/mesh.h"

namespace oktett::surfaces_test {
namespace {

/// Equal bits, or both NaN.
bool same(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b) || (a != a && b != b);
}
bool same(const Vec3f& a, const Vec3f& b) { return same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z); }

/// All but tangents.
void expect_same(const SurfaceInteraction& s, const SurfaceInteraction& expected, std::size_t i) {
  ASSERT_TRUE(same(s.position, expected.position)) << i;
  ASSERT_TRUE(same(s.position_error, expected.position_error)) << i;
  ASSERT_TRUE(same(s.geometric_normal, expected.geometric_normal)) << i;
  ASSERT_TRUE(same(s.shading_normal, expected.shading_normal)) << i;
  ASSERT_TRUE(same(s.uv.x, expected.uv.x) && same(s.uv.y, expected.uv.y)) << i;
  ASSERT_EQ(s.geometry, expected.geometry) << i;
  ASSERT_EQ(s.primitive, expected.primitive) << i;
  ASSERT_EQ(s.user, expected.user) << i;
  ASSERT_EQ(s.material_slot, expected.material_slot) << i;
}

/// Compares hits `which` of a batch with surface_interaction() on every instruction set.
void expect_like_surface(const Accel& accel, const RayBatch& rays, HitBatch& hits,
                         const std::vector<std::uint32_t>& which) {
  for (const Isa isa : available_isas()) {
    std::vector<SurfaceInteraction> found;
    for (std::size_t first = 0; first < which.size(); first += InteractionBlock::kMost) {
      InteractionBlock block;
      const std::size_t count = std::min(InteractionBlock::kMost, which.size() - first);
      surface_interactions(accel, rays, hits, {which.data() + first, count}, block, isa, true);
      for (std::size_t i = 0; i < count; ++i) found.push_back(block[i]);
    }
    for (std::size_t i = 0; i < which.size(); ++i) {
      expect_same(found[i], surface_interaction(accel, rays[which[i]], hits[which[i]]), i);
      const SurfaceInteraction names = identify(accel, hits[which[i]]);
      ASSERT_EQ(names.user, found[i].user);
      ASSERT_EQ(names.geometry, found[i].geometry);
      ASSERT_EQ(names.primitive, found[i].primitive);
      ASSERT_EQ(names.material_slot, found[i].material_slot);
    }
  }
}

/// A mesh with normals at all corners but those of every seventh triangle, and slots.
TriangleMesh smooth_mesh() {
  TriangleMesh mesh = make_icosphere(2).mesh;
  CaseRandom r(5);
  for (const Vec3f& p : mesh.positions) mesh.normals.push_back(p + Vec3f(r.vector() * 0.3));
  mesh.normal_indices = mesh.indices;
  for (std::size_t i = 0; i < mesh.normal_indices.size(); i += 21) mesh.normal_indices[i] = kNoId;
  for (std::size_t i = 0; i < mesh.triangle_count(); ++i) mesh.material_slots.push_back(i % 3);
  return mesh;
}

PolyhedronShape cut_cube() {
  return {{{{1, 0, 0}, 1},
           {{-1, 0, 0}, 1},
           {{0, 1, 0}, 1},
           {{0, -1, 0}, 1},
           {{0, 0, 1}, 1},
           {{0, 0, -1}, 1},
           {{1, 1, 1}, 2}}};
}

PolynomialShape saddle() {
  PolynomialShape s;
  s.terms = {{3, 0, 0, 1}, {1, 2, 0, -3}, {0, 0, 1, 1}, {0, 1, 2, 0.5}};
  return s;
}

RevolutionShape vase() {
  RevolutionShape s;
  s.points = {{0.2, -1.2}, {0.5, -1}, {0.9, -0.4}, {0.3, 0.3}, {0.55, 0.9}, {0.6, 1.2}};
  return s;
}

std::vector<Geometry> bodies(const TriangleMesh& smooth, const TriangleMesh& flat) {
  return {{MeshGeometry{&smooth}, {}, 1},
          {MeshGeometry{&smooth}, Affine::translation({2, 0, 0}) * Affine::rotation({10, 20, 30}), 2},
          {MeshGeometry{&flat}, Affine::translation({-2, 1, 0}) * Affine::scaling({1, -0.5, 2}), 3},
          {SpheresShape{{{{0, 2, 0}, 0.7}, {{0, -2, 0}, 0.5}}}, {}, 4},
          {PlaneShape{{0, 1, 0.1}, -3}, {}, 5},
          {ExactShape{TorusShape{0.7, 0.3}}, Affine::translation({3, 3, 0}), 6},
          {ExactShape{CylinderShape{}}, Affine::translation({-3, -3, 0}), 7},
          {ExactShape{ConeShape{}}, Affine::translation({-3, 3, 0}) * Affine::rotation({30, 20, 10}), 8},
          {ExactShape{QuadricShape{{1, -1, 1, 0.1, 0, 0, 0, 0.2, 0, -0.2}, true}},
           Affine::translation({3, -3, 0}), 9},
          {ExactShape{cut_cube()}, Affine::translation({0, 0, 3}), 10},
          {ExactShape{saddle()}, Affine::translation({0, 0, -3}), 11},
          {ExactShape{vase()}, Affine::translation({0, 4, 0}), 12},
          {ExactShape{BlobShape{{{BlobSource::Kind::point, {0, 0, 0}, {}, 0, 0.3}}}},
           Affine::translation({0, -4, 0}), 13},
          {ExactShape{TorusShape{0.5, 0.2}, NormalMethod::central}, Affine::translation({4, 0, 0}), 14},
          {BoxShape{{-0.5, -0.5, -0.5}, {0.5, 1, 0.5}}, Affine::translation({-4, 0, 0}), 15},
          {BoxShape{},
           Affine::translation({0, 0, 4.5}) * Affine::rotation({10, 50, 0}) * Affine::scaling({1, -0.5, 0.3}),
           16}};
}

RayBatch random_rays(int count) {
  RayBatch rays;
  CaseRandom r(11);
  for (int i = 0; i < count; ++i) {
    const Vec3f o(r.vector() * 9.0);
    rays.push_back({o, 0, Vec3f(r.vector() * 3.0) - o, kInf});
  }
  return rays;
}

HitBatch trace_all(const Accel& accel, const RayBatch& rays, std::vector<std::uint32_t>& found) {
  HitBatch hits;
  hits.resize_uninitialized(rays.size());
  closest_hit(accel, rays.span(), hits.span(), Isa::scalar);
  for (std::uint32_t i = 0; i < rays.size(); ++i)
    if (hits[i].valid()) found.push_back(i);
  return hits;
}

TEST(Surfaces, AreThoseOfSingleHits) {
  const TriangleMesh smooth = smooth_mesh(), flat = make_cube().mesh;
  const auto accel = build_accel(bodies(smooth, flat));
  const RayBatch rays = random_rays(2000);
  std::vector<std::uint32_t> found;
  HitBatch hits = trace_all(*accel, rays, found);
  ASSERT_GT(found.size(), 1000u);
  expect_like_surface(*accel, rays, hits, found);
}

TEST(Surfaces, OfAnyNumberOfHits) {
  const TriangleMesh smooth = smooth_mesh();
  const auto accel = build_accel({{MeshGeometry{&smooth}, Affine::scaling({1, 2, 3}), 1}});
  const RayBatch rays = random_rays(600);
  std::vector<std::uint32_t> found;
  HitBatch hits = trace_all(*accel, rays, found);
  ASSERT_GT(found.size(), 140u);
  for (const std::size_t count : {0u, 1u, 3u, 7u, 8u, 9u, 63u, 64u, 65u, 129u})
    expect_like_surface(*accel, rays, hits, {found.begin(), found.begin() + static_cast<long>(count)});
}

TEST(Surfaces, InsideNestedInstances) {
  const TriangleMesh smooth = smooth_mesh(), flat = make_cube().mesh;
  const auto leaf = build_accel(bodies(smooth, flat));
  const auto middle = build_accel({{InstanceGeometry{leaf}, Affine::scaling({0.3, 0.5, -0.4}), kNoId},
                                   {InstanceGeometry{leaf}, Affine::translation({4, 0, 0}), 8},
                                   {MeshGeometry{&smooth}, {}, 9}});
  const auto top = build_accel({{InstanceGeometry{middle}, Affine::rotation({10, 20, 30}), 42},
                                {InstanceGeometry{middle}, Affine::translation({0, 5, 0}), kNoId},
                                {MeshGeometry{&flat}, {}, 7}});
  const RayBatch rays = random_rays(2000);
  std::vector<std::uint32_t> found;
  HitBatch hits = trace_all(*top, rays, found);
  ASSERT_GT(found.size(), 800u);
  expect_like_surface(*top, rays, hits, found);
}

// Solids in the world, some of them taken away, and the same once more in an instance.
TEST(Surfaces, OfCombinations) {
  const TriangleMesh smooth = smooth_mesh(), flat = make_cube().mesh;
  const auto part = [&](double size, const Vec3d& from) {
    CsgExpression e{CsgOp::unite, {}, {}};
    for (Geometry g : bodies(smooth, flat)) {
      if (std::holds_alternative<PlaneShape>(g.shape)) continue;
      g.transform = Affine::translation(from) * g.transform * Affine::scaling({size, size, size});
      e.children.push_back({CsgOp::operand, {std::move(g)}, {}});
    }
    return e;
  };
  const CsgExpression whole{CsgOp::subtract, {}, {part(1, {}), part(0.7, {0.4, 0.2, 0.3})}};
  const Geometry csg{CsgGeometry{std::make_shared<const CsgExpression>(whole)}, {}, kNoId};
  const auto inner = build_accel({csg});
  const auto accel =
      build_accel({csg,
                   {InstanceGeometry{inner}, Affine::translation({6, 1, 0}) * Affine::scaling({1, 0.5, -2})},
                   {SpheresShape{{{{0, 0, 0}, 0.5}}}, {}, 99}});
  const RayBatch rays = random_rays(3000);
  std::vector<std::uint32_t> found;
  HitBatch hits = trace_all(*accel, rays, found);
  ASSERT_GT(found.size(), 1000u);
  expect_like_surface(*accel, rays, hits, found);
}

// Weights that no hit has, triangles without area, normals that are zero, infinite or NaN.
TEST(Surfaces, OfDegenerateInput) {
  TriangleMesh mesh = make_cube().mesh;
  CaseRandom r(3);
  const float odd[] = {0, -0.0f, kNan, kInf, -kInf, 1e38f, 1e-38f, 1};
  for (const Vec3f& p : mesh.positions) {
    static_cast<void>(p);
    mesh.normals.push_back({odd[r.bits() % 8], odd[r.bits() % 8], odd[r.bits() % 8]});
  }
  mesh.normal_indices = mesh.indices;
  const auto accel = build_accel({{MeshGeometry{&mesh}, Affine::scaling({1, 2, 3}), 1}});
  for (int k = 0; k < 3; ++k) mesh.indices[3 + k] = mesh.indices[3];
  mesh.positions[mesh.indices[6]] = {kNan, kInf, 0};
  RayBatch rays = random_rays(400);
  HitBatch hits;
  hits.resize_uninitialized(rays.size());
  std::vector<std::uint32_t> all;
  for (std::uint32_t i = 0; i < rays.size(); ++i) {
    hits.span().set(i, {1, odd[r.bits() % 8], odd[r.bits() % 8], i % 12, kNoId});
    all.push_back(i);
  }
  expect_like_surface(*accel, rays, hits, all);
}

}  // namespace
}  // namespace oktett::surfaces_test
