#include "render/light/light_tree.h"

#include <gtest/gtest.h>
#include <numbers>

#include <cmath>
#include <vector>

#include "core/isa.h"
#include "render/light/emitter.h"
#include "render/light/light_tree_lanes.h"
#include "render/transport/render_code.h"
#include "tests/render/light_checks.h"

namespace oktett::light_tree_test {
namespace {

using namespace light_checks;

/// Emitters of all kinds that have a place, in a cube of edge `size`.
std::vector<Emitter> mixed_emitters(std::size_t count, double size, std::uint64_t key) {
  Random random(key);
  std::vector<Emitter> all;
  while (all.size() < count) {
    const Vec3f p = Vec3f(Vec3d{random(), random(), random()} * size);
    const float r = static_cast<float>(size * 0.1 * std::pow(random(), 4) + 1e-4);
    const float power = static_cast<float>(std::exp(random.between(-6, 6)));
    const Color color = Color{1, 0.5f, 0.2f} * power;
    const bool both = random() < 0.5;
    switch (all.size() % 5) {
      case 0:
        all.emplace_back(
            TriangleEmitter{p, p + random.direction() * r, p + random.direction() * r, color, both});
        break;
      case 1:
        all.emplace_back(DiskEmitter{p, random.direction(), r, color, both});
        break;
      case 2:
        all.emplace_back(SphereEmitter{p, r, color, both});
        break;
      case 3:
        all.emplace_back(PointEmitter{p, color});
        break;
      default: {
        const auto outer = static_cast<float>(random.between(-0.99, 0.99));
        const auto inner = static_cast<float>(random.between(outer, 1));
        all.emplace_back(SpotEmitter{p, random.direction(), color, inner, outer});
      }
    }
    // Far from the origin, rounding leaves no area of small triangles.
    if (!light_bounds(all.back())) all.pop_back();
  }
  return all;
}

std::vector<LightBounds> bounds_of(const std::vector<Emitter>& emitters) {
  std::vector<LightBounds> bounds;
  for (const Emitter& e : emitters) bounds.push_back(light_bounds(e).value());
  return bounds;
}

LightPoint random_point(Random& random, double size) {
  LightPoint point{
      Vec3f(Vec3d{random.between(-0.2, 1.2), random.between(-0.2, 1.2), random.between(-0.2, 1.2)} * size),
      random.direction(), random() < 0.5};
  if (random() < 0.2) point.normal = {};
  return point;
}

/// Some point of the emitter lights `point`.
bool lights(const Emitter& emitter, const LightPoint& point, Random& random) {
  for (int i = 0; i < 30; ++i) {
    const auto s = sample_emitter(emitter, point, random.square());
    if (!s) continue;
    if (!point.front_only || dot(s->direction, point.normal) > 0) return true;
  }
  return false;
}

TEST(LightTree, ProbabilitiesOfAllEmittersSumToOne) {
  for (const std::size_t count : {1, 2, 3, 10, 300}) {
    const LightTree tree(bounds_of(mixed_emitters(count, 10, count)));
    Random random(count);
    for (int i = 0; i < 50; ++i) {
      const LightPoint point = random_point(random, 10);
      double sum = 0;
      for (std::uint32_t j = 0; j < count; ++j) sum += tree.probability(point, j);
      ASSERT_NEAR(sum, 1, 1e-6);
    }
  }
}

TEST(LightTree, ChoosesAsOftenAsTheProbabilitySays) {
  constexpr std::size_t kCount = 60;
  constexpr int kChoices = 50000;
  const LightTree tree(bounds_of(mixed_emitters(kCount, 3, 7)));
  Random random(8);
  for (int i = 0; i < 10; ++i) {
    const LightPoint point = random_point(random, 3);
    std::vector<double> expected(kCount), counted(kCount);
    for (std::uint32_t j = 0; j < kCount; ++j) expected[j] = tree.probability(point, j) * kChoices;
    for (int j = 0; j < kChoices; ++j) {
      SquareSample s = random.square();
      const auto choice = tree.choose(point, s);
      ASSERT_TRUE(choice);
      ASSERT_EQ(choice->probability, tree.probability(point, choice->index));
      ++counted[choice->index];
    }
    EXPECT_LT(chi_squared(expected, counted), 4);
  }
}

/// Chooses for all points by the code of a set, and expects what choose() answers for each alone.
void expect_same_choices(const LightTree& tree, const std::vector<LightPoint>& points, Isa isa) {
  Random random(points.size());
  std::vector<SquareSample> samples(points.size());
  for (SquareSample& s : samples) s = random.square();
  std::vector<SquareSample> rest = samples;
  std::vector<LightTree::Choice> chosen(points.size());
  render_code(isa).lights.choose(tree, points, rest.data(), chosen.data());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto alone = tree.choose(points[i], samples[i]);
    ASSERT_TRUE(alone);
    ASSERT_EQ(chosen[i].index, alone->index) << to_string(isa) << ' ' << i;
    ASSERT_EQ(chosen[i].probability, alone->probability) << to_string(isa) << ' ' << i;
    ASSERT_EQ(rest[i].x, samples[i].x) << to_string(isa) << ' ' << i;
    ASSERT_EQ(rest[i].y, samples[i].y) << to_string(isa) << ' ' << i;
  }
}

TEST(LightTree, AllSetsChooseTheSame) {
  for (const std::size_t count : {1, 2, 3, 4, 5, 17, 500}) {
    const LightTree tree(bounds_of(mixed_emitters(count, 10, count)));
    Random random(count);
    // Fewer points than walks that run together, as many, and more.
    for (const std::size_t size : {1, 2, 3, 15, 16, 17, 64, 500}) {
      std::vector<LightPoint> points;
      while (points.size() < size) points.push_back(random_point(random, 10));
      for (const Isa isa : available_isas()) expect_same_choices(tree, points, isa);
    }
  }
}

// Nothing can be lit, sums overflow, and points lie in the middle of emitters.
TEST(LightTree, AllSetsChooseTheSameInBadCases) {
  std::vector<Emitter> back, strong;
  for (int i = 0; i < 40; ++i) {
    const Vec3f p{static_cast<float>(i % 7), static_cast<float>(i / 7), 0};
    back.emplace_back(DiskEmitter{p, {0, 0, 1}, 0.1f, {1, 1, 1}});
    strong.emplace_back(PointEmitter{p, Color{1, 1, 1} * 1e37f});
  }
  std::vector<LightPoint> points;
  for (int i = 0; i < 40; ++i) {
    const Vec3f at{static_cast<float>(i % 5), static_cast<float>(i / 5), 0};
    points.push_back({at - Vec3f{0, 0, i % 2 == 0 ? 3.0f : 0.0f}, {0, 0, -1}, true});
    points.push_back({at * 1e30f, {}, false});
    points.push_back({at * 1e-30f, {0, 1, 0}, i % 3 == 0});
  }
  for (const Isa isa : available_isas()) {
    expect_same_choices(LightTree(bounds_of(back)), points, isa);
    expect_same_choices(LightTree(bounds_of(strong)), points, isa);
  }
}

// Lamps in a plane, all as strong as each other at a far point: equal parts of the square choose them, in
// their places. So points spread evenly over the square are spread evenly over the lamps.
TEST(LightTree, MapsTheSquareToLampsInAPlane) {
  constexpr std::uint32_t kSide = 16;
  for (int flat = 0; flat < 3; ++flat) {
    const int across = (flat + 1) % 3, along = (flat + 2) % 3;
    std::vector<LightBounds> bounds;
    for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
      Vec3f p;
      p[across] = static_cast<float>(i % kSide), p[along] = static_cast<float>(i / kSide);
      bounds.push_back(*light_bounds(PointEmitter{p, {1, 1, 1}}));
    }
    const LightTree tree(bounds);
    LightPoint point;
    point.position[flat] = 1e5f;
    for (std::uint32_t i = 0; i < bounds.size(); ++i) {
      SquareSample s{(i % kSide + 0.25) / kSide, (i / kSide + 0.75) / kSide};
      const auto choice = tree.choose(point, s);
      ASSERT_EQ(choice->index, i) << flat;
      ASSERT_NEAR(s.x, 0.25, 0.01);
      ASSERT_NEAR(s.y, 0.75, 0.01);
    }
  }
}

