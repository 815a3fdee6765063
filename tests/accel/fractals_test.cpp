#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/random.h"
#include "kernels/shapes/menger.h"
#include "kernels/shapes/sphereflake.h"
#include "tests/accel/all_crossings.h"
#include "tests/support/convex_union.h"

namespace oktett {
namespace {

using test::ConvexUnion;
using test::LineSpan;
using test::Vec3l;
constexpr float kInf = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();

SphereflakeShape flake(std::uint32_t depth, double ratio = 1.0 / 3) { return {depth, ratio}; }
MengerShape sponge(std::uint32_t depth) { return {depth}; }

/// Children in the order of angles, each found by turning the parent's own axes.
void grow(ConvexUnion& all, const Vec3l& c, long double r, const Vec3l& x, const Vec3l& y,
          std::uint32_t depth, long double ratio) {
  all.balls.push_back({c, r});
  if (depth == 0) return;
  const Vec3l z = cross(x, y);
  const auto child = [&](long double longitude, long double high) {
    const long double pi = std::acos(-1.0L), a = longitude * pi / 180, across = std::sqrt(1 - high * high);
    const Vec3l level = x * std::cos(a) + z * std::sin(a), east = z * std::cos(a) - x * std::sin(a);
    const Vec3l out = level * across + y * high;
    grow(all, c + out * (r * (1 + ratio)), r * ratio, east, out, depth - 1, ratio);
  };
  for (int k = 0; k < 6; ++k) child(60 * k, 0);
  for (int k = 0; k < 3; ++k) child(30 + 120 * k, std::sqrt(2.0L / 3));
}

ConvexUnion explicit_balls(const SphereflakeShape& s) {
  ConvexUnion all;
  grow(all, {0, 0, 0}, 1, {1, 0, 0}, {0, 1, 0}, s.depth, s.ratio);
  return all;
}

/// All small cubes, by the ternary digits of their places.
ConvexUnion explicit_cubes(const MengerShape& s) {
  int side = 1;
  for (std::uint32_t k = 0; k < s.depth; ++k) side *= 3;
  ConvexUnion all;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j)
      for (int k = 0; k < side; ++k) {
        bool solid = true;
        for (int p = 1; p < side; p *= 3) solid &= (i / p % 3 == 1) + (j / p % 3 == 1) + (k / p % 3 == 1) < 2;
        if (!solid) continue;
        const Vec3l lo{i, j, k}, one{1, 1, 1};
        const long double size = 2.0L / side;
        all.boxes.push_back({lo * size - one, (lo + one) * size - one});
      }
  return all;
}

/// Numbers in [-1, 1] that depend on where they stand alone.
struct Numbers {
  std::uint64_t key, at = 0;
  double next() { return static_cast<double>(mix_bits(key * 0x10001 + ++at) >> 11) * 0x1p-52 - 1; }
  Vec3d vector() {
    const double x = next(), y = next();
    return {x, y, next()};
  }
};

/// Rays from outside, from inside, along axes, along diagonals and on planes of the grid.
std::vector<Ray> rays_about(int count, double size) {
  Numbers random{7};
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    Vec3d from = random.vector() * (3 * size), at = random.vector() * size;
    if (i % 5 == 1) from = random.vector() * (0.8 * size);
    Vec3d d = at - from;
    if (i % 7 == 2) d[i % 3] = 0;
    if (i % 7 == 3) d[i % 3] = d[(i + 1) % 3] = 0;
    if (i % 11 == 4) d = {1, i % 2 == 0 ? 1.0 : -1.0, 1}, from = at - d * 4.0;
    if (i % 13 == 5) from[i % 3] = 0;
    rays.push_back({Vec3f(from), 0, Vec3f(d), kInf});
  }
  return rays;
}

/// Every crossing at its place, in and out in turn, but for what is thinner than rounding.
void expect_agreement(const ExactForm& form, const ConvexUnion& truth, int count, double size) {
  const auto accel = build_accel({{ExactShape{form}, {}}});
  int met = 0, index = 0;
  for (const Ray& ray : rays_about(count, size)) {
    SCOPED_TRACE(index++);
    const std::vector<Hit> hits = all_crossings(*accel, ray);
    std::vector<LineSpan> spans;
    for (std::size_t i = 0; i < hits.size(); ++i) {
      EXPECT_EQ(hits[i].v, (hits.size() - i) % 2 == 1 ? 1 : -1) << "crossing " << i;
      if (hits[i].v > 0) spans.push_back({i > 0 ? hits[i - 1].t : -1e3L, hits[i].t});
    }
    const auto expected = sure_crossings(truth.spans(ray), 2e-5L), found = sure_crossings(spans, 2e-5L);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i)
      EXPECT_NEAR(found[i], expected[i], 2e-6) << "crossing " << i;
    met += !hits.empty();
  }
  EXPECT_GT(met, count / 3);
}

