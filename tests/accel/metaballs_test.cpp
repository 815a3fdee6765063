#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "accel/accel.h"
#include "kernels/fields/blobtree.h"
#include "kernels/fields/metaballs.h"
#include "tests/accel/all_crossings.h"
#include "tests/support/limits.h"
#include "verify/cases/kernel_cases.h"

namespace oktett::metaballs_test {
namespace {

std::vector<Hit> crossings(const ExactForm& form, const Vec3f& from, const Vec3f& direction) {
  return all_crossings(form, {from, 0, direction, kInf});
}

void expect_at(const std::vector<Hit>& hits, const std::vector<double>& places, double within = 1e-6) {
  ASSERT_EQ(hits.size(), places.size());
  for (std::size_t i = 0; i < hits.size(); ++i) {
    EXPECT_NEAR(hits[i].t, places[i], within) << "crossing " << i;
    EXPECT_EQ(hits[i].v, i % 2 == 0 ? -1 : 1) << "crossing " << i;
  }
}

/// Where (1 - x^2)^2 is 1/2.
const double kHalf = std::sqrt(1 - std::sqrt(0.5));

MetaballsShape one_ball(double size = 1) { return {0.5, {{{0, 0, 0}, size, 1}}}; }

FieldElement element(const Skeleton& skeleton, const Potential& potential = {}) {
  return {skeleton, potential};
}

BlobTreeShape blend(Blend::Op op, const std::vector<FieldElement>& elements, double iso = 0.5) {
  BlobTreeShape s{iso, elements, {}};
  for (std::uint32_t i = 0; i < elements.size(); ++i) s.blends.push_back({Blend::Op::element, i, 0});
  s.blends.push_back({op, 0, static_cast<std::uint32_t>(elements.size())});
  return s;
}
BlobTreeShape alone(const Skeleton& skeleton, const Potential& potential = {}, double iso = 0.5) {
  return blend(Blend::Op::sum, {element(skeleton, potential)}, iso);
}

TEST(Metaballs, OneBallIsASphere) {
  expect_at(crossings(one_ball(), {-3, 0, 0}, {1, 0, 0}), {3 - kHalf, 3 + kHalf});
}

/// A wire of any length beside a ball: what rays meet far out on it is a cylinder.
TEST(BlobTrees, AWireIsACylinder) {
  for (const double end : {100.0, 65536.0, 1e9}) {
    Potential potential;
    potential.scale = 0.5;
    const BlobTreeShape wire =
        blend(Blend::Op::sum,
              {element(SegmentSkeleton{{0, 0, 0}, {end, 0, 0}}, potential), element(PointSkeleton{})});
    const double radius = 0.5 * kHalf;
    for (const double part : {0.1, 0.37, 0.9}) {
      const double x = part * end, slack = std::max(1e-6, 1e-15 * end);
      expect_at(crossings(wire, {static_cast<float>(x), 0, 8}, {0, 0, -1}), {8 - radius, 8 + radius}, slack);
      const double off = 0.6 * radius, half = 0.8 * radius;
      expect_at(crossings(wire, {static_cast<float>(x), static_cast<float>(off), -2}, {0, 0, 1}),
                {2 - half, 2 + half}, slack + 1e-6);
    }
  }
}

TEST(Metaballs, OneWayOutFromInside) {
  const auto hits = crossings(one_ball(), {0, 0, 0}, {0, 2, 0});
  ASSERT_EQ(hits.size(), 1u);
  EXPECT_NEAR(hits[0].t, kHalf / 2, 1e-6);
  EXPECT_EQ(hits[0].v, 1);
}

/// Balls at one place add up to one stronger ball in one piece of the ray; a negative one makes it weaker.
TEST(Metaballs, CoincidentBallsAddUp) {
  MetaballsShape s{0.5, {}};
  for (int i = 0; i < 30; ++i) s.balls.push_back({{1, 2, 3}, 1, i % 3 == 2 ? -0.05 : 0.1});
  const double q = std::sqrt(0.5 / (20 * 0.1 - 10 * 0.05)), r = std::sqrt(1 - q);
  expect_at(crossings(s, {-4, 2, 3}, {1, 0, 0}), {5 - r, 5 + r});
}

/// A ring: four crossings.
TEST(Metaballs, NegativeBallMakesAHole) {
  MetaballsShape s{0.5, {{{0, 0, 0}, 1, 1}, {{0, 0, 0}, 0.3, -4}}};
  // Where the hole begins, from its own equation, by halving.
  double lo = 0, hi = 0.3;
  for (int i = 0; i < 60; ++i) {
    const double x = (lo + hi) / 2, a = 1 - x * x, b = 1 - x * x / 0.09;
    (a * a - 4 * b * b < 0.5 ? lo : hi) = x;
  }
  expect_at(crossings(s, {0, 0, 3}, {0, 0, -1}), {3 - kHalf, 3 - lo, 3 + lo, 3 + kHalf});
}

/// A ray that narrowly misses the surface, one that narrowly meets it, and one along the border of a ball.
TEST(Metaballs, Tangents) {
  const float below = static_cast<float>(kHalf * (1 - 1e-6)), above = static_cast<float>(kHalf * (1 + 1e-6));
  EXPECT_EQ(crossings(one_ball(), {-3, below, 0}, {1, 0, 0}).size(), 2u);
  EXPECT_EQ(crossings(one_ball(), {-3, above, 0}, {1, 0, 0}).size(), 0u);
  EXPECT_EQ(crossings(one_ball(), {-3, 1, 0}, {1, 0, 0}).size(), 0u);
  // Two balls whose surfaces touch in a point: the ray through it leaves one solid as it enters the other.
  const MetaballsShape two{0.5, {{{-kHalf, 0, 0}, 0.6, 3}, {{kHalf, 0, 0}, 0.6, 3}}};
  EXPECT_EQ(crossings(two, {0, -3, 0}, {0, 1, 0}).size() % 2, 0u);
}

TEST(Metaballs, AnyScaleAndPlace) {
  for (const double size : {1e-15, 1e-3, 1.0, 1e3, 1e15}) {
    const auto f = static_cast<float>(size);
    expect_at(crossings(one_ball(size), {-3 * f, 0, 0}, {1, 0, 0}), {(3 - kHalf) * size, (3 + kHalf) * size},
              1e-6 * size);
    expect_at(all_crossings(one_ball(), Ray{{-3 * f, 0, 0}, 0, {1, 0, 0}, kInf},
                            Affine::scaling({size, size, size})),
              {(3 - kHalf) * size, (3 + kHalf) * size}, 1e-6 * size);
  }
  const Ray ray{{1e5f, 3, 0}, 0, {0, -1, 0}, kInf};
  expect_at(all_crossings(one_ball(), ray, Affine::translation({1e5, 0, 0})), {3 - kHalf, 3 + kHalf});
  expect_at(all_crossings(alone(PointSkeleton{}), ray, Affine::translation({1e5, 0, 0})),
            {3 - kHalf, 3 + kHalf});
}

TEST(Metaballs, NothingForNanAndDegenerate) {
  for (const ExactForm& form : {ExactForm{one_ball()}, ExactForm{alone(SegmentSkeleton{})}}) {
    EXPECT_EQ(crossings(form, {kNan, 0, 0}, {1, 0, 0}).size(), 0u);
    EXPECT_EQ(crossings(form, {-3, 0, 0}, {1, kNan, 0}).size(), 0u);
    EXPECT_EQ(crossings(form, {-3, 0, 0}, {0, 0, 0}).size(), 0u);
  }
  for (const ExactForm& form :
       {ExactForm{MetaballsShape{0.5, {}}}, ExactForm{MetaballsShape{0.5, {{{0, 0, 0}, 1, -1}}}},
        ExactForm{MetaballsShape{0.5, {{{0, 0, 0}, 0, 1}}}},
        ExactForm{MetaballsShape{2, {{{0, 0, 0}, 1, 1}}}}, ExactForm{BlobTreeShape{}},
        ExactForm{alone(PointSkeleton{}, {PotentialKind::wyvill, 1, 0, -1})}})
    EXPECT_EQ(crossings(form, {-3, 0, 0}, {1, 0, 0}).size(), 0u);
}

/// The number of balls that a ray through a box of N balls is tested with; the density is the same for all N.
double tests_per_ray(int count) {
  CaseRandom random(7);
  MetaballsShape shape{0.5, {}};
  const double radius = 1.2 / std::cbrt(count);
  for (int i = 0; i < count; ++i) shape.balls.push_back({random.vector(), radius, 0.9});
  MetaballsPool pool;
  Metaballs::add(pool, shape, {});
  using D = Simd<double, 1, ScalarIsa>;
  double tests = 0;
  constexpr int kRays = 300;
  for (int i = 0; i < kRays; ++i) {
    const Vec3d from = random.vector() * 3.0, to = random.vector(), o = pool.frames[0].to_own.point(from),
                d = pool.frames[0].to_own.vector(to - from);
    const Line<D> line{{D(o.x), D(o.y), D(o.z)}, {D(d.x), D(d.y), D(d.z)}};
    for (const ExactCell& cell : pool.cells) {
      LineRange<D> range;
      if (any(clip_line(line, cell.lo, cell.hi, range))) tests += cell.count;
    }
  }
  return tests / kRays;
}

/// Thanks to cells, a line is tested with far fewer balls than there are: the number grows as the cube root,
/// like the number of balls along the line.
TEST(Metaballs, FewBallsPerRay) {
  const double hundred = tests_per_ray(100), ten_thousand = tests_per_ray(10000);
  RecordProperty("hundred", std::to_string(hundred));
  RecordProperty("ten_thousand", std::to_string(ten_thousand));
  EXPECT_LT(ten_thousand, 10000 / 20);
  EXPECT_LT(ten_thousand, 8 * hundred);
}

/// The radius at which each potential is 1/2 with its scale 2, from the formulas.
TEST(BlobTrees, PotentialsOfAPoint) {
  const struct {
    Potential potential;
    double radius;
  } kCases[] = {{{PotentialKind::inverse_square, 2, 0, 1}, 2 * std::sqrt(2.0)},
                {{PotentialKind::gaussian, 2, 0, 1}, std::sqrt(std::log(2.0) / 2)},
                {{PotentialKind::quadratic, 2, 0, 1}, 2 * (1 - std::sqrt(1.0 / 3))},
                {{PotentialKind::quadratic, 2, 0, 0.6}, 2 * std::sqrt((1 - 0.5 / 0.6) / 3)},
                {{PotentialKind::rational, 2, 0, 1}, 2 * kHalf},
                // (1 - u)^2 = (1 + 3 u) / 2 has the root u = (7 - sqrt(41)) / 4.
                {{PotentialKind::rational, 2, 3, 1}, 2 * std::sqrt((7 - std::sqrt(41.0)) / 4)},
                {{PotentialKind::wyvill, 2, 0, 1}, 2 * kHalf}};
  for (const auto& c : kCases) {
    SCOPED_TRACE(static_cast<int>(c.potential.kind));
    expect_at(crossings(alone(PointSkeleton{{1, 2, 3}}, c.potential), {-9, 2, 3}, {1, 0, 0}),
              {10 - c.radius, 10 + c.radius}, 3e-6);
  }
}

TEST(BlobTrees, Skeletons) {
  // A capsule: across, along, and past its end.
  const BlobTreeShape capsule = alone(SegmentSkeleton{{0, -1, 0}, {0, 2, 0}});
  expect_at(crossings(capsule, {-3, 0.5f, 0}, {1, 0, 0}), {3 - kHalf, 3 + kHalf});
  expect_at(crossings(capsule, {0, -5, 0}, {0, 1, 0}), {4 - kHalf, 7 + kHalf});
  EXPECT_EQ(crossings(capsule, {-3, 2.6f, 0}, {1, 0, 0}).size(), 0u);
  expect_at(crossings(alone(SegmentSkeleton{{1, 1, 1}, {1, 1, 1}}), {-3, 1, 1}, {1, 0, 0}),
            {4 - kHalf, 4 + kHalf});
  // A plate in the shape of an L, through its middle, beside it in the corner, and in its plane.
  const BlobTreeShape plate =
      alone(PolygonSkeleton{{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}}},
            {PotentialKind::wyvill, 0.2, 0, 1});
  const double thick = 0.2 * kHalf;
  expect_at(crossings(plate, {0.5f, 0.5f, 3}, {0, 0, -1}), {3 - thick, 3 + thick});
  EXPECT_EQ(crossings(plate, {1.5f, 1.5f, 3}, {0, 0, -1}).size(), 0u);
  expect_at(crossings(plate, {-1, 0.5f, 0}, {1, 0, 0}), {1 - thick, 3 + thick});
  expect_at(crossings(plate, {-1, 1.5f, 0}, {1, 0, 0}), {1 - thick, 2 + thick});
  // Exactly through a corner and along an edge.
  expect_at(crossings(plate, {0, 0, 3}, {0, 0, -1}), {3 - thick, 3 + thick});
  expect_at(crossings(plate, {0, -1, 0}, {0, 1, 0}), {1 - thick, 3 + thick});
  // Ellipsoids, one turned by a quarter.
  const EllipsoidSkeleton egg{{0, 0, 0}, {1, 2, 3}, {0, 0, 90}};
  expect_at(crossings(alone(egg), {-9, 0, 0}, {1, 0, 0}), {9 - 2 * kHalf, 9 + 2 * kHalf}, 2e-6);
  expect_at(crossings(alone(egg), {0, -9, 0}, {0, 1, 0}), {9 - kHalf, 9 + kHalf}, 2e-6);
}

TEST(BlobTrees, Blends) {
  const auto a = element(PointSkeleton{{-0.3, 0, 0}}), b = element(PointSkeleton{{0.3, 0, 0}});
  const double l = 3 - 0.3 - kHalf, m = 3 + 0.3 - kHalf, n = 3 - 0.3 + kHalf, r = 3 + 0.3 + kHalf;
  const Vec3f from{-3, 0, 0}, along{1, 0, 0};
  expect_at(crossings(blend(Blend::Op::max, {a, b}), from, along), {l, r});
  expect_at(crossings(blend(Blend::Op::min, {a, b}), from, along), {m, n});
  expect_at(crossings(blend(Blend::Op::difference, {a, b}), from, along), {l, m});
  expect_at(crossings(blend(Blend::Op::difference, {b, a}), from, along), {n, r});
  // Neither reaches the far side of the other, but between them they add up.
  expect_at(crossings(blend(Blend::Op::sum, {a, b}), from, along), {l, r});
  const Vec3f below{0, -3, 0}, up{0, 1, 0};
  const auto sum = crossings(blend(Blend::Op::sum, {a, b}), below, up);
  const auto greater = crossings(blend(Blend::Op::max, {a, b}), below, up);
  ASSERT_EQ(sum.size(), 2u);
  ASSERT_EQ(greater.size(), 2u);
  EXPECT_LT(sum[0].t, greater[0].t - 0.05f);
  // What is taken away from itself leaves nothing.
  EXPECT_EQ(crossings(blend(Blend::Op::difference, {a, a}), from, along).size(), 0u);
}

/// A blob tree that sums points with the potential of metaballs gives the same hits as metaballs.
TEST(BlobTrees, SumsAgreeWithMetaballs) {
  CaseRandom random(3);
  MetaballsShape balls{0.4, {}};
  std::vector<FieldElement> elements;
  for (int i = 0; i < 8; ++i) {
    const MetaBall ball{random.vector(), 0.5 + random.unit(), random.unit() < 0.3 ? -0.7 : 1.0};
    balls.balls.push_back(ball);
    elements.push_back(
        element(PointSkeleton{ball.center}, {PotentialKind::wyvill, ball.radius, 0, ball.strength}));
  }
  const BlobTreeShape tree = blend(Blend::Op::sum, elements, 0.4);
  std::size_t met = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3d from = normalize(random.vector()) * 4.0, to = random.vector();
    const auto one = crossings(balls, Vec3f(from), Vec3f(to - from));
    const auto other = crossings(tree, Vec3f(from), Vec3f(to - from));
    ASSERT_EQ(one.size(), other.size());
    for (std::size_t k = 0; k < one.size(); ++k) EXPECT_NEAR(one[k].t, other[k].t, 1e-6);
    met += one.size();
  }
  EXPECT_GT(met, 100u);
}

