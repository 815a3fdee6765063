#include "accel/csg/csg.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "accel/accel_data.h"
#include "accel/hit_place.h"
#include "accel/point_query.h"
#include "verify/cases/kernel_cases.h"
#include "verify/checks/csg.h"
#include "verify/oracles/mesh.h"

namespace oktett::csg_test {
namespace {

const float kInfinity = std::numeric_limits<float>::infinity();

Geometry solid(decltype(Geometry::shape) shape, std::uint32_t user, const Affine& to_world = {}) {
  return {std::move(shape), to_world, user};
}
Geometry ball(const Vec3d& center, double radius, std::uint32_t user) {
  return solid(SpheresShape{{{center, radius}}}, user);
}
Geometry cube(const Vec3d& min, const Vec3d& max, std::uint32_t user) {
  return solid(BoxShape{min, max}, user);
}

CsgExpression combine(CsgOp op, std::vector<Geometry> solids) {
  CsgExpression e;
  e.op = op;
  for (Geometry& g : solids) e.children.push_back({CsgOp::operand, {std::move(g)}, {}});
  return e;
}
Geometry whole(CsgExpression e, const Affine& to_world = {}) {
  return {CsgGeometry{std::make_shared<const CsgExpression>(std::move(e))}, to_world, kNoId};
}
std::shared_ptr<const Accel> built(Geometry g) { return build_accel({std::move(g)}); }

Ray ray_along_x(float y = 0, float z = 0, float from = -8) { return {{from, y, z}, 0, {1, 0, 0}, kInfinity}; }

/// Distances of all crossings; on every instruction set the first of them is closest_hit.
std::vector<float> crossings(const Accel& accel, const Ray& ray) {
  std::vector<float> t;
  for (const Isa isa : available_isas()) {
    std::vector<Hit> list;
    all_hits(accel, ray, list, isa);
    t.clear();
    for (const Hit& hit : list) t.push_back(hit.t);
    RayBatch rays;
    rays.push_back(ray);
    HitBatch hits;
    hits.resize_uninitialized(1);
    closest_hit(accel, rays.span(), hits.span(), isa);
    std::uint8_t occluded;
    any_hit(accel, rays.span(), {&occluded, 1}, isa);
    EXPECT_EQ(hits[0].valid(), !list.empty());
    EXPECT_EQ(occluded != 0, !list.empty());
    if (!list.empty()) {
      EXPECT_TRUE(hits[0] == list[0]);
    }
    // Many at once go other ways.
    RayBatch many;
    for (int i = 0; i < 20; ++i) many.push_back(ray);
    hits.resize_uninitialized(many.size());
    closest_hit(accel, many.span(), hits.span(), isa);
    for (std::size_t i = 0; i < hits.size(); ++i) {
      EXPECT_TRUE(list.empty() ? !hits[i].valid() : hits[i] == list[0]) << to_string(isa) << " " << i;
    }
  }
  return t;
}

std::vector<SurfaceInteraction> surfaces_along(const Accel& accel, const Ray& ray) {
  std::vector<Hit> list;
  all_hits(accel, ray, list, available_isas().front());
  std::vector<SurfaceInteraction> all;
  for (const Hit& hit : list) all.push_back(surface_interaction(accel, ray, hit));
  return all;
}

using Distances = std::vector<float>;

/// Random trees of random solids against sampling: no span on the wrong side, normals outwards, the same bits
/// everywhere.
TEST(Csg, AgreesWithSampling) {
  const CsgTally t = verify_csg(20000, available_isas());
  EXPECT_EQ(t.wrong(), 0u) << t.wrong_spans << " spans, " << t.wrong_first << " firsts, " << t.wrong_inside
                           << " points, " << t.wrong_normal << " normals, " << t.differing << " differing; "
                           << t.failure;
  EXPECT_GT(t.crossings, t.rays / 4);
}

TEST(Csg, TwoBoxesInEachCombination) {
  const Geometry a = cube({0, -1, -1}, {2, 1, 1}, 0), b = cube({1, -1, -1}, {3, 1, 1}, 1);
  const Ray ray = ray_along_x(0.25f, 0.125f);
  EXPECT_EQ(crossings(*built(whole(combine(CsgOp::unite, {a, b}))), ray), (Distances{8, 11}));
  EXPECT_EQ(crossings(*built(whole(combine(CsgOp::intersect, {a, b}))), ray), (Distances{9, 10}));
  EXPECT_EQ(crossings(*built(whole(combine(CsgOp::subtract, {a, b}))), ray), (Distances{8, 9}));
  EXPECT_EQ(crossings(*built(whole(combine(CsgOp::subtract, {b, a}))), ray), (Distances{10, 11}));
}

/// Faces that coincide leave no skin where equal solids are subtracted and no seam where neighbours are
/// united.
TEST(Csg, CoincidentFacesLeaveNoSlivers) {
  const Geometry a = cube({0, -1, -1}, {1, 1, 1}, 0), b = cube({1, -1, -1}, {2, 1, 1}, 1),
                 tall = cube({0, -2, -2}, {1, 2, 2}, 2);
  const Ray ray = ray_along_x(0.25f, 0.125f);
  EXPECT_EQ(crossings(*built(whole(combine(CsgOp::unite, {a, b}))), ray), (Distances{8, 10}));
  EXPECT_EQ(crossings(*built(whole(combine(CsgOp::intersect, {a, b}))), ray), Distances{});
  EXPECT_EQ(crossings(*built(whole(combine(CsgOp::subtract, {a, a}))), ray), Distances{});
  EXPECT_EQ(crossings(*built(whole(combine(CsgOp::subtract, {a, tall}))), ray), Distances{});
  EXPECT_EQ(crossings(*built(whole(combine(CsgOp::intersect, {a, a, a}))), ray), (Distances{8, 9}));
  // Faces that meet only up to rounding.
  for (const double gap : {1e-7, -1e-7}) {
    const Geometry near = cube({1 + gap, -1, -1}, {2, 1, 1}, 1);
    EXPECT_EQ(crossings(*built(whole(combine(CsgOp::unite, {a, near}))), ray), (Distances{8, 10})) << gap;
    EXPECT_EQ(crossings(*built(whole(combine(CsgOp::intersect, {a, near}))), ray), Distances{}) << gap;
  }
  // A wall that is thin, but no accident, stays.
  const Geometry most = cube({0, -2, -2}, {0.9995, 2, 2}, 1);
  EXPECT_EQ(crossings(*built(whole(combine(CsgOp::subtract, {a, most}))), ray).size(), 2u);
}

/// A subtracted solid shows its own surface with reversed normals.
/// Where faces coincide, the one is seen that decides: not that of an operand which is cut away there.
TEST(Csg, OfCoincidentFacesTheDecisiveOneIsSeen) {
  const Geometry cutter = cube({-9, -9, -9}, {9, 9, 0}, 9);
  for (const bool turned : {false, true})
    for (const bool large : {false, true}) {
      const Geometry below = cube({-1, -1, -1}, {1, 1, 1}, 1), above = cube({-1, -1, -1}, {1, 1, 1}, 2);
      CsgExpression part = combine(CsgOp::intersect, {below, cutter}),
                    rest = combine(CsgOp::subtract, {above, cutter}), all = combine(CsgOp::unite, {});
      all.children = turned ? std::vector{rest, part} : std::vector{part, rest};
      // Trees of more than six leaves are entered by their nodes.
      if (large)
        for (int k = 0; k < 12; ++k)
          all.children.push_back({CsgOp::operand, {ball({0, 20.0 + 3 * k, 0}, 1, 3)}, {}});
      const auto accel = built(whole(all));
      for (const float z : {-0.5f, 0.5f}) {
        const Ray ray = ray_along_x(0.25f, z);
        EXPECT_EQ(crossings(*accel, ray), (Distances{7, 9}));
        for (const SurfaceInteraction& s : surfaces_along(*accel, ray))
          EXPECT_EQ(s.user, z < 0 ? 1u : 2u) << turned << large << z;
      }
    }
  // Where all decide, as in intersections, or none alone, as in unions, it is the first.
  const Geometry a = cube({-1, -1, -1}, {1, 1, 1}, 1), b = cube({-1, -1, -1}, {1, 1, 1}, 2);
  for (const CsgOp op : {CsgOp::unite, CsgOp::intersect}) {
    const auto accel = built(whole(combine(op, {a, b})));
    EXPECT_EQ(crossings(*accel, ray_along_x(0.25f, 0.5f)), (Distances{7, 9}));
    for (const SurfaceInteraction& s : surfaces_along(*accel, ray_along_x(0.25f, 0.5f)))
      EXPECT_EQ(s.user, 1u);
  }
}

TEST(Csg, SubtractedSurfacesAreTurnedRoundAndKeepTheirUser) {
  const auto accel =
      built(whole(combine(CsgOp::subtract, {cube({-1, -1, -1}, {1, 1, 1}, 7), ball({0, 0, 0}, 0.5, 9)})));
  const auto seen = surfaces_along(*accel, ray_along_x());
  ASSERT_EQ(seen.size(), 4u);
  const std::uint32_t users[] = {7, 9, 9, 7};
  const float x[] = {-1, -0.5f, 0.5f, 1}, normal[] = {-1, 1, -1, 1};
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(seen[i].user, users[i]) << i;
    EXPECT_EQ(seen[i].position.x, x[i]) << i;
    EXPECT_EQ(seen[i].geometric_normal.x, normal[i]) << i;
    EXPECT_EQ(seen[i].shading_normal.x, normal[i]) << i;
  }
}

/// A solid that is subtracted twice over has its normals reversed twice.
TEST(Csg, WhatIsTakenFromWhatIsTakenComesBack) {
  CsgExpression inner = combine(CsgOp::subtract, {ball({0, 0, 0}, 1, 1), ball({0, 0, 0}, 0.5, 2)});
  CsgExpression outer = combine(CsgOp::subtract, {ball({0, 0, 0}, 2, 0)});
  outer.children.push_back(std::move(inner));
  const auto seen = surfaces_along(*built(whole(std::move(outer))), ray_along_x());
  ASSERT_EQ(seen.size(), 6u);
  const float normal[] = {-1, 1, -1, 1, -1, 1};
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(seen[i].geometric_normal.x, normal[i], 1e-6f) << i;
}

/// Surface interactions found in blocks have the bits of those found one by one.
TEST(Csg, BlocksOfSurfacesHaveTheSameBits) {
  Geometry turned = whole(combine(CsgOp::subtract, {cube({-1, -1, -1}, {1, 1, 1}, 7), ball({0, 0, 1}, 0.5, 9),
                                                    solid(ExactShape{TorusShape{0.8, 0.2}}, 3)}),
                          Affine::rotation({10, 20, 30}));
  Geometry inside;
  inside.shape = InstanceGeometry{built(turned)};
  inside.transform = Affine::translation({3, 0, 0}) * Affine::scaling({1, -0.5, 2});
  const OracleMesh sphere = make_icosphere(2);
  Geometry cut = whole(combine(
      CsgOp::subtract, {cube({-1, 2, -1}, {1, 4, 1}, 4),
                        solid(MeshGeometry{&sphere.mesh, true}, 5, Affine::translation({0, 3.5, 0.8}))}));
  const auto accel = build_accel({turned, inside, cut, ball({0, -3, 0}, 1, 8)});
  RayBatch rays;
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) rays.push_back({{1, 0, 9}, 0, {-0.4f + 0.03f * x, -0.6f + 0.03f * y, -1}});
  HitBatch hits;
  hits.resize_uninitialized(rays.size());
  std::size_t flipped = 0, found = 0;
  for (const Isa isa : available_isas()) {
    closest_hit(*accel, rays.span(), hits.span(), isa);
    std::vector<std::uint32_t> which;
    for (std::uint32_t i = 0; i < rays.size(); ++i)
      if (hits[i].valid()) which.push_back(i);
    InteractionBlock block;
    for (std::size_t at = 0; at < which.size(); at += InteractionBlock::kMost) {
      const std::size_t count = std::min(which.size() - at, InteractionBlock::kMost);
      surface_interactions(*accel, rays, hits, {&which[at], count}, block, isa);
      for (std::size_t k = 0; k < count; ++k, ++found) {
        const std::uint32_t i = which[at + k];
        const SurfaceInteraction one = surface_interaction(*accel, rays[i], hits[i]), many = block[k];
        EXPECT_EQ(one.position, many.position);
        EXPECT_EQ(one.position_error, many.position_error);
        EXPECT_EQ(one.geometric_normal, many.geometric_normal);
        EXPECT_EQ(one.shading_normal, many.shading_normal);
        EXPECT_EQ(one.user, many.user);
        // A closed solid shows its outside.
        EXPECT_LE(dot(one.geometric_normal, rays[i].direction), 1e-3f);
        flipped += one.user == 9 || one.user == 5 || one.user == 3;
      }
    }
  }
  const std::size_t sets = available_isas().size();
  EXPECT_GT(found, 200 * sets);
  EXPECT_GT(flipped, 10 * sets);
}

