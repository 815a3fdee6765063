#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "accel/accel_data.h"
#include "accel/trace_scene.h"
#include "core/error.h"
#include "tests/accel/instance_cases.h"
#include "tests/support/dice.h"
#include "tests/support/limits.h"
#include "verify/oracles/mesh.h"

namespace oktett::trace_judges_test {
namespace {

using Scene = std::shared_ptr<const TraceScene>;

template <class Shape>
SceneGeometry thing(Shape shape, std::uint32_t number = 0, std::uint32_t mask = ~0u) {
  SceneGeometry g;
  g.shape = std::move(shape), g.number = number, g.mask = mask;
  return g;
}

const TriangleMesh& cube() {
  static const OracleMesh mesh = make_cube();
  return mesh.mesh;
}

/// The cube, fixed and moving.
std::vector<SceneGeometry> cubes() {
  const std::shared_ptr<const TriangleMesh> shared(std::shared_ptr<void>(), &cube());
  return {thing(Geometry{MeshGeometry{&cube()}, {}, kNoId}), thing(MovingMesh{shared, {cube().positions}})};
}

/// Scenes that show `g` in each way.
std::vector<Scene> ways(const SceneGeometry& g) {
  const std::vector<Affine> moves{Affine{}, Affine{}};
  const Scene plain = build_trace_scene({g});
  const Scene shown = build_trace_scene({thing(SceneInstance{plain, {Affine{}}, {}}, 70)});
  return {plain, shown, build_trace_scene({thing(SceneInstance{plain, moves, {}}, 71)}),
          build_trace_scene({thing(SceneInstances{{plain}, {{Affine{}, 0}}, {}, {}}, 72)}),
          build_trace_scene({thing(SceneInstance{shown, moves, {}}, 73)})};
}

Ray along_x(float tmax = kInf) { return {{-9, 0.1f, 0.2f}, 0, {1, 0, 0}, tmax}; }

/// A filter that does what a function says, and notes the distances of what it is asked about.
class Told final : public HitFilter {
 public:
  explicit Told(std::function<bool(SceneHit&)> accepts) : accepts_(std::move(accepts)) {}
  mutable std::vector<float> asked;
  mutable Ray ray;

  std::size_t judge(const Ray& r, const RayContext&, std::span<SceneHit> hits) const override {
    ray = r;
    for (std::size_t k = 0; k < hits.size(); ++k) {
      asked.push_back(hits[k].t);
      if (accepts_(hits[k])) return k;
    }
    return hits.size();
  }
  /// What it was asked about since this was called last, sorted.
  std::vector<float> taken() const {
    std::vector<float> all;
    std::swap(all, asked);
    std::ranges::sort(all);
    return all;
  }

