#include "accel/trace_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "accel/time/instance_motion.h"
#include "core/error.h"
#include "tests/support/dice.h"
#include "tests/support/limits.h"
#include "tests/support/sanitizers.h"
#include "verify/checks/trace_scenes.h"
#include "verify/oracles/mesh.h"

namespace oktett::trace_scene_test {
namespace {

using Roll = Dice<float>;
using Scene = std::shared_ptr<const TraceScene>;

template <class Shape>
SceneGeometry thing(Shape shape, std::uint32_t number = 0, std::uint32_t mask = ~0u) {
  SceneGeometry g;
  g.shape = std::move(shape), g.number = number, g.mask = mask;
  return g;
}

Geometry ball_at(const Vec3d& center, double radius = 1, const Affine& transform = {}) {
  return {SpheresShape{{{center, radius}}}, transform, kNoId};
}

SceneInstance shown(Scene child, std::vector<Affine> transforms = {Affine{}}) {
  return {std::move(child), std::move(transforms), {}};
}

Ray along_x(float y = 0.1f, float z = 0.2f, float tmax = kInf) { return {{-9, y, z}, 0, {1, 0, 0}, tmax}; }

/// Positions between keys as MovingMesh says, in float.
TriangleMesh mesh_at(const MovingMesh& moving, float time) {
  const auto keys = static_cast<int>(moving.later_positions.size()) + 1;
  const float s = !(time > 0) ? 0.0f : time >= 1 ? 1.0f : time;
  const float place = s * static_cast<float>(keys - 1);
  const int first = std::min(static_cast<int>(place), keys - 2);
  const float f = place - static_cast<float>(first);
  TriangleMesh mesh = *moving.mesh;
  const auto& a =
      first == 0 ? moving.mesh->positions : moving.later_positions[static_cast<std::size_t>(first - 1)];
  const auto& b = moving.later_positions[static_cast<std::size_t>(first)];
  for (std::size_t i = 0; i < a.size(); ++i)
    for (int k = 0; k < 3; ++k) mesh.positions[i][k] = (1 - f) * a[i][k] + f * b[i][k];
  return mesh;
}

/// `mesh` at the first key; at the others each vertex is off by up to `reach`.
MovingMesh wobbling(TriangleMesh mesh, int keys, float reach, Roll& dice) {
  MovingMesh moving{std::make_shared<const TriangleMesh>(std::move(mesh)), {}};
  for (int k = 1; k < keys; ++k) {
    Column<Vec3f>& later = moving.later_positions.emplace_back(moving.mesh->positions);
    for (Vec3f& p : later) p += dice.vec(reach);
  }
  return moving;
}

/// Triangles in no order, some without an area, and one with a vertex that is not a number.
TriangleMesh litter(int triangles, Roll& dice) {
  TriangleMesh mesh;
  for (int i = 0; i < 3 * triangles; ++i) {
    mesh.indices.push_back(static_cast<std::uint32_t>(i));
    mesh.positions.push_back(i % 30 == 1 ? mesh.positions.back() : dice.vec(2));
  }
  mesh.positions[17].y = kNan;
  return mesh;
}

bool same(const SceneHit& a, const Hit& b) {
  return a.valid() == b.valid() && std::bit_cast<std::uint32_t>(a.t) == std::bit_cast<std::uint32_t>(b.t) &&
         std::bit_cast<std::uint32_t>(a.u) == std::bit_cast<std::uint32_t>(b.u) &&
         std::bit_cast<std::uint32_t>(a.v) == std::bit_cast<std::uint32_t>(b.v) && a.primitive == b.item;
}

/// Rejects all, and counts.
class Counting final : public HitFilter {
 public:
  std::size_t judge(const Ray&, const RayContext& context, std::span<SceneHit> hits) const override {
    *static_cast<std::size_t*>(context.user) += hits.size();
    return hits.size();
  }
};

std::size_t crossings(const TraceScene& scene, const Ray& ray, float time, Isa isa) {
  const Counting counting;
  std::size_t count = 0;
  EXPECT_FALSE(closest_hit(scene, ray, {time, ~0u, &counting, &count}, isa).valid());
  return count;
}

// ---- All together.

TEST(TraceScenes, RandomScenesHaveTheHitsOfTheirPartsAlone) {
  const unsigned count = test::cases(400);
  const TraceScenesTally t = verify_trace_scenes(count, available_isas());
  EXPECT_EQ(t.wrong(), 0u) << t.failure;
  EXPECT_EQ(t.scenes, count);
  EXPECT_GT(t.hits, t.rays / 4);
  EXPECT_LT(t.hits, t.rays);
  EXPECT_GT(t.judged, t.rays / 2);
}

// ---- Meshes that move.

TEST(TraceScenes, AMovingMeshHasTheBitsOfTheInterpolatedOne) {
  Roll dice(1);
  std::size_t hits = 0;
  for (const int keys : {2, 3, 5})
    for (const bool closed : {true, false}) {
      const MovingMesh moving =
          wobbling(closed ? make_icosphere(2).mesh : litter(150, dice), keys, closed ? 0.3f : 3.0f, dice);
      const Scene scene = build_trace_scene({thing(moving, 4)});
      for (const float time : {0.0f, 1.0f, 0.25f, 0.5f, 0.75f, 0x1p-149f, 1 - 0x1p-24f, dice(), dice(), kNan,
                               -2.0f, 3.0f, kInf}) {
        const TriangleMesh mesh = mesh_at(moving, time);
        const auto accel = build_accel({{MeshGeometry{&mesh}, {}, kNoId}});
        for (int i = 0; i < 40; ++i) {
          Vec3f target = dice.vec(1.5f);
          const Vec3f corner =
              mesh.positions[static_cast<std::size_t>(dice.below(480)) % mesh.positions.size()];
          if (i % 2 == 0 && corner.y == corner.y) target = corner;
          const Vec3f from = dice.vec(5);
          const Ray ray{from, 0, target - from, i % 3 == 0 ? 1.0f : kInf};
          const Hit expected = closest_hit(*accel, ray);
          hits += expected.valid();
          for (const Isa isa : available_isas()) {
            const SceneHit hit = closest_hit(*scene, ray, {time}, isa);
            ASSERT_TRUE(same(hit, expected))
                << to_string(isa) << " time " << time << " t " << hit.t << " of " << hit.primitive << ", not "
                << expected.t << " of " << expected.item;
            ASSERT_EQ(any_hit(*scene, ray, {time}, isa), expected.valid()) << to_string(isa);
            if (!hit.valid()) continue;
            ASSERT_EQ(hit.geometry, 4u);
            const std::uint32_t* const index = &mesh.indices[3 * std::size_t{hit.primitive}];
            const Vec3f &a = mesh.positions[index[0]], &b = mesh.positions[index[1]],
                        &c = mesh.positions[index[2]];
            ASSERT_EQ(hit.normal, cross(b - a, c - a));
          }
        }
      }
    }
  EXPECT_GT(hits, 500u);
}

TEST(TraceScenes, ClosedMovingMeshesHaveNoHoles) {
  Roll dice(2);
  for (const TriangleMesh& start : {make_icosphere(2).mesh, make_cube().mesh, make_globe(9, 6).mesh}) {
    const MovingMesh moving = wobbling(start, 3, 0.2f, dice);
    const Scene scene = build_trace_scene({thing(moving)});
    const Scene inner =
        build_trace_scene({thing(shown(scene, {Affine{}, Affine::translation({0.1, 0, 0})}))});
    for (int i = 0; i < 400; ++i) {
      const float time = i % 4 == 0 ? 0.5f : dice();
      const TriangleMesh mesh = mesh_at(moving, time);
      const std::uint32_t* const index =
          &mesh.indices[3 * (static_cast<std::size_t>(dice.below(10000)) % mesh.triangle_count())];
      const Vec3f a = mesh.positions[index[0]], b = mesh.positions[index[1]];
      const Vec3f target = i % 2 == 0 ? a : a + (b - a) * dice();
      const Vec3f from = i % 3 == 0 ? Vec3f{} : dice.vec(0.1f);
      const Isa isa = available_isas()[static_cast<std::size_t>(i) % available_isas().size()];
      const Ray out{from, 0, target - from, kInf};
      ASSERT_TRUE(closest_hit(*scene, out, {time}, isa).valid()) << i;
      ASSERT_TRUE(any_hit(*scene, out, {time}, isa));
      ASSERT_EQ(crossings(*scene, out, time, isa) % 2, 1u) << i;
      ASSERT_EQ(crossings(*inner, out, time, isa) % 2, 1u) << i;
      const Vec3f outside = dice.vec(1) + Vec3f{4, 0, 0};
      ASSERT_EQ(crossings(*scene, {outside, 0, target - outside, kInf}, time, isa) % 2, 0u) << i;
    }
  }
}

TEST(TraceScenes, TrianglesThatAreNotFiniteAtSomeKeyAreLeftOut) {
  MovingMesh moving{std::make_shared<const TriangleMesh>(make_cube().mesh), {}};
  moving.later_positions.resize(2, moving.mesh->positions);
  for (Vec3f& p : moving.later_positions[1]) p.x = kInf;
  EXPECT_FALSE(any_hit(*build_trace_scene({thing(moving)}), along_x()));
  moving.later_positions.pop_back();
  EXPECT_TRUE(any_hit(*build_trace_scene({thing(moving)}), along_x()));
}

// ---- Instances.

TEST(TraceScenes, TurningMapsTurnAtConstantSpeed) {
  Dice<double> dice(3);
  for (int i = 0; i < 300; ++i) {
    const Vec3d axis = normalize(dice.vec(1)), axis0 = normalize(dice.vec(1));
    const double start = dice.range(0, 360), degrees = i < 100 ? dice.range(0, 1e-5) : dice.range(0, 179);
    const auto quaternion = [&](TurningMap& map, const Vec3d& a, double angle, double size) {
      const double half = angle * M_PI / 360;
      const Vec3d v = a * std::sin(half);
      const double q[] = {std::cos(half), v.x, v.y, v.z};
      for (int k = 0; k < 4; ++k) map.quaternion[k] = size * q[k];
    };
    SceneInstance instance;
    instance.turning.resize(2);
    TurningMap &a = instance.turning[0], &b = instance.turning[1];
    for (TurningMap* map : {&a, &b}) {
      map->outer = dice.vec(3);
      map->inner =
          Affine::translation(dice.vec(2)) * Affine::scaling({2, 0.5, 1}) * Affine::rotation(dice.vec(40));
    }
    // The second rotation is the first, followed by one about `axis`; of either sign, and any length.
    quaternion(a, axis0, start, dice.range(0.1, 5));
    TurningMap turn;
    quaternion(turn, axis, degrees, i % 2 == 0 ? 3 : -0.2);
    const double *p = turn.quaternion, *q = a.quaternion;
    const double product[] = {p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
                              p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
                              p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1],
                              p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0]};
    std::copy_n(product, 4, b.quaternion);
    Box box;
    box.grow(Vec3f(dice.vec(2))), box.grow(Vec3f(dice.vec(2)));
    const Box first = moved_bounds(instance, box, 0), last = moved_bounds(instance, box, 1);
    for (int k = 0; k <= 20; ++k) {
      const float f = static_cast<float>(k) / 20;
      const double s = static_cast<double>(f);
      const Affine rotation = Affine::rotation(axis, degrees * s) * Affine::rotation(axis0, start);
      const Affine map = map_at(instance, {0, f});
      const auto between = [&](float x, float y) { return KeyTime{0, f}.between(x, y); };
      for (int j = 0; j < 20; ++j) {
        // Corners too.
        Vec3d at;
        for (int c = 0; c < 3; ++c) {
          const double part = j < 8 ? j >> c & 1 : dice();
          at[c] = static_cast<double>(box.lo[c]) * (1 - part) + static_cast<double>(box.hi[c]) * part;
        }
        const Vec3d moved = a.inner.point(at) * (1 - s) + b.inner.point(at) * s;
        const Vec3d expected = a.outer * (1 - s) + b.outer * s + rotation.point(moved);
        const Vec3d found = map.point(at);
        ASSERT_LT(length(found - expected), 1e-8) << i << ' ' << degrees << ' ' << f;
        for (int c = 0; c < 3; ++c) {
          ASSERT_LE(static_cast<double>(between(first.lo[c], last.lo[c])), expected[c]) << i << ' ' << f;
          ASSERT_GE(static_cast<double>(between(first.hi[c], last.hi[c])), expected[c]) << i << ' ' << f;
        }
      }
    }
  }
}