/// Shadow rays stop at the first change of the whole combination. Removed surfaces cast no shadow, and
/// neither do surfaces beyond the light.
TEST(Csg, ShadowsAreOfTheCombinationOnly) {
  const auto accel = built(whole(combine(CsgOp::intersect, {ball({-1, 0, 0}, 2, 0), ball({1, 0, 0}, 2, 1)})));
  const auto occluded = [&](Ray ray) {
    RayBatch rays;
    rays.push_back(ray);
    std::uint8_t answer;
    any_hit(*accel, rays.span(), {&answer, 1}, available_isas().front());
    return answer != 0;
  };
  // Through the left ball alone.
  EXPECT_FALSE(occluded({{-2.5f, 8, 0}, 0, {0, -1, 0}, kInfinity}));
  EXPECT_TRUE(occluded({{0, 8, 0}, 0, {0, -1, 0}, kInfinity}));
  // The lens begins at x = -1, t = 7.
  EXPECT_FALSE(occluded({{-8, 0, 0}, 0, {1, 0, 0}, 6.5f}));
  EXPECT_TRUE(occluded({{-8, 0, 0}, 0, {1, 0, 0}, 7.5f}));
  EXPECT_FALSE(occluded({{-8, 0, 0}, 9.5f, {1, 0, 0}, kInfinity}));
}