// What a choice leaves of its numbers chooses the place on the emitter: each part of the square is as likely
// as any other, whichever emitter is chosen.
TEST(LightTree, LeavesNumbersThatAreUniform) {
  constexpr std::size_t kCount = 25, kParts = 4;
  constexpr int kChoices = 400000;
  const LightTree tree(bounds_of(mixed_emitters(kCount, 3, 5)));
  Random random(9);
  const LightPoint point = random_point(random, 3);
  std::vector<double> counted(kCount * kParts * kParts), expected;
  for (int i = 0; i < kChoices; ++i) {
    SquareSample s = random.square();
    const auto choice = tree.choose(point, s);
    ASSERT_TRUE(s.x >= 0 && s.x < 1 && s.y >= 0 && s.y < 1);
    const auto part =
        static_cast<std::size_t>(s.x * kParts) * kParts + static_cast<std::size_t>(s.y * kParts);
    ++counted[choice->index * kParts * kParts + part];
  }
  for (std::uint32_t j = 0; j < kCount; ++j)
    expected.insert(expected.end(), kParts * kParts,
                    tree.probability(point, j) * kChoices / (kParts * kParts));
  EXPECT_LT(chi_squared(expected, counted), 4);
}

// Points in and out of boxes, near and far, of either orientation; a point on the emitter, too.
TEST(LightTree, NeverLeavesOutAnEmitterThatLightsThePoint) {
  for (const double size : {1e-3, 1.0, 1e6}) {
    const std::vector<Emitter> emitters = mixed_emitters(400, size, 3);
    const std::vector<LightBounds> bounds = bounds_of(emitters);
    const LightTree tree(bounds);
    Random random(4);
    int lit = 0;
    for (int i = 0; i < 40; ++i) {
      LightPoint point = random_point(random, size);
      if (i % 4 == 0) point.position = bounds[static_cast<std::size_t>(i)].box.lo;
      if (i % 4 == 1) point.position = bounds[static_cast<std::size_t>(i)].box.center();
      for (std::uint32_t j = 0; j < emitters.size(); ++j)
        if (lights(emitters[j], point, random)) {
          ++lit;
          ASSERT_GT(tree.probability(point, j), 0) << j;
        }
    }
    EXPECT_GT(lit, 2000) << size;
  }
}