TEST(Sphereflake, AgreesWithAllItsBalls) {
  for (const std::uint32_t depth : {0, 1, 3})
    for (const double ratio : {1.0 / 3, 0.5, 0.2})
      expect_agreement(flake(depth, ratio), explicit_balls(flake(depth, ratio)), 150, 1.5);
}

TEST(Menger, AgreesWithAllItsCubes) {
  for (const std::uint32_t depth : {0, 1, 2, 3})
    expect_agreement(sponge(depth), explicit_cubes(sponge(depth)), depth == 3 ? 80 : 250, 1.1);
}

template <class S>
bool holds(const typename S::Data& data, const Vec3d& p) {
  typename S::Pool pool;
  S::add(pool, ExactShape{data}, {}, 0);
  return S::inside(pool, 0, p);
}

TEST(Fractals, InsideIsInsideOfAPart) {
  Numbers random{3};
  const ConvexUnion balls = explicit_balls(flake(3)), cubes = explicit_cubes(sponge(3));
  int in_balls = 0, in_cubes = 0;
  for (int i = 0; i < 500; ++i) {
    const Vec3d p = random.vector() * 1.6, q = random.vector() * 1.1;
    EXPECT_EQ(holds<Sphereflake>(flake(3), p), balls.holds(Vec3l(p))) << i;
    EXPECT_EQ(holds<Menger>(sponge(3), q), cubes.holds(Vec3l(q))) << i;
    in_balls += balls.holds(Vec3l(p)), in_cubes += cubes.holds(Vec3l(q));
  }
  EXPECT_GT(in_balls, 50);
  EXPECT_GT(in_cubes, 50);
}

/// Along a diagonal all three digits are the same, so that what is left is Cantor's dust; every plane is met
/// together with two others.
TEST(Menger, TheDiagonalIsCantorsDust) {
  std::vector<std::pair<double, double>> dust{{0, 1}};
  for (std::uint32_t depth = 1; depth <= 8; ++depth) {
    std::vector<std::pair<double, double>> finer;
    for (const auto& [in, out] : dust)
      finer.push_back({in, in + (out - in) / 3}), finer.push_back({out - (out - in) / 3, out});
    dust = finer;
    // Lengths of 2 along each axis.
    const std::vector<Hit> hits = all_crossings(sponge(depth), {{-2, -2, -2}, 0, {2, 2, 2}, kInf});
    ASSERT_EQ(hits.size(), 2 * dust.size()) << depth;
    for (std::size_t i = 0; i < dust.size(); ++i) {
      EXPECT_FLOAT_EQ(hits[2 * i].t, static_cast<float>(0.5 + dust[i].first));
      EXPECT_FLOAT_EQ(hits[2 * i + 1].t, static_cast<float>(0.5 + dust[i].second));
    }
  }
}

TEST(Menger, HolesAndEdgesAtAnyDepth) {
  for (std::uint32_t depth = 1; depth <= 14; ++depth) {
    SCOPED_TRACE(depth);
    for (int axis = 0; axis < 3; ++axis)
      for (const float way : {-1.0f, 1.0f}) {
        Vec3f from{0, 0, 0}, d{0, 0, 0};
        from[axis] = -5 * way, d[axis] = way;
        EXPECT_TRUE(all_crossings(sponge(depth), {from, 0, d, kInf}).empty());
        // The edges of the cube are whole.
        from[(axis + 1) % 3] = from[(axis + 2) % 3] = -1 + 0x1p-24f;
        const std::vector<Hit> edge = all_crossings(sponge(depth), {from, 0, d, kInf});
        ASSERT_EQ(edge.size(), 2u);
        EXPECT_EQ(edge[0].t, 4);
        EXPECT_EQ(edge[1].t, 6);
      }
  }
}