/// A ray may begin inside of any operand.
TEST(Csg, RaysBeginAnywhere) {
  const auto accel =
      built(whole(combine(CsgOp::subtract, {cube({0, -1, -1}, {4, 1, 1}, 0), cube({1, -2, -2}, {2, 2, 2}, 1),
                                            solid(PlaneShape{{-1, 0, 0}, -3}, 2)})));
  EXPECT_EQ(crossings(*accel, ray_along_x(0, 0, -1)), (Distances{1, 2, 3, 4}));
  EXPECT_EQ(crossings(*accel, ray_along_x(0, 0, 0.5f)), (Distances{0.5f, 1.5f, 2.5f}));
  EXPECT_EQ(crossings(*accel, ray_along_x(0, 0, 1.5f)), (Distances{0.5f, 1.5f}));
  EXPECT_EQ(crossings(*accel, ray_along_x(0, 0, 2.5f)), (Distances{0.5f}));
  EXPECT_EQ(crossings(*accel, ray_along_x(0, 0, 3.5f)), Distances{});
  // Never a crossing with the plane, yet on either side of it.
  EXPECT_EQ(crossings(*accel, {{3.5f, -8, 0}, 0, {0, 1, 0}, kInfinity}), Distances{});
  EXPECT_EQ(crossings(*accel, {{2.5f, -8, 0}, 0, {0, 1, 0}, kInfinity}), (Distances{7, 9}));
}