 private:
  std::function<bool(SceneHit&)> accepts_;
};

const std::vector<float> kBoth{8, 10}, kFirst{8};

TEST(TraceJudges, EachHitIsJudgedOnceUntilOneIsAccepted) {
  const Told none([](SceneHit&) { return false; }), far([](SceneHit&h) { return h.t > 9; });
  for (SceneGeometry g : cubes())
    for (const bool of_query : {false, true}) {
      for (const Told* filter : {&none, &far}) {
        g.closest_filter = g.any_filter = of_query ? nullptr : filter;
        for (const Scene& scene : ways(g)) {
          const RayContext context{0.5f, ~0u, of_query ? filter : nullptr};
          const SceneHit hit = closest_hit(*scene, along_x(), context);
          EXPECT_EQ(hit.t, filter == &far ? 10 : kInf);
          EXPECT_EQ(filter->taken(), kBoth);
          EXPECT_EQ(any_hit(*scene, along_x(), context), filter == &far);
          const std::vector<float> asked = filter->taken();
          EXPECT_TRUE(filter == &far || asked == kBoth);
          EXPECT_FALSE(closest_hit(*scene, along_x(9), context).valid());
          EXPECT_EQ(filter->taken(), kFirst);
          EXPECT_FALSE(any_hit(*scene, along_x(9), context));
          EXPECT_EQ(filter->taken(), kFirst);
        }
      }
    }
}

TEST(TraceJudges, TrianglesInSeveralLeavesAreJudgedOnce) {
  const TriangleMesh mesh = soup(300, 3, 0.2);
  const Geometry geometry{MeshGeometry{&mesh}, {}, kNoId};
  const BuildOptions best{.quality = BuildQuality::best};
  const std::shared_ptr<const Accel> tree = build_accel({geometry}, best);
  ASSERT_TRUE(tree->pieces);
  std::vector<std::uint32_t> asked;
  const Told none([&](SceneHit& h) { return asked.push_back(h.primitive), false; });
  SceneGeometry whole = thing(geometry), shown = thing(geometry);
  shown.tree = tree;
  Dice<float> dice(3);
  std::size_t most = 0;
  for (SceneGeometry g : {whole, shown}) {
    g.closest_filter = g.any_filter = &none;
    const Scene plain = build_trace_scene({g}, best);
    for (const Scene& scene : {plain, build_trace_scene({thing(SceneInstance{plain, {Affine{}}, {}}, 70)})})
      for (int i = 0; i < 300; ++i) {
        const Vec3f from = dice.vec(3);
        const Ray ray{from, 0, dice.vec(1) - from, kInf};
        std::vector<Hit> hits;
        all_hits(*tree, ray, hits);
        std::vector<std::uint32_t> expected;
        for (const Hit& hit : hits) expected.push_back(hit.item);
        std::ranges::sort(expected);
        for (const bool any : {false, true}) {
          asked.clear();
          EXPECT_FALSE(any ? any_hit(*scene, ray) : closest_hit(*scene, ray).valid());
          std::ranges::sort(asked);
          EXPECT_EQ(asked, expected);
          most = std::max(most, asked.size());
        }
      }
  }
  EXPECT_GT(most, 3u);
}

TEST(TraceJudges, FiltersOfOtherQueriesAreNotAsked) {
  const Told none([](SceneHit&) { return false; });
  for (SceneGeometry g : cubes()) {
    g.any_filter = &none;
    for (const Scene& scene : ways(g)) EXPECT_EQ(closest_hit(*scene, along_x()).t, 8);
    g.any_filter = nullptr, g.closest_filter = &none;
    for (const Scene& scene : ways(g)) EXPECT_TRUE(any_hit(*scene, along_x()));
  }
  EXPECT_TRUE(none.asked.empty());
}

TEST(TraceJudges, TheFilterOfTheQueryJudgesWhatThatOfTheGeometryLetsPass) {
  const Told far([](SceneHit&h) { return h.t > 9; }), none([](SceneHit&) { return false; });
  for (SceneGeometry g : cubes()) {
    g.closest_filter = g.any_filter = &far;
    for (const Scene& scene : ways(g)) {
      EXPECT_FALSE(closest_hit(*scene, along_x(), {0, ~0u, &none}).valid());
      EXPECT_EQ(far.taken(), kBoth);
      EXPECT_EQ(none.taken(), std::vector<float>{10});
      EXPECT_FALSE(any_hit(*scene, along_x(), {0, ~0u, &none}));
      EXPECT_EQ(far.taken(), kBoth);
      EXPECT_EQ(none.taken(), std::vector<float>{10});
    }
  }
}

TEST(TraceJudges, AFilterCanEndTheRay) {
  const Told ends([](SceneHit& h) {
    h.geometry = kNoId;
    return true;
  });
  for (SceneGeometry g : cubes()) {
    g.number = 5, g.closest_filter = g.any_filter = &ends;
    for (const Scene& scene : ways(g)) {
      const SceneHit hit = closest_hit(*scene, along_x());
      EXPECT_FALSE(hit.valid());
      EXPECT_EQ(hit.t, kInf);
      EXPECT_EQ(hit.chain.count, 0u);
      EXPECT_FALSE(any_hit(*scene, along_x()));
    }
    // What is nearer still counts; what is behind does not.
    for (const double x : {-4.0, 4.0}) {
      const SceneGeometry ball = thing(Geometry{SpheresShape{{{{x, 0, 0}, 1}}}, {}, kNoId}, 6);
      for (const std::vector<SceneGeometry>& all : {std::vector{g, ball}, {ball, g}}) {
        const SceneHit hit = closest_hit(*build_trace_scene(all), along_x());
        EXPECT_EQ(hit.geometry, x < 0 ? 6u : kNoId);
      }
    }
  }
}

TEST(TraceJudges, AFilterCanChangeAllButTheDistance) {
  const Told changes([](SceneHit& h) {
    h.u = 0.25f, h.v = 0.75f, h.normal = {1, 2, 3}, h.primitive = 1234, h.geometry = 77;
    return true;
  });
  for (SceneGeometry g : cubes())
    for (const Scene& scene : ways(g)) {
      const SceneHit hit = closest_hit(*scene, along_x(), {1, ~0u, &changes});
      EXPECT_EQ(hit.t, 8);
      EXPECT_EQ(hit.u, 0.25f);
      EXPECT_EQ(hit.v, 0.75f);
      EXPECT_EQ(hit.normal, (Vec3f{1, 2, 3}));
      EXPECT_EQ(hit.primitive, 1234u);
      EXPECT_EQ(hit.geometry, 77u);
    }
}

TEST(TraceJudges, FiltersSeeTheRayOfTheInnermostScene) {
  const Told all([](SceneHit&) { return true; });
  const Affine map = Affine::translation({2, 0, 0}) * Affine::scaling({2, 2, 2});
  for (SceneGeometry g : cubes()) {
    g.closest_filter = &all;
    const Scene child = build_trace_scene({g});
    for (const std::vector<Affine>& keys : {std::vector<Affine>{map}, {map, map}}) {
      const SceneHit hit =
          closest_hit(*build_trace_scene({thing(SceneInstance{child, keys, {}})}), along_x());
      EXPECT_EQ(hit.t, 9);
      EXPECT_EQ(all.ray.origin, (Vec3f{-5.5f, 0.05f, 0.1f}));
      EXPECT_EQ(all.ray.direction, (Vec3f{0.5f, 0, 0}));
    }
  }
}

TEST(TraceJudges, MasksHideGeometriesAndInstancesAtEveryLevel) {
  for (SceneGeometry g : cubes()) {
    g.mask = 6;
    for (Scene scene : ways(g)) {
      for (const std::uint32_t mask : {0u, 1u, 2u, 4u, 8u, 9u, 3u, ~0u}) {
        const bool seen = (mask & 6) != 0;
        EXPECT_EQ(closest_hit(*scene, along_x(), {0, mask}).valid(), seen);
        EXPECT_EQ(any_hit(*scene, along_x(), {0, mask}), seen);
        for (const std::vector<Affine>& keys : {std::vector<Affine>{Affine{}}, {Affine{}, Affine{}}}) {
          const Scene outer = build_trace_scene({thing(SceneInstance{scene, keys, {}}, 1, 3)});
          EXPECT_EQ(any_hit(*outer, along_x(), {0, mask}), seen && (mask & 3) != 0);
          EXPECT_EQ(closest_hit(*outer, along_x(), {0, mask}).valid(), seen && (mask & 3) != 0);
        }
      }
    }
    g.mask = 0;
    EXPECT_FALSE(any_hit(*build_trace_scene({g}), along_x()));
  }
}

// ---- Shapes of the program.

/// Spheres, as a program would write them, and what can be wrong about them.
class Balls final : public UserShape {
 public:
  std::vector<SphereShape> balls;
  Vec3d way;  ///< by which the last key is off
  std::uint32_t keys = 1;
  std::function<Box(Box)> bounded = [](Box b) { return b; };
  std::function<void(const Ray&, SceneHit&)> spoil = [](const Ray&, SceneHit&) {};