// Two emitters only, so that no other bounds hide a fault: at the border of what each can light.
TEST(LightTree, IsConservativeAtGrazingAngles) {
  Random random(5);
  int lit = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3f n = random.direction();
    Vec3f t, b;
    make_basis(n, t, b);
    const auto r = static_cast<float>(std::exp(random.between(-6, 3)));
    // The point is just above the plane of the disk, and the disk just above that of the point.
    const auto above = [&] { return static_cast<float>(std::exp(random.between(-14, -1))); };
    const DiskEmitter disk{random.direction() * 10.0f, n, r, {1, 1, 1}};
    LightPoint point{disk.center + t * static_cast<float>(1 + r * random()) + n * above(), {}, true};
    point.normal = normalize(-n + b * above());
    const Emitter far = SphereEmitter{{100, 100, 100}, 1, {1, 1, 1}};
    const LightTree tree(bounds_of({disk, far}));
    if (!lights(disk, point, random)) continue;
    ++lit;
    ASSERT_GT(tree.probability(point, 0), 0);
  }
  EXPECT_GT(lit, 500);
}

// cos(a + b) = cos(a) cos(b) - sin(a) sin(b). The bound takes 1 for sin(a), and cos(b)^2 or 1 for cos(b): it
// loses no more than this makes of each product, and a constant.
TEST(LightTree, FindsAnglesBeyondASum) {
  using F = Simd<float, 1, ScalarIsa>;
  const auto says_beyond = [](double cosine, double limit, double ball) {
    return any(
        is_beyond(F(static_cast<float>(cosine)), F(static_cast<float>(limit)), F(static_cast<float>(ball))));
  };
  Random random(6);
  int clear = 0;
  for (int i = 0; i < 300000; ++i) {
    const double a = random.between(0, std::numbers::pi);
    const double b = random.between(0, std::numbers::pi / 2) * std::pow(random(), i % 4);
    const double loss =
        std::sin(b) * (1 - std::sin(a)) + std::abs(std::cos(a)) * (1 - std::cos(b)) + double{kLeastCosine};
    const double sum = std::cos(a + b), surely = sum - loss;
    const double cosines[] = {std::cos(random.between(0, std::numbers::pi)),
                              sum + random.between(-1e-3, 1e-3), surely + random.between(-0.02, 1e-3)};
    for (const double wanted : cosines) {
      const double cosine = std::clamp(wanted, -1.0, 1.0);
      const bool beyond = says_beyond(cosine, std::cos(a), std::sin(b));
      ASSERT_TRUE(!beyond || std::acos(cosine) > a + b) << a << ' ' << b << ' ' << cosine;
      if (cosine > surely - 1e-6) continue;
      ++clear;
      ASSERT_TRUE(beyond) << a << ' ' << b << ' ' << cosine;
    }
  }
  EXPECT_GT(clear, 100000);
  EXPECT_FALSE(says_beyond(-1, 1, 1)) << "any angle may be added";
}

TEST(LightTree, LeavesOutWhatIsBehindAnOpaqueSurfaceOnly) {
  const LightTree tree(bounds_of({PointEmitter{{0, 0, 2}, {1, 1, 1}}, PointEmitter{{0, 0, -2}, {1, 1, 1}}}));
  EXPECT_EQ(tree.probability({{}, {0, 0, 1}, true}, 0), 1);
  EXPECT_EQ(tree.probability({{}, {0, 0, 1}, true}, 1), 0);
  EXPECT_NEAR(tree.probability({{}, {0, 0, 1}, false}, 1), 0.5, 0.01);
  EXPECT_NEAR(tree.probability({{}, {}, false}, 1), 0.5, 1e-6);
}