/// Rays along faces and edges of a mesh, where neighbours share the line, never leave it inside.
TEST(Csg, MeshesAreEnteredAsOftenAsLeft) {
  const OracleMesh sphere = make_icosphere(3), block = make_cube();
  for (const OracleMesh* mesh : {&sphere, &block}) {
    const auto accel = built(whole(combine(
        CsgOp::subtract, {cube({-4, -4, -4}, {4, 4, 4}, 0), solid(MeshGeometry{&mesh->mesh, false}, 1)})));
    const auto& p = mesh->mesh.positions;
    for (std::size_t i = 0; i + 1 < mesh->mesh.indices.size(); ++i) {
      const Vec3f a = p[mesh->mesh.indices[i]], b = p[mesh->mesh.indices[i + 1]];
      for (const Vec3f& d : {b - a, a, Vec3f{1, 0, 0}, Vec3f{0, 1e-6f, -1}}) {
        if (!(length(d) > 0)) continue;
        const Vec3f from = a - d * (10 / length(d));
        const Distances t = crossings(*accel, {from, 0, d, kInfinity});
        ASSERT_FALSE(t.empty());
        EXPECT_EQ(t.size() % 2, 0u);
        // The last crossing leaves the large cube.
        const Vec3f end = from + d * t.back();
        EXPECT_NEAR(std::max({std::abs(end.x), std::abs(end.y), std::abs(end.z)}), 4, 1e-3f);
      }
    }
  }
}

/// A mesh wound inside out is the same solid.
TEST(Csg, InsideOutAndMirroredMeshesAreSolidsToo) {
  OracleMesh block = make_cube();
  OracleMesh reversed = block;
  for (std::size_t i = 0; i < reversed.mesh.indices.size(); i += 3)
    std::swap(reversed.mesh.indices[i + 1], reversed.mesh.indices[i + 2]);
  const Ray ray = ray_along_x(0.25f, 0.125f);
  const auto with = [&](const OracleMesh& mesh, const Affine& m) {
    return crossings(*built(whole(combine(CsgOp::subtract, {cube({-4, -4, -4}, {4, 4, 4}, 0),
                                                            solid(MeshGeometry{&mesh.mesh, false}, 1, m)}))),
                     ray);
  };
  const Distances expected = with(block, {});
  EXPECT_EQ(expected.size(), 4u);
  EXPECT_EQ(with(reversed, {}), expected);
  EXPECT_EQ(with(block, Affine::scaling({1, 1, -1})), expected);
  EXPECT_EQ(with(reversed, Affine::scaling({1, -1, 1})), expected);
  // The same inside of an instance.
  const auto inner = built(solid(MeshGeometry{&reversed.mesh, false}, 1));
  EXPECT_EQ(crossings(*built(whole(combine(CsgOp::subtract, {cube({-4, -4, -4}, {4, 4, 4}, 0),
                                                             solid(InstanceGeometry{inner}, 1)}))),
                      ray),
            expected);
}

/// Structures that 2^28 chains of instances lead to are looked at once each.
TEST(Csg, LooksAtSharedStructuresOnce) {
  OracleMesh block = make_cube();
  for (std::size_t k = 0; k < block.mesh.indices.size(); k += 3)
    std::swap(block.mesh.indices[k], block.mesh.indices[k + 1]);
  auto inner = built(solid(MeshGeometry{&block.mesh, false}, 1));
  for (int level = 0; level < 28; ++level)
    inner = build_accel({solid(InstanceGeometry{inner}, 1, Affine::translation({3, 0, 0})),
                         solid(InstanceGeometry{inner}, 1, Affine::translation({0, 3, 0}))});
  const auto whole_of = built(whole(combine(CsgOp::unite, {solid(InstanceGeometry{inner}, 1)})));
  EXPECT_EQ(crossings(*whole_of, {{84.25f, 0.125f, 10}, 0, {0, 0, -1}, kInfinity}), (Distances{9, 11}));
}

/// Triangles in several leaves are one crossing each.
TEST(Csg, SplitsOfSpaceDoNotRepeatCrossings) {
  const OracleMesh sphere = make_icosphere(4);
  const Geometry g = whole(combine(
      CsgOp::subtract, {cube({-4, -4, -4}, {4, 4, 4}, 0), solid(MeshGeometry{&sphere.mesh, false}, 1)}));
  const auto plain = build_accel({g}, {BuildQuality::fast}), split = build_accel({g}, {BuildQuality::best});
  for (int i = 0; i < 200; ++i) {
    const Ray ray{{-8, 0, 0}, 0, {1, 0.001f * i, 0.0007f * i}, kInfinity};
    const Distances t = crossings(*plain, ray);
    EXPECT_EQ(crossings(*split, ray), t);
  }
}

/// Combinations in instances in combinations.
TEST(Csg, StandsInInstancesAndInItself) {
  const auto shell = built(whole(combine(CsgOp::subtract, {ball({0, 0, 0}, 1, 5), ball({0, 0, 0}, 0.5, 6)})));
  Geometry placed = solid(InstanceGeometry{shell}, kNoId, Affine::translation({2, 0, 0}));
  const auto accel =
      built(whole(combine(CsgOp::subtract, {cube({0, -2, -2}, {4, 2, 2}, 0), std::move(placed)})));
  const Ray ray = ray_along_x();
  EXPECT_EQ(crossings(*accel, ray), (Distances{8, 9, 9.5f, 10.5f, 11, 12}));
  const auto seen = surfaces_along(*accel, ray);
  const std::uint32_t users[] = {0, 5, 6, 6, 5, 0};
  const float normal[] = {-1, 1, -1, 1, -1, 1};
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(seen[i].user, users[i]) << i;
    EXPECT_NEAR(seen[i].geometric_normal.x, normal[i], 1e-6f) << i;
  }
  // As a solid of an operand, beside another.
  CsgExpression both;
  both.solids = {whole(combine(CsgOp::subtract, {ball({0, 0, 0}, 1, 5), ball({0, 0, 0}, 0.5, 6)}),
                       Affine::translation({2, 0, 0})),
                 ball({2, 0, 0}, 0.25, 7)};
  CsgExpression outer = combine(CsgOp::subtract, {cube({0, -2, -2}, {4, 2, 2}, 0)});
  outer.children.push_back(both);
  EXPECT_EQ(crossings(*built(whole(outer)), ray), (Distances{8, 9, 9.5f, 9.75f, 10.25f, 10.5f, 11, 12}));
}