  std::uint32_t primitive_count() const override { return static_cast<std::uint32_t>(balls.size()); }
  std::uint32_t key_count() const override { return keys; }
  Box bounds(std::uint32_t primitive, std::uint32_t key) const override {
    SphereShape ball = balls[primitive];
    if (keys > 1) ball.center += way * (static_cast<double>(key) / (keys - 1));
    ball.radius *= 1 + 1e-6;
    return bounded(ball.bounds());
  }
  bool closest_hit(std::uint32_t primitive, const Ray& ray, const RayContext& context,
                   SceneHit& hit) const override {
    const SphereShape& ball = balls[primitive];
    const double time = keys > 1 ? static_cast<double>(context.time) : 0;
    const Vec3d o = Vec3d(ray.origin) - ball.center - way * time, d(ray.direction);
    const double a = dot(d, d), b = dot(o, d), q = b * b - a * (dot(o, o) - ball.radius * ball.radius);
    if (!(q > 0)) return false;
    for (const double sign : {-1, 1}) {
      const double t = (-b + sign * std::sqrt(q)) / a;
      if (!(static_cast<double>(ray.tmin) < t && t <= static_cast<double>(ray.tmax))) continue;
      hit.t = static_cast<float>(t), hit.normal = Vec3f(o + d * t);
      spoil(ray, hit);
      return true;
    }
    return false;
  }
};

TEST(TraceJudges, SpheresOfTheProgramAreThoseOfTheLibrary) {
  Dice<float> dice(1);
  for (const std::uint32_t keys : {1u, 2u, 4u}) {
    auto balls = std::make_shared<Balls>();
    balls->keys = keys, balls->way = {1, -0.5, 0.25};
    SpheresShape spheres;
    for (int i = 0; i < 30; ++i)
      balls->balls.push_back({Vec3d(dice.vec(2)), 0.1 + 0.4 * static_cast<double>(dice())});
    const std::shared_ptr<const UserShape> shape = balls;
    const std::vector<Scene> scenes = ways(thing(shape, 9));
    int hits = 0;
    for (int i = 0; i < 600; ++i) {
      const float time = dice();
      spheres.spheres = balls->balls;
      for (SphereShape& s : spheres.spheres)
        if (keys > 1) s.center += balls->way * static_cast<double>(time);
      const auto accel = build_accel({{spheres, {}, kNoId}});
      const Vec3f from = i % 3 == 0 ? dice.vec(1) : dice.vec(5);
      const Ray ray{from, 0, dice.vec(2) - from, i % 2 == 0 ? 1.0f : kInf};
      const Hit expected = closest_hit(*accel, ray);
      hits += expected.valid();
      const Scene& scene = scenes[static_cast<std::size_t>(i) % scenes.size()];
      for (const Isa isa : available_isas()) {
        const SceneHit hit = closest_hit(*scene, ray, {time}, isa);
        ASSERT_EQ(hit.valid(), expected.valid()) << i;
        ASSERT_EQ(any_hit(*scene, ray, {time}, isa), expected.valid()) << i;
        if (!hit.valid()) continue;
        ASSERT_NEAR(hit.t, expected.t, 1e-5 * expected.t);
        ASSERT_EQ(hit.primitive, expected.item);
        ASSERT_EQ(hit.geometry, 9u);
      }
    }
    EXPECT_GT(hits, 150);
  }
}

TEST(TraceJudges, HitsOutsideOfTheRangeDoNotCount) {
  const SceneGeometry behind = thing(Geometry{SpheresShape{{{{3, 0, 0}, 1}}}, {}, kNoId}, 2);
  for (const float t : {kNan, kInf, -kInf, 0.5f, -1.0f, 100.0f}) {
    auto balls = std::make_shared<Balls>();
    balls->balls = {{{0, 0, 0}, 1}};
    balls->spoil = [t](const Ray&, SceneHit& hit) { hit.t = t; };
    const std::shared_ptr<const UserShape> shape = balls;
    for (const Scene& scene : ways(thing(shape, 1))) {
      Ray ray = along_x(50);
      ray.tmin = 1;
      EXPECT_FALSE(closest_hit(*scene, ray).valid()) << t;
      EXPECT_FALSE(any_hit(*scene, ray)) << t;
    }
    Ray ray = along_x(50);
    ray.tmin = 1;
    EXPECT_EQ(closest_hit(*build_trace_scene({thing(shape, 1), behind}), ray).geometry, 2u);
  }
}

TEST(TraceJudges, ShapesAreAskedWithRaysThatEndAtTheNearestHit) {
  auto balls = std::make_shared<Balls>();
  balls->balls = {{{3, 0, 0}, 1}};
  const std::shared_ptr<const UserShape> shape = balls;
  float end = 0;
  balls->spoil = [&](const Ray& ray, SceneHit&) { end = ray.tmax; };
  EXPECT_EQ(closest_hit(*build_trace_scene({thing(shape, 1)}), along_x(40)).geometry, 1u);
  EXPECT_EQ(end, 40);
  const SceneGeometry before =
      thing(Geometry{MeshGeometry{&cube()}, Affine::translation({6, 0, 0}), kNoId}, 2);
  EXPECT_EQ(closest_hit(*build_trace_scene({thing(shape, 1), before}), along_x()).geometry, 1u);
  EXPECT_EQ(end, 14);
}

TEST(TraceJudges, ShapesAtEqualDistanceCountInTheirOrder) {
  auto balls = std::make_shared<Balls>();
  balls->balls.resize(20, {{0, 0, 0}, 1});
  const std::shared_ptr<const UserShape> shape = balls;
  for (const Scene& scene : ways(thing(shape, 1))) EXPECT_EQ(closest_hit(*scene, along_x()).primitive, 0u);
  const SceneHit hit = closest_hit(*build_trace_scene({thing(shape, 8), thing(shape, 3)}), along_x());
  EXPECT_EQ(hit.geometry, 8u);
  EXPECT_EQ(hit.primitive, 0u);
}

TEST(TraceJudges, PrimitivesWithoutBoundsAreLeftOut) {
  const Box wrong[] = {
      Box{}, {{kNan, -1, -1}, {1, 1, 1}}, {{-1, -1, -1}, {1, kInf, 1}}, {{1, 1, 1}, {-1, -1, -1}}};
  for (const Box& box : wrong)
    for (const std::uint32_t keys : {1u, 3u}) {
      auto balls = std::make_shared<Balls>();
      balls->balls = {{{0, 0, 0}, 1}, {{4, 0, 0}, 1}};
      balls->keys = keys;
      balls->bounded = [&box](Box b) { return b.lo.x < 2 ? box : b; };
      const std::shared_ptr<const UserShape> shape = balls;
      for (const Scene& scene : ways(thing(shape, 1))) {
        const SceneHit hit = closest_hit(*scene, along_x(), {0.5f});
        EXPECT_EQ(hit.primitive, 1u);
      }
    }
}

/// So many primitives that they cannot be numbered.
class TooMany final : public UserShape {
 public:
  std::uint32_t primitive_count() const override { return ~0u; }
  Box bounds(std::uint32_t, std::uint32_t) const override { return {}; }
  bool closest_hit(std::uint32_t, const Ray&, const RayContext&, SceneHit&) const override { return false; }
};

TEST(TraceJudges, TooManyPrimitivesAreRefused) {
  const std::shared_ptr<const UserShape> shape = std::make_shared<TooMany>();
  EXPECT_THROW(build_trace_scene({thing(shape)}), Error);
}

}  // namespace
}  // namespace oktett::trace_judges_test