MetaballsShape capsules(const std::vector<FieldElement>& elements, double iso = 0.5) {
  return {iso, {}, elements};
}

/// A capsule across, along, past its ends, and in the planes of its ends, where its parts meet.
TEST(Metaballs, ACapsuleHasRoundEnds) {
  for (const Vec3d& to : {Vec3d{0, 2, 0}, Vec3d{0, -4, 0}}) {
    const MetaballsShape s = capsules({element(SegmentSkeleton{{0, -1, 0}, to})});
    const double low = std::min(-1.0, to.y), high = std::max(-1.0, to.y);
    for (const double y : {low, low + 1e-9, 0.5 * (low + high), high})
      expect_at(crossings(s, {-3, static_cast<float>(y), 0}, {1, 0, 0}), {3 - kHalf, 3 + kHalf});
    const auto from = static_cast<float>(low - 4);
    expect_at(crossings(s, {0, from, 0}, {0, 1, 0}), {low - kHalf - from, high + kHalf - from});
    const double off = 0.6 * kHalf, cap = 0.8 * kHalf;
    expect_at(crossings(s, {static_cast<float>(off), from, 0}, {0, 1, 0}),
              {low - cap - from, high + cap - from});
    EXPECT_EQ(crossings(s, {-3, static_cast<float>(high + 1.01 * kHalf), 0}, {1, 0, 0}).size(), 0u);
    EXPECT_EQ(crossings(s, {static_cast<float>(1.01 * kHalf), from, 0}, {0, 1, 0}).size(), 0u);
  }
  expect_at(crossings(capsules({element(SegmentSkeleton{{1, 1, 1}, {1, 1, 1}})}), {-3, 1, 1}, {1, 0, 0}),
            {4 - kHalf, 4 + kHalf});
  const EllipsoidSkeleton egg{{0, 0, 0}, {1, 2, 3}, {0, 0, 90}};
  expect_at(crossings(capsules({element(egg)}), {-9, 0, 0}, {1, 0, 0}), {9 - 2 * kHalf, 9 + 2 * kHalf}, 2e-6);
}