/// Origins moved off a surface where faces coincide do not meet the other face.
TEST(Csg, RaysLeaveCoincidentFaces) {
  const Geometry a = cube({0, -1, -1}, {1, 1, 1}, 0), b = cube({1.00000012, -1, -1}, {2, 1, 1}, 1),
                 c = cube({0.99999994, -1, -1}, {3, 0, 1}, 2);
  CsgExpression e = combine(CsgOp::subtract, {});
  e.children.push_back(combine(CsgOp::unite, {a, b}));
  e.children.push_back({CsgOp::operand, {c}, {}});
  const auto accel = built(whole(e));
  for (int i = 0; i < 100; ++i) {
    const Ray ray{{8, -4, 0}, 0, {-1, 0.42f + 0.001f * i, 0.002f * i}, kInfinity};
    for (const SurfaceInteraction& s : surfaces_along(*accel, ray)) {
      const Vec3f out = s.geometric_normal;
      const Ray next{offset_origin(s, out), 0, out, kInfinity};
      for (const float t : crossings(*accel, next)) EXPECT_GT(t, 1e-3f);
    }
  }
}

/// What is outside of an ellipsoid has a surface with bounds, but has none itself.
TEST(Csg, TheOutsideOfAnEllipsoidIsEverywhere) {
  const Geometry outside = solid(ExactShape{QuadricShape{{-1, -1, -1, 0, 0, 0, 0, 0, 0, 1}}}, 1),
                 box = cube({-2, -2, -2}, {2, 2, 2}, 0);
  const auto both = built(whole(combine(CsgOp::intersect, {box, outside}))),
             rest = built(whole(combine(CsgOp::subtract, {box, outside})));
  EXPECT_EQ(crossings(*both, ray_along_x()), (Distances{6, 7, 9, 10}));
  EXPECT_EQ(crossings(*both, ray_along_x(1.5f)), (Distances{6, 10}));
  EXPECT_EQ(crossings(*rest, ray_along_x()), (Distances{7, 9}));
  EXPECT_EQ(crossings(*rest, ray_along_x(1.5f)), Distances{});
}

/// Endless primitives are asked before what is not traced in lanes: rays along them, which never cross them,
/// are inside.
TEST(Csg, RaysAlongEndlessOperandsAreInside) {
  const Geometry pipe = solid(ExactShape{QuadricShape{{0, 1, 1, 0, 0, 0, 0, 0, 0, -0.25}}}, 1),
                 blob = solid(ExactShape{MetaballsShape{0.5, {{{0, 0, 0}, 2, 1}}}}, 0);
  const float r = 2 * std::sqrt(1 - std::sqrt(0.5f));
  const auto near = [](const Distances& found, const Distances& wanted) {
    ASSERT_EQ(found.size(), wanted.size());
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], wanted[i], 1e-5f);
  };
  for (const bool first : {true, false}) {
    const std::vector<Geometry> both = first ? std::vector{pipe, blob} : std::vector{blob, pipe};
    const auto core = built(whole(combine(CsgOp::intersect, both)));
    near(crossings(*core, ray_along_x()), {8 - r, 8 + r});
    near(crossings(*core, ray_along_x(0, 0, 0)), {r});
    near(crossings(*core, ray_along_x(0.6f)), {});
    near(crossings(*core, {{0, -4, 0}, 0, {0, 1, 0}, kInfinity}), {3.5f, 4.5f});
    near(crossings(*core, {{0, 1, 0}, 0, {0, 1, 0}, kInfinity}), {});
  }
  const auto bored = built(whole(combine(CsgOp::subtract, {blob, pipe})));
  near(crossings(*bored, ray_along_x()), {});
  near(crossings(*bored, {{0, -4, 0}, 0, {0, 1, 0}, kInfinity}), {4 - r, 3.5f, 4.5f, 4 + r});
}

/// A ball that a box without a surface cuts is open there: rays go in, and meet the ball from inside. The
/// same of primitives, of shapes and of meshes; where a face of the box lies on that of another box, that is
/// seen.
TEST(Csg, WhatOnlyCutsHasNoSurface) {
  const auto r = static_cast<float>(std::sqrt(1 - std::sqrt(0.5)));
  Geometry cut = cube({-4, -4, -4}, {0, 4, 4}, 9);
  cut.mask = 0;
  const struct {
    Geometry solid;
    float radius;
  } kCases[] = {{ball({0, 0, 0}, 1, 1), 1},
                {solid(ExactShape{MetaballsShape{0.5, {{{0, 0, 0}, 1, 1}}}}, 1), r}};
  for (const auto& [whole_ball, radius] : kCases) {
    const auto half = built(whole(combine(CsgOp::intersect, {whole_ball, cut})));
    const auto rest = built(whole(combine(CsgOp::subtract, {whole_ball, cut})));
    const auto places = [](const Accel& accel, const Ray& ray) {
      Distances rounded;
      for (const float t : crossings(accel, ray)) rounded.push_back(std::round(t * 4096) / 4096);
      return rounded;
    };
    const float from = std::round((8 - radius) * 4096) / 4096, to = std::round((8 + radius) * 4096) / 4096;
    EXPECT_EQ(places(*half, ray_along_x()), Distances{from});
    EXPECT_EQ(places(*half, {{8, 0, 0}, 0, {-1, 0, 0}, kInfinity}), Distances{to});
    EXPECT_EQ(places(*rest, ray_along_x()), Distances{to});
    EXPECT_EQ(places(*rest, {{-1, 0.1f, 0}, 0, {0, 1, 0}, kInfinity}), Distances{});
    // What is inside is as if all were seen.
    for (const float x : {-0.3f, 0.3f}) {
      EXPECT_EQ(inside(*half, Vec3f{x, 0.1f, 0.1f}), x < 0);
      EXPECT_EQ(inside(*rest, Vec3f{x, 0.1f, 0.1f}), x > 0);
    }
  }
  const auto walls = built(whole(combine(CsgOp::intersect, {cube({-1, -1, -1}, {0, 1, 1}, 1), cut})));
  EXPECT_EQ(crossings(*walls, ray_along_x()), (Distances{7, 8}));
}