TEST(TraceScenes, InstancesNestEightLevelsDeep) {
  Roll dice(4);
  const MovingMesh moving = wobbling(make_icosphere(1).mesh, 2, 0.2f, dice);
  Scene scene = build_trace_scene({thing(moving, 50)});
  std::vector<Affine> first, last;
  for (std::uint32_t level = 0; level < InstanceChain::kMost; ++level) {
    first.push_back(Affine::translation({0.1, 0.2, -0.1}) * Affine::rotation({10, 20, 5}));
    last.push_back(Affine::rotation({0, 5, 30}) * Affine::scaling({1.1, 0.9, 1}));
    std::vector<Affine> keys{first.back()};
    if (level % 2 == 1) keys.push_back(last.back());
    if (level % 2 == 0) last.back() = first.back();
    if (level % 3 == 2) {
      scene = build_trace_scene({thing(SceneInstances{{scene}, {{first.back(), 0}}, {}, {}}, level)});
      last.back() = first.back();
    } else {
      scene = build_trace_scene({thing(shown(scene, keys), level)});
    }
  }
  EXPECT_THROW(build_trace_scene({thing(shown(scene))}), Error);
  for (const float time : {0.0f, 0.3f, 0.5f, 1.0f}) {
    const TriangleMesh mesh = mesh_at(moving, time);
    auto accel = build_accel({{MeshGeometry{&mesh}, {}, kNoId}});
    for (std::size_t k = 0; k < first.size(); ++k) {
      const double f = static_cast<double>(time);
      Geometry g{InstanceGeometry{accel}, {}, kNoId};
      for (std::size_t c = 0; c < 12; ++c)
        g.transform.m[c / 4][c % 4] = first[k] == last[k]
                                          ? first[k].m[c / 4][c % 4]
                                          : (1 - f) * first[k].m[c / 4][c % 4] + f * last[k].m[c / 4][c % 4];
      accel = build_accel({std::move(g)});
    }
    int hits = 0;
    for (int i = 0; i < 200; ++i) {
      const Vec3f from = dice.vec(4);
      const Ray ray{from, 0, dice.vec(1) - from, i % 2 == 0 ? 1.0f : kInf};
      const Hit expected = closest_hit(*accel, ray);
      hits += expected.valid();
      for (const Isa isa : available_isas()) {
        const SceneHit hit = closest_hit(*scene, ray, {time}, isa);
        ASSERT_TRUE(same(hit, expected)) << to_string(isa) << ' ' << i << ' ' << hit.t << ' ' << expected.t;
        ASSERT_EQ(any_hit(*scene, ray, {time}, isa), expected.valid());
        if (!hit.valid()) continue;
        ASSERT_EQ(hit.geometry, 50u);
        ASSERT_EQ(hit.chain.count, 8u);
        for (std::uint32_t k = 0; k < 8; ++k) ASSERT_EQ(hit.chain.geometry[k], 7 - k);
      }
    }
    EXPECT_GT(hits, 15);
  }
}

