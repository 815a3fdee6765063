#include <gtest/gtest.h>

#include <cmath>

#include "kernels/exact/march.h"
#include "tests/accel/all_crossings.h"
#include "tests/accel/fractal_cases.h"

namespace oktett::fractals_test {
namespace {

template <class S>
bool holds(const typename S::Data& data, const Vec3d& p) {
  typename S::Pool pool;
  S::add(pool, data, {});
  return is_inside<S>(pool, 0, p);
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

// 64^32 parts that all but coincide: a ray is given up after a while, finds nothing, and is counted.
TEST(Fractals, RaysThatWouldNeverEndAreGivenUp) {
  IfsShape s;
  for (int i = 0; i < 64; ++i) s.maps.push_back(shrink(0.999, {0.001 * i, 0.0005 * i, 0}));
  s.depth = 32;
  const std::uint64_t before = interval::uncertified_count();
  const auto accel = build_accel({{ExactShape{s}, {}, kNoId}});
  std::vector<Hit> hits;
  for (const float x : {0.0f, 0.2f, 0.5f})
    all_hits(*accel, {{x, 0, 9}, 0, {0, 0, -1}, kInf}, hits, default_isa());
  Ifs::Pool pool;
  Ifs::add(pool, s, {});
  Ifs::inside(pool, 0, {0.1, 3, 0.1});
  EXPECT_GE(interval::uncertified_count(), before + 3);
}

/// Rays through a combination of a fractal and a ball, compared with samples of both along the ray.
template <class S>
void expect_operand(const typename S::Data& data) {
  const Vec3d center{0.4, 0.3, 0.2};
  const double radius = 0.8;
  typename S::Pool pool;
  S::add(pool, data, {});
  for (const CsgOp op : {CsgOp::unite, CsgOp::intersect, CsgOp::subtract}) {
    auto e = std::make_shared<CsgExpression>();
    e->op = op;
    e->children.push_back({CsgOp::operand, {{ExactShape{data}, {}, 0}}, {}});
    e->children.push_back({CsgOp::operand, {{SpheresShape{{{center, radius}}}, {}, 1}}, {}});
    const auto accel = build_accel({{CsgGeometry{e}, {}, kNoId}});
    int samples = 0;
    for (const Ray& ray : rays_about(60, 1)) {
      const auto inside = [&](double t) {
        const Vec3d p = Vec3d(ray.origin) + Vec3d(ray.direction) * t;
        const bool f = is_inside<S>(pool, 0, p), b = length(p - center) < radius;
        return op == CsgOp::unite ? f || b : op == CsgOp::intersect ? f && b : f && !b;
      };
      std::vector<Hit> hits;
      all_hits(*accel, ray, hits, default_isa());
      constexpr double kSlack = 1e-5;
      if (inside(0) != inside(kSlack)) continue;
      bool now = inside(0);
      std::size_t next = 0;
      for (double t = 0.001; t < 3; t += 0.00371) {
        for (; next < hits.size() && hits[next].t < t; ++next) now = !now;
        const bool truth = inside(t);
        if (truth != inside(t - kSlack) || truth != inside(t + kSlack)) continue;
        ASSERT_EQ(now, truth) << "at " << t << " of ray from " << ray.origin.x << " " << ray.origin.y;
        samples += truth;
      }
    }
    EXPECT_GT(samples, 100);
  }
}

TEST(Fractals, AreOperandsOfCombinations) {
  expect_operand<Sphereflake>(flake(3, 0.4));
  expect_operand<Menger>(sponge(3));
  expect_operand<Ifs>(tetrahedron(4));
  expect_operand<Ifs>(plant(5));
  expect_operand<Julia>(julia(5));
  expect_operand<Terrain>(terrain(6));
}

std::vector<ExactForm> all_forms() {
  return {flake(0),  flake(3, 0.5),  flake(5), flake(12), flake(24),  sponge(0),  sponge(3),
          sponge(7), tetrahedron(4), plant(6), plant(32), terrain(3), terrain(9), terrain(20, 0.7)};
}

/// The first hit of a ray does not depend on where the ray ends, also where it begins inside.
TEST(Fractals, EndsOfRaysHideNothing) {
  Numbers random{11};
  for (const ExactForm& form :
       {ExactForm{flake(3)}, ExactForm{flake(2, 0.4)}, ExactForm{sponge(3)}, ExactForm{tetrahedron(4)}}) {
    const auto accel = build_accel({{ExactShape{form}, {}, kNoId}});
    int inside = 0;
    std::vector<Hit> hits;
    for (int i = 0; i < 2000; ++i) {
      Ray ray{Vec3f(random.vector() * 0.95), 0, Vec3f(random.vector()), kInf};
      hits.clear();
      all_hits(*accel, ray, hits, Isa::scalar);
      if (hits.empty()) continue;
      inside += hits.size() % 2;
      for (std::size_t k = 0; k < hits.size(); ++k) {
        ray.tmax = k + 1 < hits.size() ? (hits[k].t + hits[k + 1].t) / 2 : 2 * hits[k].t;
        if (!(hits[k].t <= ray.tmax)) continue;
        const Hit first = closest_hit(*accel, ray, Isa::scalar);
        ASSERT_EQ(first.t, hits[0].t) << form.index() << " ray " << i << " up to " << ray.tmax;
      }
    }
    EXPECT_GT(inside, 50) << form.index();
  }
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

/// Scaling the fractal or the direction by a power of two changes no bit.
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

/// A ray from far away hits the same point as one that starts near, up to the rounding of t to float.
TEST(Fractals, RaysFromFarAway) {
  for (const ExactForm& form : all_forms()) {
    const auto accel = build_accel({{ExactShape{form}, {}}});
    int met = 0;
    for (int i = 0; i < 20; ++i) {
      const float y = 0.09f * static_cast<float>(i) - 0.85f;  // beyond the hole of the sponge, too
      const auto near = all_crossings(*accel, {{0.015625f, y, -4}, 0, {0, 0, 1}, kInf});
      const auto far = all_crossings(*accel, {{0.015625f, y, -0x1p20f}, 0, {0, 0, 1}, kInf});
      ASSERT_EQ(near.empty(), far.empty());
      if (near.empty()) continue;
      ++met;
      EXPECT_NEAR(far[0].t - 0x1p20, near[0].t - 4, 0.125);
      const SurfaceInteraction s =
          surface_interaction(*accel, {{0.015625f, y, -0x1p20f}, 0, {0, 0, 1}, kInf}, far[0]);
      EXPECT_NEAR(s.position.z, near[0].t - 4, 1e-6);
    }
    EXPECT_GT(met, 0);
  }
}

/// Positions lie on a part of the fractal within their error bounds; normals are those of that part.
TEST(Fractals, SurfacesLieOnParts) {
  for (const bool balls : {true, false}) {
    const ConvexUnion truth = balls ? explicit_balls(flake(3)) : explicit_cubes(sponge(3));
    const ExactForm form = balls ? ExactForm(flake(3)) : ExactForm(sponge(3));
    const auto accel = build_accel({{ExactShape{form}, {}}});
    int hits = 0;
    for (const Ray& ray : rays_about(200, 1.2)) {
      for (const Hit& h : all_crossings(*accel, ray)) {
        const SurfaceInteraction s = surface_interaction(*accel, ray, h);
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
        EXPECT_LE(turn, 1e-6L);
        ++hits;
      }
    }
    EXPECT_GT(hits, 300);
  }
}

/// Memory does not grow with the number of parts.
TEST(Fractals, MemoryDoesNotGrowWithDepth) {
  const auto bytes = [](const ExactForm& form) {
    return stats(*build_accel({{ExactShape{form}, {}}})).bytes();
  };
  const std::size_t one_ball = bytes(flake(0)), cube = bytes(sponge(0));
  EXPECT_LT(one_ball, 8192u);
  EXPECT_LT(cube, 8192u);
  const std::size_t plain = bytes(terrain(0)), set = bytes(julia(1));
  EXPECT_LT(plain, 8192u);
  EXPECT_LT(set, 8192u);
  for (const std::uint32_t depth : {1u, 10u, 24u}) EXPECT_EQ(bytes(terrain(depth)), plain);
  for (const std::uint32_t n : {2u, 10u, 24u}) EXPECT_EQ(bytes(julia(n)), set);
  // A ball of bounds per level.
  Ifs::Pool pool;
  Ifs::add(pool, tetrahedron(32), {});
  EXPECT_EQ(pool.elements[0].balls.size(), 33u);
  EXPECT_EQ(pool.elements[0].maps.size(), 4u);
  for (const std::uint32_t depth : {1u, 6u, 12u, 24u}) EXPECT_EQ(bytes(flake(depth)), one_ball);
  for (const std::uint32_t depth : {1u, 5u, 10u, 16u}) EXPECT_EQ(bytes(sponge(depth)), cube);
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
                                ExactForm(flake(2, kNan)), ExactForm(sponge(17)), ExactForm(tetrahedron(33)),
                                ExactForm(julia(0)), ExactForm(terrain(25)), ExactForm(terrain(3, 1))})
    EXPECT_TRUE(all_crossings(form, {{-3, 0.1f, 0.7f}, 0, {1, 0, 0}, kInf}).empty());
  IfsShape growing = tetrahedron(2);
  growing.maps[1] = Affine::scaling({0.5, 1, 0.5});
  EXPECT_EQ(stats(*build_accel({{ExactShape{growing}, {}}})).leaves, 0u);
}

}  // namespace
}  // namespace oktett::fractals_test