/// Rays that begin inside of an operand whose surface lies beyond their ends, many at once: of its inside
/// there is no cell.
TEST(Csg, RaysMayEndInsideOfAnOperand) {
  const Geometry blob = solid(ExactShape{MetaballsShape{0.5, {{{0, 0, 0}, 20, 1}}}}, 0);
  const auto half = built(whole(combine(CsgOp::intersect, {blob, cube({1, -9, -9}, {30, 9, 9}, 1)})));
  RayBatch rays;
  for (int i = 0; i < 32; ++i)
    rays.push_back(
        {{0, 0.1f * static_cast<float>(i % 8), 0.1f * static_cast<float>(i / 8)}, 0, {1, 0, 0}, 2});
  for (const Isa isa : available_isas()) {
    HitBatch hits;
    hits.resize_uninitialized(rays.size());
    closest_hit(*half, rays.span(), hits.span(), isa);
    for (std::size_t i = 0; i < hits.size(); ++i) {
      EXPECT_EQ(hits[i].t, 1) << to_string(isa) << " " << i;
    }
  }
}

TEST(Csg, DegenerateCombinationsAreNothing) {
  const Ray ray = ray_along_x();
  EXPECT_EQ(crossings(*built(whole({})), ray), Distances{});
  EXPECT_EQ(crossings(*built(whole(combine(CsgOp::intersect, {}))), ray), Distances{});
  EXPECT_EQ(crossings(*built(whole(combine(CsgOp::subtract, {}))), ray), Distances{});
  EXPECT_EQ(crossings(*build_accel({{CsgGeometry{}, {}, kNoId}}), ray), Distances{});
  const Geometry a = cube({0, -1, -1}, {1, 1, 1}, 0), nothing = ball({0, 0, 0}, 0, 1);
  EXPECT_EQ(crossings(*built(whole(combine(CsgOp::intersect, {a, nothing}))), ray), Distances{});
  EXPECT_EQ(crossings(*built(whole(combine(CsgOp::subtract, {a, nothing}))), ray), (Distances{8, 9}));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto accel = built(whole(combine(CsgOp::unite, {a, solid(PlaneShape{{0, 1, 0}, -2}, 2)})));
  EXPECT_EQ(crossings(*accel, {{nan, 0, 0}, 0, {1, 0, 0}, kInfinity}), Distances{});
  EXPECT_EQ(crossings(*accel, {{0, 0, 0}, 0, {0, 0, 0}, kInfinity}), Distances{});
  EXPECT_EQ(crossings(*accel, {{-8, 0, 0}, 2, {1, 0, 0}, 1}), Distances{});
}

/// Only operands along the ray cost, and deep trees do not recurse along it.
TEST(Csg, ManyOperands) {
  std::vector<Geometry> holes{cube({-1, -1, 0}, {100, 1, 1}, 0)};
  for (int i = 0; i < 1000; ++i)
    holes.push_back(ball({0.05 + 0.1 * (i % 500), i < 500 ? 0.0 : 0.5, 0.5}, 0.03, 1));
  const auto flat = built(whole(combine(CsgOp::subtract, holes)));
  EXPECT_EQ(crossings(*flat, ray_along_x(0, 0.5f)).size(), 1002u);
  EXPECT_EQ(crossings(*flat, ray_along_x(0.25f, 0.5f)).size(), 2u);
  CsgExpression deep = combine(CsgOp::unite, {holes[0]});
  for (int i = 1; i <= 200; ++i) {
    CsgExpression next;
    next.op = CsgOp::subtract;
    next.children.push_back(std::move(deep));
    next.children.push_back({CsgOp::operand, {holes[static_cast<std::size_t>(i)]}, {}});
    deep = std::move(next);
  }
  EXPECT_EQ(crossings(*built(whole(std::move(deep))), ray_along_x(0, 0.5f)).size(), 402u);
}

/// A position's error grows by what lies along the ray within the reach of faces that count as coincident.
TEST(Csg, ErrorsOfPositionsHoldTheReach) {
  for (const float direction : {0.25f, -0.25f, 0.0f, 3.0f, -1e-20f}) {
    const double least = 0.125 + 0.5 * std::abs(double{direction});
    EXPECT_GE(widened_error(0.125f, 0.5f, direction), least);
    EXPECT_LE(widened_error(0.125f, 0.5f, direction), least * (1 + 1e-6));
  }
}