TEST(TraceScenes, ShortRaysFindWhatInstancesHideIt) {
  const Scene child = build_trace_scene({thing(ball_at({}))});
  for (const std::vector<Affine>& keys :
       {std::vector<Affine>{Affine{}}, {Affine{}, Affine{}}, {Affine{}, Affine::translation({0, 9, 0})}}) {
    const Scene scene = build_trace_scene({thing(shown(child, keys))});
    EXPECT_TRUE(any_hit(*scene, along_x(0, 0, 8.5f)));
    EXPECT_FALSE(any_hit(*scene, along_x(0, 0, 7.5f)));
    EXPECT_TRUE(any_hit(*scene, along_x(0, 0)));
  }
}

TEST(TraceScenes, WhatIsFlatAtAMomentIsNotThere) {
  const Scene child = build_trace_scene({thing(ball_at({}))});
  const Affine flat = Affine::scaling({1, 1, 0}), nothing = Affine::scaling({kNanDouble, 1, 1});
  const Scene scene = build_trace_scene({thing(shown(child, {flat, Affine{}}))});
  EXPECT_FALSE(any_hit(*scene, along_x(0, 0), {0}));
  EXPECT_TRUE(any_hit(*scene, along_x(0, 0), {0.5f}));
  EXPECT_FALSE(any_hit(*build_trace_scene({thing(shown(child, {nothing, Affine{}}))}), along_x(0, 0), {1}));
  SceneInstance turned = shown(child);
  turned.turning.resize(2);
  EXPECT_TRUE(any_hit(*build_trace_scene({thing(turned)}), along_x(0, 0), {0.5f}));
  for (double& x : turned.turning[1].quaternion) x = 0;
  EXPECT_FALSE(any_hit(*build_trace_scene({thing(turned)}), along_x(0, 0), {0.5f}));
}

