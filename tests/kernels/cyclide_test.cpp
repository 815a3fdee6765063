#include "kernels/exact/cyclide.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "kernels/exact/torus.h"
#include "verify/cases/kernel_cases.h"

namespace oktett::cyclide_test {
namespace {

using D = Simd<double, 1, ScalarIsa>;

/// Rings, spindles and horns, the limits between them, tori, and tapers close to the major radius.
CyclideShape draw(CaseRandom& random) {
  CyclideShape s{0.2 + random.unit(), 0.05 + 1.5 * random.unit(), 0};
  const double kind = random.unit();
  if (kind > 0.1) s.taper = s.major * random.unit();
  if (kind > 0.7) s.minor = s.taper;
  if (kind > 0.8) s.minor = s.major;
  if (kind > 0.9) s.taper = s.major * (1 - random.magnitude(-6, -1));
  return s;
}

/// The point of the surface with the given angles (the parametric form).
Vec3d point(const CyclideShape& s, double u, double v) {
  const double a = s.major, c = s.taper, d = s.minor, b2 = (a - c) * (a + c), b = std::sqrt(b2);
  const double below = a - c * std::cos(u) * std::cos(v);
  return {(d * (c - a * std::cos(u) * std::cos(v)) + b2 * std::cos(u)) / below,
          b * std::sin(u) * (a - d * std::cos(v)) / below, b * std::sin(v) * (c * std::cos(u) - d) / below};
}

Cyclide::Pool pool_of(const CyclideShape& s) {
  Cyclide::Pool pool;
  Cyclide::add(pool, s, {});
  return pool;
}

std::vector<double> crossings(const Cyclide::Pool& pool, const Vec3d& o, const Vec3d& d) {
  const Vec3d own_o = pool.frames[0].to_own.point(o), own_d = pool.frames[0].to_own.vector(d);
  const Line<D> line{broadcast<D>(own_o), broadcast<D>(own_d)};
  Crossings<4, D> out;
  Cyclide::crossings<4>(pool, pool.cells[0], line, {D(-1e9), D(1e9), D(0.0), D(0.0)}, D(0.0) == D(0.0), out);
  std::vector<double> t;
  for (const D& x : out.t)
    if (double at; x.store(&at), at < roots::kNoRoot) t.push_back(at);
  return t;
}

/// The equation with y, of which the kernel solves the equivalent with z.
long double equation(const CyclideShape& s, const Vec3<long double>& p) {
  const long double a = s.major, c = s.taper, d = s.minor, b2 = (a - c) * (a + c);
  const long double r = dot(p, p) + b2 - d * d, x = a * p.x - c * d;
  return r * r - 4 * (x * x + b2 * p.y * p.y);
}

TEST(Cyclide, PointsOfTheParametricFormAreOnIt) {
  CaseRandom random(1);
  for (int i = 0; i < 2000; ++i) {
    const CyclideShape s = draw(random);
    const Cyclide::Pool pool = pool_of(s);
    ASSERT_EQ(pool.elements.size(), 1u);
    const Vec3d p = pool.frames[0].to_own.point(
        point(s, 2 * std::numbers::pi * random.unit(), 2 * std::numbers::pi * random.unit()));
    EXPECT_LT(std::abs(slope_at<Cyclide>(pool, 0, 0, p).value), 1e-12);
    for (int k = 0; k < 3; ++k) {
      EXPECT_GE(p[k], pool.cells[0].lo[k] - 1e-12);
      EXPECT_LE(p[k], pool.cells[0].hi[k] + 1e-12);
    }
  }
}

// What is found lies on the surface, and everything that changes the sign of the equation is found.
TEST(Cyclide, CrossingsAreThoseOfTheEquation) {
  CaseRandom random(2);
  int found = 0, missed = 0;
  for (int i = 0; i < 3000; ++i) {
    const CyclideShape s = draw(random);
    const Cyclide::Pool pool = pool_of(s);
    const double scale = random.unit() < 0.1 ? random.magnitude(0, 6) : 3;
    const Vec3d to = point(s, 7 * random.unit(), 7 * random.unit()) * (0.5 + 0.5 * random.unit());
    const Vec3d d = normalize(random.vector()), o = to - d * scale;
    const auto at = [&](long double t) { return equation(s, {o.x + t * d.x, o.y + t * d.y, o.z + t * d.z}); };
    const std::vector<double> t = crossings(pool, o, d);
    found += static_cast<int>(t.size());
    EXPECT_EQ(t.size() % 2, 0u);
    // Between two crossings the sign is one and the same.
    const double reach = 2 * (s.major + s.minor + s.taper);
    for (int k = 0; k < 400; ++k) {
      const double x = scale - reach + 2 * reach * k / 400;
      const auto before = std::count_if(t.begin(), t.end(), [&](double y) { return y < x; });
      if (std::any_of(t.begin(), t.end(), [&](double y) { return std::abs(x - y) < 1e-6 + 1e-9 * scale; }))
        continue;
      const long double f = at(x);
      if (std::abs(f) < 1e-9L) continue;
      missed += (f < 0) != (before % 2 == 1);
    }
  }
  EXPECT_GT(found, 3000);
  EXPECT_EQ(missed, 0);
}

TEST(Cyclide, WithoutTaperIsATorus) {
  CaseRandom random(3);
  std::size_t found = 0;
  for (int i = 0; i < 1000; ++i) {
    const double major = 0.4 + random.unit();
    const TorusShape torus{major, major * random.unit()};
    const Cyclide::Pool pool = pool_of({torus.major, torus.minor, 0});
    Torus::Pool tori;
    Torus::add(tori, torus, {});
    const Vec3d o = random.vector() * 3.0, d = random.vector();
    const Vec3d own_o = tori.frames[0].to_own.point(o), own_d = tori.frames[0].to_own.vector(d);
    Crossings<4, D> out;
    Torus::crossings<4>(tori, tori.cells[0], Line<D>{broadcast<D>(own_o), broadcast<D>(own_d)},
                        {D(-1e9), D(1e9), D(0.0), D(0.0)}, D(0.0) == D(0.0), out);
    const std::vector<double> t = crossings(pool, o, d);
    found += t.size();
    for (std::size_t k = 0; k < 4; ++k) {
      double expected;
      out.t[k].store(&expected);
      if (k >= t.size())
        EXPECT_EQ(expected, roots::kNoRoot);
      else
        EXPECT_NEAR(t[k], expected, 1e-7);
    }
  }
  EXPECT_GT(found, 200u);
}

TEST(Cyclide, UvAndTangentFollowTheParametricForm) {
  CaseRandom random(4);
  for (int i = 0; i < 500; ++i) {
    const double major = 0.4 + random.unit(), minor = major * (0.3 + 0.6 * random.unit());
    const CyclideShape s{major, minor, minor * 0.9 * random.unit()};
    const Cyclide::Pool pool = pool_of(s);
    const double u = 6 * random.unit() - 3, v = 6 * random.unit() - 3, h = 1e-6;
    SurfaceInteraction at;
    const Vec3d own = pool.frames[0].to_own.point(point(s, u, v));
    set_uv(at, Cyclide::uv(pool, 0, 0, own), slope_at<Cyclide>(pool, 0, 0, own).gradient);
    EXPECT_NEAR(at.uv.x, 0.5 + u * 0.5 / std::numbers::pi, 1e-5);
    // The angle of the parametric form is 0 on the inside.
    EXPECT_NEAR(std::cos(2 * std::numbers::pi * (at.uv.y - 0.5) - (v + std::numbers::pi)), 1, 1e-9);
    const Vec3d along = (point(s, u + h, v) - point(s, u - h, v)) * (std::numbers::pi / h);
    const Vec3d tangent = pool.frames[0].to_world.vector(Vec3d(at.tangent));
    EXPECT_LT(length(tangent - along), 1e-4 * length(along));
  }
}

TEST(Cyclide, DegenerateOnesAreLeftOut) {
  for (const CyclideShape& s :
       {CyclideShape{0, 1, 0}, CyclideShape{1, 0, 0}, CyclideShape{1, 0.5, 1}, CyclideShape{1, -1, 0},
        CyclideShape{1, 1, -0.5}, CyclideShape{HUGE_VAL, 1, 0}})
    EXPECT_TRUE(pool_of(s).elements.empty());
}

}  // namespace
}  // namespace oktett::cyclide_test