TEST(Sphereflake, KnownCrossings) {
  // The root, a child on the x axis, its child beyond it, and so on up to the limit 2 - 3^-depth.
  for (const std::uint32_t depth : {0u, 1u, 4u, 12u}) {
    const std::vector<Hit> hits = all_crossings(flake(depth), {{5, 0, 0}, 0, {-1, 0, 0}, kInf});
    ASSERT_FALSE(hits.empty());
    // Children sit around the equator of their parent, not at its pole.
    EXPECT_FLOAT_EQ(hits[0].t, depth == 0 ? 4.0f : 5 - 5.0f / 3) << depth;
    EXPECT_FLOAT_EQ(hits.back().t, depth == 0 ? 6.0f : 5 + 5.0f / 3) << depth;
  }
  const std::vector<Hit> below = all_crossings(flake(12), {{0.25f, -3, 0.1f}, 0, {0, 1, 0}, kInf});
  ASSERT_FALSE(below.empty());
  EXPECT_FLOAT_EQ(below[0].t, static_cast<float>(3 - std::sqrt(1 - 0.25 * 0.25 - 0.1f * 0.1f)));
}

std::vector<ExactForm> all_forms() {
  return {flake(0), flake(3, 0.5), flake(5), flake(12), flake(24), sponge(0), sponge(3), sponge(7)};
}

TEST(Fractals, BadRaysHitNothing) {
  for (const ExactForm& form : all_forms()) {
    const auto accel = build_accel({{ExactShape{form}, {}}});
    const auto misses = [&](const Vec3f& o, const Vec3f& d) {
      return all_crossings(*accel, {o, 0, d, kInf}).empty();
    };
    for (int k = 0; k < 3; ++k) {
      for (const float bad : {kNan, kInf, -kInf}) {
        Vec3f v{0.1f, 0.2f, 0.3f};
        v[k] = bad;
        EXPECT_TRUE(misses(v, {1, 1, 1})) << bad;
      }
      Vec3f d{0.1f, 0.2f, 0.3f};
      d[k] = kNan;
      EXPECT_TRUE(misses({0, 0, 0}, d));
    }
    EXPECT_TRUE(misses({0.5f, 0, 0}, {0, 0, 0}));
    EXPECT_TRUE(misses({9, 9, 9}, {1, 0, 0}));
  }
}

/// Powers of two leave every bit: of the size and of the length of the direction.
TEST(Fractals, TinyAndHuge) {
  for (const ExactForm& form : all_forms()) {
    const auto unit = build_accel({{ExactShape{form}, {}}});
    int met = 0;
    for (const int exponent : {-50, 50}) {
      const double scale = std::ldexp(1.0, exponent);
      const float f = static_cast<float>(scale);
      const auto scaled = build_accel({{ExactShape{form}, Affine::scaling({scale, scale, scale})}});
      for (const Ray& ray : rays_about(40, 1)) {
        const std::vector<Hit> expected = all_crossings(*unit, ray);
        EXPECT_EQ(all_crossings(*scaled, {ray.origin * f, 0, ray.direction * f, kInf}), expected);
        std::vector<Hit> longer = all_crossings(*unit, {ray.origin, 0, ray.direction * f, kInf});
        for (Hit& h : longer) h.t *= f;
        EXPECT_EQ(longer, expected);
        met += !expected.empty();
      }
    }
    EXPECT_GT(met, 20);
  }
}

/// A ray that comes from far away hits where one does that starts near; t is as good as a float can tell.
TEST(Fractals, RaysFromFarAway) {
  for (const ExactForm& form : all_forms()) {
    const auto accel = build_accel({{ExactShape{form}, {}}});
    for (int i = 0; i < 20; ++i) {
      const float y = 0.03f * static_cast<float>(i) - 0.3f;
      const auto near = all_crossings(*accel, {{0.015625f, y, -4}, 0, {0, 0, 1}, kInf});
      const auto far = all_crossings(*accel, {{0.015625f, y, -0x1p20f}, 0, {0, 0, 1}, kInf});
      ASSERT_EQ(near.empty(), far.empty());
      if (near.empty()) continue;
      EXPECT_NEAR(far[0].t - 0x1p20, near[0].t - 4, 0.125);
      const Surface s = surface(*accel, {{0.015625f, y, -0x1p20f}, 0, {0, 0, 1}, kInf}, far[0]);
      EXPECT_NEAR(s.position.z, near[0].t - 4, 1e-6);
    }
  }
}