TEST(TraceScenes, BoundsAreThoseOfTheFirstKeyAndTheLast) {
  const Scene child = build_trace_scene({thing(ball_at({}))});
  const Scene scene = build_trace_scene(
      {thing(shown(child, {Affine{}, Affine::translation({8, 0, 0})}), 1), thing(ball_at({0, 5, 0}), 2)});
  const SceneBounds b = bounds(*scene);
  EXPECT_NEAR(b.first.lo.x, -1, 1e-4);
  EXPECT_NEAR(b.first.hi.x, 1, 1e-4);
  EXPECT_NEAR(b.last.hi.x, 9, 1e-4);
  EXPECT_NEAR(b.last.lo.x, -1, 1e-4);
  EXPECT_NEAR(b.first.hi.y, 6, 1e-4);
  EXPECT_NEAR(b.last.hi.y, 6, 1e-4);
}

// ---- Equal distances.

TEST(TraceScenes, OfEqualDistancesWhatIsGivenFirstCountsAndInstancesLast) {
  const auto cube = std::make_shared<const TriangleMesh>(make_cube().mesh);
  const MovingMesh two{cube, {cube->positions}}, three{cube, {cube->positions, cube->positions}};
  const Geometry fixed{MeshGeometry{cube.get()}, {}, kNoId};
  const Scene fixed_child = build_trace_scene({thing(fixed)}), moving_child = build_trace_scene({thing(two)});
  const std::vector<Affine> moves{Affine{}, Affine{}};
  std::vector<SceneGeometry> all;
  const auto add = [&](auto shape) { all.push_back(thing(shape, static_cast<std::uint32_t>(all.size()))); };
  add(shown(fixed_child)), add(shown(fixed_child, moves)), add(shown(moving_child));
  add(shown(moving_child, moves));
  add(SceneInstances{{fixed_child, moving_child}, {{Affine{}, 1}, {Affine{}, 0}}, {}, {}});
  add(two), add(fixed), add(three), add(two), add(fixed);
  Roll dice(5);
  for (int i = 0; i < 200; ++i) {
    // In any order of what is given, and nested once more.
    for (std::size_t k = all.size(); k-- > 1;)
      std::swap(all[k], all[static_cast<std::size_t>(dice.below(static_cast<int>(k) + 1))]);
    const auto count = static_cast<std::size_t>(1 + dice.below(5));
    const std::vector<SceneGeometry> some(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count));
    const auto outside = [](const SceneGeometry& g) { return g.number >= 5; };
    auto first = std::find_if(some.begin(), some.end(), outside);
    if (first == some.end()) first = some.begin();
    const Scene scene = build_trace_scene(some);
    for (const Scene& asked : {scene, build_trace_scene({thing(shown(scene, moves), 99)})}) {
      const SceneHit hit = closest_hit(*asked, along_x(), {i % 2 == 0 ? 0.0f : 1.0f});
      ASSERT_EQ(hit.t, 8);
      const std::uint32_t nested = asked == scene ? 0 : 1;
      ASSERT_EQ(hit.chain.count, nested + (first->number < 5 ? 1 : 0));
      ASSERT_EQ(hit.chain.count > nested ? hit.chain.geometry[nested] : hit.geometry, first->number) << i;
      ASSERT_TRUE(first->number != 4 || hit.chain.primitive[nested] == 0);
    }
  }
}