/// A ray meets all of a combination or nothing, by whether it runs through the windows, wherever they are on
/// it.
CsgExpression surfaces(std::vector<Geometry> of) { return {CsgOp::surfaces, std::move(of), {}}; }
CsgExpression combine(CsgOp op, std::vector<CsgExpression> children) { return {op, {}, std::move(children)}; }
CsgExpression operand(Geometry g) { return {CsgOp::operand, {std::move(g)}, {}}; }

Geometry disk(const Vec3d& center, double radius, std::uint32_t user) {
  return solid(DiskShape{center, {1, 0, 0}, radius}, user);
}

/// What has no inside shows where it is in the other operands of an intersection, or outside of what is
/// subtracted, and changes nothing else.
TEST(Csg, SurfacesAreCutByTheOtherOperands) {
  const Geometry box = cube({-1, -1, -1}, {1, 1, 1}, 0);
  const auto seen = [](CsgOp op, std::vector<CsgExpression> children, float y = 0.25f) {
    return crossings(*built(whole(combine(op, std::move(children)))), ray_along_x(y, 0.125f));
  };
  const CsgExpression plate = surfaces({disk({0, 0, 0}, 5, 1)});
  EXPECT_EQ(seen(CsgOp::intersect, {operand(box), plate}), Distances{8});
  EXPECT_EQ(seen(CsgOp::intersect, {plate, operand(box)}, 1.5f), Distances{});
  EXPECT_EQ(seen(CsgOp::subtract, {plate, operand(box)}), Distances{});
  EXPECT_EQ(seen(CsgOp::subtract, {plate, operand(box)}, 1.5f), Distances{8});
  EXPECT_EQ(seen(CsgOp::subtract, {operand(box), plate}), (Distances{7, 9}));
  EXPECT_EQ(seen(CsgOp::unite, {operand(box), plate}), (Distances{7, 9}));
  EXPECT_EQ(seen(CsgOp::unite, {operand(box), surfaces({disk({3, 0, 0}, 1, 1)})}), (Distances{7, 9, 11}));
  // Two surfaces have nothing in common; several are one operand.
  EXPECT_EQ(seen(CsgOp::intersect, {plate, surfaces({disk({0.5, 0, 0}, 5, 2)})}), Distances{});
  EXPECT_EQ(
      seen(CsgOp::intersect, {surfaces({disk({0.5, 0, 0}, 5, 2), disk({0.25, 0, 0}, 5, 3)}), operand(box)}),
      (Distances{8.25f, 8.5f}));
  // On the faces of a solid it shows; what is left of a closed surface is open.
  EXPECT_EQ(seen(CsgOp::intersect, {operand(box), surfaces({disk({-1, 0, 0}, 5, 1)})}), Distances{7});
  EXPECT_EQ(seen(CsgOp::intersect, {operand(box), surfaces({disk({1, 0, 0}, 5, 1)})}), Distances{9});
  const Geometry half = solid(PlaneShape{{1, 0, 0}, 0}, 4);
  EXPECT_EQ(seen(CsgOp::intersect, {operand(half), surfaces({box})}), Distances{7});
  EXPECT_EQ(seen(CsgOp::subtract, {surfaces({box}), operand(half)}), Distances{9});
  const Geometry pipe = solid(ExactShape{CylinderShape{{0, -9, 0}, {0, 9, 0}, 0.5, true}}, 5);
  EXPECT_EQ(seen(CsgOp::intersect, {operand(box), surfaces({pipe})}).size(), 2u);
  EXPECT_EQ(seen(CsgOp::intersect, {operand(box), surfaces({pipe})}, 1.5f), Distances{});
  // Neither inside() nor a combination around one in an instance takes surfaces for solids.
  const auto both = built(whole(combine(CsgOp::unite, {operand(box), surfaces({disk({3, 0, 0}, 9, 1)})})));
  EXPECT_TRUE(inside(*both, {0, 0, 0}));
  for (const float x : {-2.0f, 2.0f, 4.0f}) EXPECT_FALSE(inside(*both, {x, 0, 0})) << x;
  EXPECT_EQ(seen(CsgOp::subtract,
                 {operand(cube({-4, -2, -2}, {4, 2, 2}, 6)), operand({InstanceGeometry{both}, {}, 7})}),
            (Distances{4, 7, 9, 12}));
  // A ray may begin anywhere.
  const auto cut = built(whole(combine(CsgOp::intersect, {operand(box), plate})));
  EXPECT_EQ(crossings(*cut, ray_along_x(0.25f, 0, -0.5f)), Distances{0.5f});
  EXPECT_EQ(crossings(*cut, ray_along_x(0.25f, 0, 0.5f)), Distances{});
}