TEST(LightTree, HoldsNoEmitters) {
  const LightTree tree(std::vector<LightBounds>{});
  EXPECT_TRUE(tree.empty());
  SquareSample s{0.5, 0.5};
  EXPECT_FALSE(tree.choose({}, s));
  EXPECT_EQ(tree.importance({}), 0);
}

TEST(LightTree, HoldsManyEmittersAtOnePlace) {
  const std::vector<LightBounds> bounds(1000, *light_bounds(PointEmitter{{1, 2, 3}, {1, 1, 1}}));
  const LightTree tree(bounds);
  for (const Vec3f& p : {Vec3f{0, 0, 0}, Vec3f{1, 2, 3}}) {
    double sum = 0;
    for (std::uint32_t i = 0; i < 1000; ++i) sum += tree.probability({p, {}}, i);
    EXPECT_NEAR(sum, 1, 1e-6);
    EXPECT_NEAR(tree.probability({p, {}}, 17), 1e-3, 1e-4);
  }
}

// Positions and powers in geometric progression make splits that separate one emitter at a time.
TEST(LightTree, StaysShallowEnoughForItsTrails) {
  std::vector<LightBounds> bounds;
  for (int i = -120; i < 120; ++i)
    bounds.push_back(
        *light_bounds(PointEmitter{{std::ldexp(1.0f, i), 0, 0}, Color{1, 1, 1} * std::ldexp(1.0f, i)}));
  const LightTree tree(bounds);
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const LightPoint point{{static_cast<float>(std::exp(random.between(-80, 80))), 0, 1e-3f}, {}};
    SquareSample s = random.square();
    const auto choice = tree.choose(point, s);
    ASSERT_EQ(choice->probability, tree.probability(point, choice->index));
    double sum = 0;
    for (std::uint32_t j = 0; j < bounds.size(); ++j) sum += tree.probability(point, j);
    ASSERT_NEAR(sum, 1, 1e-5);
  }
}

std::vector<LightBounds> small_panels(std::size_t count) {
  Random random(2);
  std::vector<LightBounds> bounds(count);
  for (LightBounds& b : bounds) {
    const Vec3f p = Vec3f(Vec3d{random(), random(), random()} * 100.0);
    b = {.box = {p, p + Vec3f{0.01f, 0.01f, 0.01f}},
         .axis = random.direction(),
         .reach = static_cast<float>(std::numbers::pi / 2),
         .power = 1};
  }
  return bounds;
}

TEST(LightTree, HoldsAMillionEmitters) {
  constexpr std::size_t kCount = 1000000;
  const LightTree tree(small_panels(kCount));
  EXPECT_LE(tree.bytes(), kCount * 104);
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const LightPoint point = random_point(random, 100);
    SquareSample s = random.square();
    const auto choice = tree.choose(point, s);
    ASSERT_TRUE(choice);
    ASSERT_EQ(choice->probability, tree.probability(point, choice->index));
  }
}

// Large enough to be built by several threads.
TEST(LightTree, IsTheSameForEveryBuild) {
  const std::vector<LightBounds> bounds = small_panels(20000);
  const LightTree tree(bounds), again(bounds);
  Random random(4);
  for (int i = 0; i < 10000; ++i) {
    const LightPoint point = random_point(random, 100);
    SquareSample s = random.square(), t = s;
    const auto a = tree.choose(point, s), b = again.choose(point, t);
    ASSERT_EQ(a->index, b->index);
    ASSERT_EQ(a->probability, b->probability);
  }
}

// The tree prefers what brings more light: with many small lamps the noise is far below that of a choice by
// power.
TEST(LightTree, ChoosesNearAndFacingEmittersMoreOften) {
  std::vector<Emitter> lamps;
  for (int x = 0; x < 30; ++x)
    for (int y = 0; y < 30; ++y)
      lamps.emplace_back(
          DiskEmitter{{static_cast<float>(x), 3, static_cast<float>(y)}, {0, -1, 0}, 0.1f, {1, 1, 1}});
  const LightTree tree(bounds_of(lamps));
  Random random(3);
  for (int i = 0; i < 20; ++i) {
    const LightPoint point{
        {static_cast<float>(random.between(0, 29)), 0, static_cast<float>(random.between(0, 29))},
        {0, 1, 0},
        true};
    // The variance of value / probability: value is the irradiance of each lamp.
    double total = 0, by_tree = 0, by_power = 0;
    for (std::uint32_t j = 0; j < lamps.size(); ++j) {
      const Vec3d to = Vec3d(std::get<DiskEmitter>(lamps[j]).center) - Vec3d(point.position);
      const double value = to.y * to.y / (dot(to, to) * dot(to, to));
      total += value;
      by_tree += value * value / tree.probability(point, j);
      by_power += value * value * static_cast<double>(lamps.size());
    }
    EXPECT_LT((by_tree - total * total) * 50, by_power - total * total);
  }
}

}  // namespace
}  // namespace oktett::light_tree_test