// ---- What is named.

TEST(TraceScenes, DistortedSpheresMirroredMeshesAndCombinationsAreNamedAndHaveNormals) {
  const Affine flat = Affine::scaling({1, 1, 0.5});
  SpheresShape spheres;
  for (int i = 0; i < 4; ++i) spheres.spheres.push_back({{0, 3.0 * i, 0}, 1});
  const auto dented = std::make_shared<CsgExpression>();
  dented->op = CsgOp::subtract, dented->children.resize(2);
  dented->children[0].solids = {{BoxShape{}, {}, 1}};
  dented->children[1].solids = {{SpheresShape{{{{9, 9, 9}, 1}, {{-1, 0, 0}, 0.5}}}, {}, 2}};
  const OracleMesh cube = make_cube();
  const Affine up = Affine::translation({0, 0, 6});
  const std::vector<SceneGeometry> things{
      thing(Geometry{spheres, flat, kNoId}, 1), thing(Geometry{CsgGeometry{dented}, up, kNoId}, 2),
      thing(Geometry{MeshGeometry{&cube.mesh}, up * up * Affine::scaling({1, -1, 1}), kNoId}, 3),
      thing(Geometry{ExactShape{TorusShape{}}, up * up * up, kNoId}, 4)};
  const Scene plain = build_trace_scene(things);
  for (const Scene& scene : {plain, build_trace_scene({thing(shown(plain))}),
                             build_trace_scene({thing(shown(plain, {{}, {}}))})}) {
    for (std::uint32_t i = 0; i < 4; ++i) {
      const SceneHit hit = closest_hit(*scene, along_x(3.0f * static_cast<float>(i), 0.2f));
      ASSERT_EQ(hit.geometry, 1u);
      EXPECT_EQ(hit.primitive, i);
      // The gradient of x^2 + 4 z^2.
      const Vec3f n = normalize(hit.normal), expected = normalize(Vec3f{-std::sqrt(1 - 0.16f), 0, 0.8f});
      EXPECT_LT(length(n - expected), 1e-5f);
    }
    const SceneHit dent = closest_hit(*scene, along_x(0, 6.1f));
    EXPECT_EQ(dent.geometry, 2u);
    EXPECT_EQ(dent.primitive, 0u);
    EXPECT_GT(dent.t, 8);
    EXPECT_LT(dent.normal.x, 0);
    const SceneHit mirrored = closest_hit(*scene, along_x(0.1f, 12));
    EXPECT_EQ(mirrored.geometry, 3u);
    EXPECT_EQ(mirrored.t, 8);
    // (b - a) x (c - a) of what is mirrored points inwards.
    EXPECT_EQ(mirrored.normal, (Vec3f{4, 0, 0}));
    const SceneHit torus = closest_hit(*scene, along_x(0, 18));
    EXPECT_EQ(torus.geometry, 4u);
    EXPECT_NEAR(torus.normal.x, -1, 1e-5);
  }
}