/// Positions lie on a part, no farther than their bounds say; normals are those of that part.
TEST(Fractals, SurfacesLieOnParts) {
  for (const bool balls : {true, false}) {
    const ConvexUnion truth = balls ? explicit_balls(flake(3)) : explicit_cubes(sponge(3));
    const ExactForm form = balls ? ExactForm(flake(3)) : ExactForm(sponge(3));
    const auto accel = build_accel({{ExactShape{form}, {}}});
    int hits = 0;
    for (const Ray& ray : rays_about(200, 1.2)) {
      for (const Hit& h : all_crossings(*accel, ray)) {
        const Surface s = surface(*accel, ray, h);
        const Vec3l p(s.position), n(s.geometric_normal);
        EXPECT_GE(dot(s.geometric_normal, ray.direction) * h.v, 0);
        EXPECT_NEAR(length(s.geometric_normal), 1, 1e-6);
        EXPECT_TRUE(s.uv.x >= 0 && s.uv.x <= 1 && s.uv.y >= 0 && s.uv.y <= 1);
        long double off = 1, turn = 1;
        for (const auto& b : truth.balls) {
          const Vec3l m = p - b.center;
          const long double l = std::sqrt(dot(m, m));
          if (std::abs(l - b.radius) < off) off = std::abs(l - b.radius), turn = 1 - dot(m, n) / l;
        }
        for (const auto& b : truth.boxes)
          for (int k = 0; k < 3; ++k) {
            bool beside = true;
            for (int j = 0; j < 3; ++j) beside &= b.lo[j] - 1e-6L <= p[j] && p[j] <= b.hi[j] + 1e-6L;
            if (!beside) continue;
            for (const int side : {-1, 1}) {
              const long double away = std::abs((side < 0 ? b.lo : b.hi)[k] - p[k]);
              if (n[k] == side && away < off) off = away, turn = 0;
            }
          }
        EXPECT_LE(off, length(s.position_error));
        EXPECT_LE(turn, 1e-9L);
        ++hits;
      }
    }
    EXPECT_GT(hits, 300);
  }
}

/// Nothing is stored per part.
TEST(Fractals, MemoryDoesNotGrowWithDepth) {
  const auto bytes = [](const ExactForm& form) {
    return stats(*build_accel({{ExactShape{form}, {}}})).bytes();
  };
  const std::size_t one_ball = bytes(flake(0)), cube = bytes(sponge(0));
  EXPECT_LT(one_ball, 2048u);
  EXPECT_LT(cube, 2048u);
  for (const std::uint32_t depth : {1u, 6u, 12u, 24u}) EXPECT_EQ(bytes(flake(depth)), one_ball);
  for (const std::uint32_t depth : {1u, 5u, 10u, 16u}) EXPECT_EQ(bytes(sponge(depth)), cube);
  EXPECT_GT(Sphereflake::count(flake(12)), 3e11);
}

TEST(Fractals, BoundsAreTight) {
  for (const Affine& place : {Affine{}, Affine::rotation({20, 30, 40}) * Affine::scaling({1, 2, 0.5})}) {
    Box truth;
    for (const auto& b : explicit_balls(flake(4)).balls)
      for (int k = 0; k < 3; ++k) {
        const Vec3d row{place.m[k][0], place.m[k][1], place.m[k][2]};
        const double middle = dot(row, Vec3d(b.center)) + place.m[k][3];
        const double reach = length(row) * static_cast<double>(b.radius);
        truth.lo[k] = std::min(truth.lo[k], static_cast<float>(middle - reach));
        truth.hi[k] = std::max(truth.hi[k], static_cast<float>(middle + reach));
      }
    const Box found = bounds(*build_accel({{ExactShape{flake(4)}, place}}));
    for (int k = 0; k < 3; ++k) {
      EXPECT_LE(found.lo[k], truth.lo[k]);
      EXPECT_GE(found.hi[k], truth.hi[k]);
      EXPECT_GT(found.lo[k], truth.lo[k] - 0.002f);
      EXPECT_LT(found.hi[k], truth.hi[k] + 0.002f);
    }
  }
  EXPECT_LE(bounds(*build_accel({{ExactShape{sponge(5)}, {}}})).hi.x, 1.000001f);
}

TEST(Fractals, SenselessOnesHaveNoSurface) {
  for (const ExactForm& form : {ExactForm(flake(25)), ExactForm(flake(2, 0)), ExactForm(flake(2, 0.51)),
                                ExactForm(flake(2, kNan)), ExactForm(sponge(17))})
    EXPECT_TRUE(all_crossings(form, {{-3, 0.1f, 0.7f}, 0, {1, 0, 0}, kInf}).empty());
}

}  // namespace
}  // namespace oktett