/// More of them in one place than are kept for a ray.
TEST(Metaballs, CapsulesAddUp) {
  std::vector<FieldElement> elements;
  for (int i = 0; i < 30; ++i)
    elements.push_back(element(SegmentSkeleton{{0, -1, 0}, {0, 1, 0}},
                               {PotentialKind::wyvill, 1, 0, i % 3 == 2 ? -0.05 : 0.1}));
  MetaballsShape s = capsules(elements);
  s.balls.push_back({{0, 0, 0}, 0.1, 1e-9});
  const double q = std::sqrt(0.5 / (20 * 0.1 - 10 * 0.05)), r = std::sqrt(1 - q);
  expect_at(crossings(s, {-4, 0.5f, 0}, {1, 0, 0}), {4 - r, 4 + r});
}

/// The same sums by pieces and by intervals.
TEST(Metaballs, CapsulesAgreeWithBlobTrees) {
  CaseRandom random(5);
  std::size_t met = 0;
  for (int scene = 0; scene < 6; ++scene) {
    std::vector<FieldElement> elements;
    for (int i = 0; i < 6; ++i) {
      const Potential p{PotentialKind::wyvill, 0.3 + random.unit(), 0, random.unit() < 0.3 ? -0.7 : 1.0};
      if (random.unit() < 0.6)
        elements.push_back(element(SegmentSkeleton{random.vector(), random.vector()}, p));
      else
        elements.push_back(element(
            EllipsoidSkeleton{
                random.vector(), {0.2 + random.unit(), 0.2 + random.unit(), 1}, random.vector() * 180.0},
            p));
    }
    const MetaballsShape pieces = capsules(elements, 0.4);
    const BlobTreeShape tree = blend(Blend::Op::sum, elements, 0.4);
    for (int i = 0; i < 100; ++i) {
      const Vec3d from = normalize(random.vector()) * 4.0, to = random.vector();
      const auto one = crossings(pieces, Vec3f(from), Vec3f(to - from));
      const auto other = crossings(tree, Vec3f(from), Vec3f(to - from));
      ASSERT_EQ(one.size(), other.size()) << scene << " " << i;
      for (std::size_t k = 0; k < one.size(); ++k) EXPECT_NEAR(one[k].t, other[k].t, 1e-6);
      met += one.size();
    }
  }
  EXPECT_GT(met, 300u);
}