TEST(TraceScenes, WhatIsNearerThanAnInstanceHasItsOwnNormal) {
  // The box of the instance begins before the combination, what a ray hits there lies behind it.
  auto mesh = std::make_shared<TriangleMesh>();
  for (const Vec3f& p : {Vec3f{-5, 20, 0}, {-5, 21, 0}, {-5, 20, 1}, {4, -3, -3}, {5, 6, -3}, {6, -3, 6}})
    mesh->positions.push_back(p);
  for (std::uint32_t i = 0; i < 6; ++i) mesh->indices.push_back(i);
  const auto box = std::make_shared<CsgExpression>();
  box->op = CsgOp::subtract, box->children.resize(2);
  box->children[0].solids = {{BoxShape{}, {}, 1}};
  box->children[1].solids = {{SpheresShape{{{{9, 9, 9}, 1}}}, {}, 2}};
  const Scene child = build_trace_scene({thing(Geometry{MeshGeometry{mesh.get()}, {}, kNoId}, 5)});
  const Scene scene =
      build_trace_scene({thing(shown(child), 1), thing(Geometry{CsgGeometry{box}, {}, kNoId}, 2)});
  const SceneHit near = closest_hit(*scene, along_x(0.1f, 0.2f));
  EXPECT_EQ(near.geometry, 2u);
  EXPECT_EQ(near.t, 8);
  EXPECT_EQ(normalize(near.normal), (Vec3f{-1, 0, 0}));
  const SceneHit behind = closest_hit(*scene, along_x(2.1f, 0.2f));
  EXPECT_EQ(behind.geometry, 5u);
  EXPECT_EQ(behind.normal,
            cross(mesh->positions[4] - mesh->positions[3], mesh->positions[5] - mesh->positions[3]));
}

