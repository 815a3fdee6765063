#include "accel/dynamic_accel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "core/error.h"
#include "tests/accel/same_hits.h"
#include "tests/support/limits.h"
#include "verify/checks/changes.h"
#include "verify/oracles/mesh.h"

namespace oktett::dynamic_accel_test {
namespace {

std::shared_ptr<const TriangleMesh> ball(int levels = 3) {
  return std::make_shared<const TriangleMesh>(make_icosphere(levels).mesh);
}

Geometry a_mesh(const Affine& transform = {}, std::uint32_t user = kNoId) {
  return {MeshGeometry{}, transform, user};
}

/// The positions of a mesh, each moved by `move`.
template <class Move>
std::vector<Vec3f> moved(const TriangleMesh& mesh, const Move& move) {
  std::vector<Vec3f> all(mesh.positions.begin(), mesh.positions.end());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = move(all[i], i);
  return all;
}

Ray along_x(float y = 0.1f) { return {{-9, y, 0.2f}, 0, {1, 0, 0}, kInf}; }

TEST(DynamicAccel, RandomChangesGiveTheHitsOfAFreshStructure) {
  const ChangesTally t = verify_changes(150, available_isas());
  EXPECT_EQ(t.wrong(), 0u) << t.failure;
  EXPECT_EQ(t.sequences, 150u);
  EXPECT_GT(t.refits, 100u);
  EXPECT_GT(t.builds, 50u);
  EXPECT_GT(t.hits, t.rays / 5);
  EXPECT_LT(t.hits, t.rays);
}

TEST(DynamicAccel, WhatChangesIsSeenAndHasItsNumber) {
  DynamicAccel scene;
  EXPECT_FALSE(closest_hit(*scene.accel(), along_x()).valid());
  const std::uint32_t near = scene.add(ball(), a_mesh(Affine::translation({-3, 0, 0})));
  const std::uint32_t far = scene.add({SpheresShape{{{{3, 0, 0}, 1}}}, {}, 77});
  EXPECT_EQ(near, 0u);
  EXPECT_EQ(far, 1u);
  const auto seen = [&] {
    const auto accel = scene.accel();
    const Hit hit = closest_hit(*accel, along_x());
    return hit.valid() ? identify(*accel, hit).user : kNoId;
  };
  EXPECT_EQ(seen(), near);
  scene.set_enabled(near, false);
  EXPECT_EQ(seen(), 77u);
  EXPECT_FALSE(scene.is_enabled(near));
  scene.set_enabled(near, true), scene.set_transform(near, Affine::translation({5, 0, 0}));
  EXPECT_EQ(seen(), 77u);
  EXPECT_EQ(scene.geometry(near).transform.m[0][3], 5);
  scene.remove(far);
  EXPECT_EQ(seen(), near);
  EXPECT_EQ(scene.add({BoxShape{{-5, -1, -1}, {-4, 1, 1}}, {}, kNoId}), 2u);
  EXPECT_EQ(seen(), 2u);
  EXPECT_EQ(scene.numbers(), (std::vector<std::uint32_t>{near, 2}));
}

TEST(DynamicAccel, MasksTellWhatRaysMeet) {
  DynamicAccel scene;
  const std::uint32_t near = scene.add(ball(), a_mesh(Affine::translation({-3, 0, 0})));
  const std::uint32_t far = scene.add(ball(), a_mesh(Affine::translation({3, 0, 0})));
  scene.set_mask(near, 1), scene.set_mask(far, 2);
  const auto seen = [&](std::uint32_t mask) {
    const Hit hit = closest_hit(*scene.accel(mask), along_x());
    return hit.valid() ? identify(*scene.accel(), hit).user : kNoId;
  };
  EXPECT_EQ(seen(~0u), near);
  EXPECT_EQ(seen(1), near);
  EXPECT_EQ(seen(2), far);
  EXPECT_EQ(seen(4), kNoId);
  EXPECT_EQ(scene.accel(3), scene.accel());
  EXPECT_EQ(scene.accel(6), scene.accel(2));
  scene.set_mask(near, 0);
  EXPECT_EQ(seen(~0u), far);
  EXPECT_EQ(scene.work().builds, 2u);
}

// A stretched sphere stands in the tree as an instance, which is counted also where it is left out.
TEST(DynamicAccel, WhatMasksLeaveOutKeepsTheNumbersOfTheOthers) {
  DynamicAccel scene;
  const Affine stretched = Affine::translation({-5, 0, 0}) * Affine::scaling({1, 2, 3});
  const std::uint32_t egg = scene.add({SpheresShape{{SphereShape{}}}, stretched, kNoId});
  const std::uint32_t far = scene.add(ball(), a_mesh(Affine::translation({3, 0, 0})));
  scene.set_mask(egg, 1);
  const Hit hit = closest_hit(*scene.accel(2), along_x());
  EXPECT_EQ(identify(*scene.accel(), hit).user, far);
  scene.set_enabled(egg, false);
  EXPECT_EQ(closest_hit(*scene.accel(), along_x()).t, hit.t);
}

// A sphere that is stretched is an instance, which is numbered, also where it is hidden and no longer
// stretched.
TEST(DynamicAccel, WhatIsHiddenAndStretchedNoMoreLosesItsNumber) {
  DynamicAccel scene;
  const std::uint32_t egg = scene.add({SpheresShape{{SphereShape{}}}, Affine::scaling({1, 2, 3}), kNoId, 1});
  const std::uint32_t near = scene.add(ball(), a_mesh(Affine::translation({3, 0, 0})));
  scene.add(ball(), a_mesh(Affine::translation({9, 0, 0})));
  scene.accel(2);
  scene.set_transform(egg, {});
  const Hit hit = closest_hit(*scene.accel(2), along_x());
  EXPECT_EQ(identify(*scene.accel(), hit).user, near);
}

TEST(DynamicAccel, AMeshOfItsOwnMayBeGivenAgain) {
  DynamicAccel scene;
  const std::uint32_t number = scene.add(ball(), a_mesh());
  Geometry flat = scene.geometry(number);
  std::get<MeshGeometry>(flat.shape).smooth = false;
  scene.replace(number, flat);
  const float t = closest_hit(*scene.accel(), along_x()).t;
  const TriangleMesh& mesh = *std::get<MeshGeometry>(scene.geometry(number).shape).mesh;
  scene.set_vertices(number, {mesh.positions.data(), mesh.positions.size()});
  EXPECT_EQ(closest_hit(*scene.accel(), along_x()).t, t);
  EXPECT_THROW(scene.add(ball(), {BoxShape{}, {}, kNoId}), Error);
  EXPECT_THROW(scene.add(nullptr, a_mesh()), Error);
}

TEST(DynamicAccel, StructuresThatWereTakenStayAsTheyWere) {
  DynamicAccel scene;
  const auto mesh = ball();
  const std::uint32_t number = scene.add(mesh, a_mesh());
  const auto before = scene.accel();
  EXPECT_EQ(before, scene.accel());
  const Hit hit = closest_hit(*before, along_x());
  const Vec3f normal = surface_interaction(*before, along_x(), hit).geometric_normal;
  scene.set_vertices(number, moved(*mesh, [](const Vec3f& p, std::size_t) { return p * 2.0f; }));
  const auto after = scene.accel();
  EXPECT_NE(before, after);
  EXPECT_LT(closest_hit(*after, along_x()).t, hit.t - 0.9f);
  scene.remove(number);
  EXPECT_FALSE(closest_hit(*scene.accel(), along_x()).valid());
  EXPECT_EQ(closest_hit(*before, along_x()), hit);
  EXPECT_EQ(surface_interaction(*before, along_x(), hit).geometric_normal, normal);
  // The mesh that was given is the caller's.
  EXPECT_TRUE(std::ranges::equal(mesh->positions, ball()->positions));
}

TEST(DynamicAccel, TreesAreKeptRefittedAndBuiltAnew) {
  DynamicAccel scene;
  const auto mesh = ball();
  const std::uint32_t still = scene.add(ball(), a_mesh(Affine::translation({0, 5, 0})));
  const std::uint32_t moving = scene.add(mesh, a_mesh());
  scene.accel();
  EXPECT_EQ(scene.work().builds, 2u);
  // What moves as a whole, and what comes and goes.
  for (int i = 0; i < 3; ++i) {
    scene.set_transform(still, Affine::translation({1.0 * i, 5, 0}));
    scene.set_enabled(moving, i == 2);
    scene.accel();
  }
  EXPECT_EQ(scene.work().builds, 2u);
  EXPECT_EQ(scene.work().refits, 0u);
  scene.set_vertices(moving, moved(*mesh, [](const Vec3f& p, std::size_t) { return p * 1.5f; }));
  scene.accel();
  EXPECT_EQ(scene.work().refits, 1u);
  // Neighbours are torn apart, so the tree no longer fits.
  scene.set_vertices(moving, moved(*mesh, [](const Vec3f& p, std::size_t i) {
                       return i % 3 == 0 ? p : Vec3f{p.y, p.z, -p.x};
                     }));
  scene.accel();
  EXPECT_EQ(scene.work().builds, 3u);
  EXPECT_EQ(scene.work().refits, 1u);
}

// The tree above is refitted; a tree that is alone and not moved is the structure itself.
TEST(DynamicAccel, WhatMovesIsSeenWhereItIsWithTheNumbersOfAFreshStructure) {
  DynamicAccel scene;
  const std::uint32_t number = scene.add(ball(), a_mesh(Affine::translation({5, 0, 0})));
  const auto hit = [&] { return closest_hit(*scene.accel(), along_x()); };
  const float far = hit().t;
  EXPECT_EQ(hit().instance, 0u);
  scene.set_transform(number, Affine::translation({4, 0, 0}));
  EXPECT_NEAR(hit().t, far - 1, 1e-5);
  EXPECT_EQ(bounds(*scene.accel()).center().x, 4);
  scene.set_transform(number, {});
  EXPECT_NEAR(hit().t, far - 5, 1e-5);
  EXPECT_EQ(hit().instance, kNoId);
  EXPECT_EQ(scene.work().builds, 1u);
}

TEST(DynamicAccel, WrongCallsAreErrors) {
  DynamicAccel scene;
  const std::uint32_t mesh = scene.add(ball(0), a_mesh());
  const std::uint32_t box = scene.add({BoxShape{}, {}, kNoId});
  const auto message = [](const auto& call) {
    try {
      call();
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::vector<Vec3f> points(5);
  EXPECT_EQ(message([&] { scene.set_enabled(9, true); }), "there is no geometry 9");
  EXPECT_EQ(message([&] { scene.set_vertices(box, points); }), "geometry 1 is no mesh: it has no vertices");
  EXPECT_EQ(message([&] { scene.set_vertices(mesh, points, 10); }),
            "geometry 0 has 12 vertices; 5 from number 10 on were given");
  EXPECT_EQ(message([&] { scene.set_vertices(mesh, points, 0, points); }),
            "geometry 0 has 0 normals; 5 from number 0 on were given");
  EXPECT_EQ(message([&] {
              scene.set_transform(box, Affine::scaling({1, 0, 1}));
            }),
            "the transform of geometry 1 has no inverse");
  scene.remove(box);
  EXPECT_EQ(message([&] { scene.remove(box); }), "there is no geometry 1: it was removed");
}

}  // namespace
}  // namespace oktett::dynamic_accel_test