/// What only blob trees have is nothing here.
TEST(Metaballs, OtherPotentialsAndPolygonsAreNothing) {
  const Vec3f from{-3, 0, 0}, along{1, 0, 0};
  EXPECT_EQ(
      crossings(capsules({element(PointSkeleton{}, {PotentialKind::gaussian, 1, 0, 1})}), from, along).size(),
      0u);
  const PolygonSkeleton triangle{{{0, -1, -1}, {0, 1, -1}, {0, 0, 1}}};
  EXPECT_EQ(crossings(capsules({element(triangle)}), from, along).size(), 0u);
  EXPECT_EQ(
      crossings(capsules({element(EllipsoidSkeleton{{0, 0, 0}, {1, 0, 1}, {0, 0, 0}})}), from, along).size(),
      0u);
}

/// As deep as is allowed, and one level too deep.
TEST(BlobTrees, NestingIsBounded) {
  for (const int levels : {kMaxBlendLevels, kBlobStack + 1}) {
    BlobTreeShape s{0.5, {element(PointSkeleton{})}, {}};
    // max(p, max(p, ...)): every level keeps a value while the next is made.
    for (int i = 0; i <= levels; ++i) s.blends.push_back({Blend::Op::element, 0, 0});
    for (int i = 0; i < levels; ++i) s.blends.push_back({Blend::Op::max, 0, 2});
    EXPECT_EQ(crossings(s, {-3, 0, 0}, {1, 0, 0}).size(), levels == kMaxBlendLevels ? 2u : 0u);
  }
}

}  // namespace
}  // namespace oktett::metaballs_test