TEST(TraceScenes, QuadsAreFacesOfTwoTriangles) {
  // A unit square: a, b, c, d.
  auto mesh = std::make_shared<TriangleMesh>();
  for (const Vec3f& p : {Vec3f{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}) mesh->positions.push_back(p);
  for (const std::uint32_t i : {0u, 1u, 3u, 2u, 3u, 1u}) mesh->indices.push_back(i);
  SceneGeometry fixed = thing(Geometry{MeshGeometry{mesh.get()}, {}, kNoId}, 1);
  SceneGeometry moving = thing(MovingMesh{mesh, {mesh->positions}}, 1);
  fixed.faces = moving.faces = std::make_shared<QuadFaces>();
  for (const SceneGeometry& g : {fixed, moving}) {
    const Scene scene = build_trace_scene({g});
    Roll dice(6);
    for (int i = 0; i < 100; ++i) {
      const float x = dice.range(0.01f, 0.99f), y = dice.range(0.01f, 0.99f);
      const SceneHit hit = closest_hit(*scene, {{x, y, 1}, 0, {0, 0, -1}, kInf}, {dice()});
      ASSERT_EQ(hit.primitive, 0u);
      ASSERT_NEAR(hit.u, x, 1e-5);
      ASSERT_NEAR(hit.v, y, 1e-5);
    }
  }
}

// ---- What is refused, and what is not there.

TEST(TraceScenes, WhatDoesNotFitIsRefused) {
  const Scene child = build_trace_scene({thing(ball_at({}))});
  const auto cube = std::make_shared<const TriangleMesh>(make_cube().mesh);
  const auto refused = [](std::vector<SceneGeometry> all) {
    try {
      build_trace_scene(std::move(all));
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const auto expect = [&](const SceneGeometry& g, const std::string& why) {
    const std::string what = refused({g});
    EXPECT_NE(what.find(why), std::string::npos) << what;
  };
  EXPECT_NE(refused({thing(ball_at({}), 3), thing(ball_at({}), 3)}).find("geometry 3"), std::string::npos);
  expect(thing(ball_at({}), kNoId), "number of its own");
  expect(thing(MovingMesh{cube, {}}), "at least two keys");
  expect(thing(MovingMesh{nullptr, {cube->positions}}), "at least two keys");
  MovingMesh odd{cube, {cube->positions}};
  odd.later_positions[0].push_back({});
  expect(thing(odd), "one key has 8 vertices, another 9");
  auto wrong = std::make_shared<TriangleMesh>(*cube);
  wrong->indices[5] = 8;
  expect(thing(MovingMesh{wrong, {cube->positions}}), "vertex 8, expected less than 8");
  expect(thing(std::shared_ptr<const UserShape>()), "expected a shape");
  expect(thing(shown(nullptr)), "expected a scene");
  expect(thing(shown(child, {})), "at least one transform");
  expect(thing(SceneInstances{{child}, {{Affine{}, 1}}, {}, {}}), "scene 1 of 1");
  expect(thing(SceneInstances{{nullptr}, {{Affine{}, 0}}, {}, {}}), "scene 0 of 1");
  expect(thing(Geometry{InstanceGeometry{build_accel({})}, {}, kNoId}), "is a SceneInstance");
  const Scene endless = build_trace_scene({thing(Geometry{PlaneShape{}, {}, kNoId})});
  EXPECT_EQ(refused({thing(shown(endless))}), "");
  expect(thing(shown(endless, {Affine{}, Affine{}})), "unbounded");
  const Scene deeper = build_trace_scene({thing(shown(endless))});
  expect(thing(shown(deeper, {Affine{}, Affine{}})), "unbounded");
  EXPECT_TRUE(any_hit(*deeper, {{0, 5, 0}, 0, {0, -1, 0}, kInf}));
}

TEST(TraceScenes, EmptyScenesAreMissed) {
  const Scene empty = build_trace_scene({});
  const TriangleMesh nothing;
  const Scene scenes[] = {empty,
                          build_trace_scene({thing(shown(empty))}),
                          build_trace_scene({thing(shown(empty, {Affine{}, Affine{}}))}),
                          build_trace_scene({thing(SceneInstances{})}),
                          build_trace_scene({thing(Geometry{MeshGeometry{&nothing}, {}, kNoId})}),
                          build_trace_scene({thing(MovingMesh{std::make_shared<TriangleMesh>(), {{}}})})};
  for (const Scene& scene : scenes) {
    EXPECT_FALSE(closest_hit(*scene, along_x()).valid());
    EXPECT_FALSE(any_hit(*scene, along_x()));
    EXPECT_TRUE(bounds(*scene).first.empty() && bounds(*scene).last.empty());
  }
}

TEST(TraceScenes, BatchesHaveTheHitsOfSingleRays) {
  Roll dice(7);
  const Scene scene = build_trace_scene(
      {thing(wobbling(make_icosphere(2).mesh, 3, 0.3f, dice), 1, 1), thing(ball_at({2, 0, 0}), 2, 2)});
  std::vector<Ray> rays;
  std::vector<RayContext> contexts;
  for (int i = 0; i < 10000; ++i) {
    const Vec3f from = dice.vec(4);
    rays.push_back({from, 0, dice.vec(1) - from, kInf});
    contexts.push_back({dice(), static_cast<std::uint32_t>(dice.below(4))});
  }
  std::vector<SceneHit> hits(rays.size());
  std::vector<std::uint8_t> occluded(rays.size());
  closest_hit(*scene, rays, contexts, hits), any_hit(*scene, rays, contexts, occluded);
  std::size_t count = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const SceneHit one = closest_hit(*scene, rays[i], contexts[i]);
    ASSERT_EQ(one.t, hits[i].t);
    ASSERT_EQ(one.geometry, hits[i].geometry);
    ASSERT_EQ(occluded[i] != 0, one.valid());
    count += one.valid();
  }
  EXPECT_GT(count, 2000u);
  // One context for all.
  closest_hit(*scene, rays, {contexts.data(), 1}, hits);
  EXPECT_EQ(hits[77].t, closest_hit(*scene, rays[77], contexts[0]).t);
  EXPECT_THROW(closest_hit(*scene, rays, {contexts.data(), 2}, hits), Error);
  EXPECT_THROW(any_hit(*scene, rays, contexts, {occluded.data(), 3}), Error);
  closest_hit(*scene, std::span<const Ray>(), {}, {}), any_hit(*scene, {}, {contexts.data(), 1}, {});
}

}  // namespace
}  // namespace oktett::trace_scene_test