/// Random expressions of balls, boxes and surfaces: which of their surfaces' crossings are seen is asked of
/// the expression at the place itself.
TEST(Csg, SurfacesShowWhereTheRestOfTheExpressionLetsThem) {
  CaseRandom r(31);
  int shown = 0, hidden = 0;
  for (int trial = 0; trial < 400; ++trial) {
    struct Leaf {
      bool is_surface;
      Vec3d center;
      double radius;
      bool contains(const Vec3d& p) const { return length(p - center) < radius; }
    };
    std::vector<Leaf> leaves;
    using Inside = std::function<bool(const Vec3d&, std::size_t)>;
    // A random tree, and whether a point is inside of it if it is taken to be inside of surface number `on`.
    const auto make = [&](const auto& self, int depth, CsgExpression& e) -> Inside {
      if (depth == 0 || r.unit() < 0.2) {
        const Leaf leaf{r.unit() < 0.4, r.vector(), 0.3 + r.unit()};
        const std::size_t number = leaves.size();
        leaves.push_back(leaf);
        const auto user = static_cast<std::uint32_t>(number);
        e = leaf.is_surface ? surfaces({ball(leaf.center, leaf.radius, user)})
                            : operand(ball(leaf.center, leaf.radius, user));
        return
            [=](const Vec3d& p, std::size_t on) { return leaf.is_surface ? on == number : leaf.contains(p); };
      }
      constexpr CsgOp kOps[] = {CsgOp::unite, CsgOp::intersect, CsgOp::subtract};
      e.op = kOps[static_cast<int>(r.unit() * 3)];
      std::vector<Inside> parts;
      e.children.resize(2 + static_cast<std::size_t>(r.unit() * 2));
      for (CsgExpression& child : e.children) parts.push_back(self(self, depth - 1, child));
      return [op = e.op, parts](const Vec3d& p, std::size_t on) {
        std::size_t inside = 0;
        for (const Inside& part : parts) inside += part(p, on);
        if (op == CsgOp::unite) return inside > 0;
        if (op == CsgOp::intersect) return inside == parts.size();
        return inside == 1 && parts[0](p, on);
      };
    };
    CsgExpression e;
    const Inside inside_of = make(make, 3, e);
    const auto accel = built(whole(e));
    for (int k = 0; k < 20; ++k) {
      const Vec3d from = r.vector() * 4.0, way = r.vector() * 1.5 - from;
      const Ray ray{Vec3f(from), 0, Vec3f(way), kInfinity};
      std::vector<Hit> hits;
      all_hits(*accel, ray, hits, available_isas().front());
      for (std::size_t number = 0; number < leaves.size(); ++number) {
        const Leaf& leaf = leaves[number];
        if (!leaf.is_surface) continue;
        const Vec3d o(ray.origin), d(ray.direction), c = o - leaf.center;
        const double b = dot(c, d), dd = dot(d, d),
                     root = b * b - dd * (dot(c, c) - leaf.radius * leaf.radius);
        if (root < 1e-3) continue;
        for (const double side : {-1.0, 1.0}) {
          const double t = (-b + side * std::sqrt(root)) / dd;
          const Vec3d p = o + d * t;
          const bool unclear = std::ranges::any_of(leaves, [&](const Leaf& l) {
            return std::abs(length(p - l.center) - l.radius) < 1e-4 && &l != &leaf;
          });
          if (t < 1e-4 || unclear) continue;
          const bool expected = !inside_of(p, leaves.size()) && inside_of(p, number);
          const bool found = std::ranges::any_of(hits, [&](const Hit& hit) {
            return std::abs(hit.t - t) < 1e-5 && surface_interaction(*accel, ray, hit).user == number;
          });
          ASSERT_EQ(found, expected) << "trial " << trial << ", surface " << number << " at " << t;
          ++(expected ? shown : hidden);
        }
      }
    }
  }
  EXPECT_GT(shown, 1000);
  EXPECT_GT(hidden, 1000);
}

TEST(Csg, WindowsHideWhatTheyDoNotCut) {
  CsgExpression e = combine(CsgOp::unite, {cube({0, -4, -4}, {1, 4, 4}, 0), ball({3, 0, 0}, 1, 1)});
  e.windows = {ball({-2, 0, 0}, 1, 0)};
  const auto accel = built(whole(e));
  EXPECT_EQ(crossings(*accel, ray_along_x(0.5f, 0.25f)).size(), 4u);
  EXPECT_EQ(crossings(*accel, ray_along_x(1.5f)), Distances{});
  // The window lies before the beginning, around it, and behind all.
  EXPECT_EQ(crossings(*accel, ray_along_x(0, 0, -0.5f)), Distances{});
  EXPECT_EQ(crossings(*accel, ray_along_x(0, 0, -2)), (Distances{2, 3, 4, 6}));
  e.windows = {ball({50, 0, 0}, 1, 0)};
  EXPECT_EQ(crossings(*built(whole(e)), ray_along_x(0, 0, -0.5f)), (Distances{0.5f, 1.5f, 2.5f, 4.5f}));
  // Each of several must be met, and they move with the combination.
  e.windows = {ball({-2, 0, 0}, 1, 0), cube({-5, 0.5, -1}, {-4, 2, 1}, 0)};
  const auto moved = built(whole(e, Affine::translation({0, 8, 0})));
  EXPECT_EQ(crossings(*moved, ray_along_x(8.75f)).size(), 4u);
  EXPECT_EQ(crossings(*moved, ray_along_x(8.25f)), Distances{});
  EXPECT_EQ(crossings(*moved, ray_along_x(9.75f)), Distances{});
  // Half-spaces: inside of one there may be no crossing.
  e.windows = {solid(PlaneShape{{0, 1, 0}, 0.25}, 0)};
  EXPECT_EQ(crossings(*built(whole(e)), ray_along_x(0)).size(), 4u);
  EXPECT_EQ(crossings(*built(whole(e)), ray_along_x(0.5f)), Distances{});
  // Combinations are windows, too.
  e.windows = {whole(combine(CsgOp::subtract, {ball({-2, 0, 0}, 1, 0), ball({-2, 0, 0}, 0.5, 0)}))};
  EXPECT_EQ(crossings(*built(whole(e)), ray_along_x(0.75f)).size(), 4u);
  EXPECT_EQ(crossings(*built(whole(e)), ray_along_x(1.25f)), Distances{});
}

}  // namespace
}  // namespace oktett::csg_test
