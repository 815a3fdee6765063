#include <gtest/gtest.h>

#include <cmath>

#include "accel/accel.h"
#include "kernels/exact/polynomial_expression.h"
#include "kernels/fields/blob.h"
#include "tests/accel/all_crossings.h"
#include "tests/support/limits.h"
#include "verify/cases/kernel_cases.h"
#include "verify/oracles/exact.h"

namespace oktett::polynomial_surfaces_test {
namespace {

PolynomialShape polynomial(const std::string& equation, double size, bool open = false) {
  PolynomialShape s;
  s.terms = expand_polynomial(equation);
  s.lo = {-size, -size, -size}, s.hi = {size, size, size}, s.open = open;
  return s;
}

std::vector<Hit> crossings(const ExactForm& form, const Vec3f& from, const Vec3f& direction) {
  return all_crossings(form, {from, 0, direction, kInf});
}

void expect_at(const std::vector<Hit>& hits, std::initializer_list<float> places, float within = 1e-6f) {
  ASSERT_EQ(hits.size(), places.size());
  std::size_t i = 0;
  for (const float t : places) {
    EXPECT_NEAR(hits[i].t, t, within) << "crossing " << i;
    EXPECT_EQ(hits[i].v, i % 2 == 0 ? -1 : 1) << "crossing " << i;
    ++i;
  }
}

/// A root that all terms have many times is as sharp as a single one, and where the sign does not change
/// there is no surface.
TEST(PolynomialSurfaces, CommonFactorsCountOnce) {
  for (const char* equation : {"x = 0", "x^3 = 0", "x^5*3 = 0", "-(0 - x)^7 = 0"}) {
    SCOPED_TRACE(equation);
    expect_at(crossings(polynomial(equation, 1), {-3, 0.3f, 0.2f}, {1, 0, 0}), {2, 3}, 0);
    expect_at(crossings(polynomial(equation, 1), {3, 0.1f, 0.2f}, {-1, 0, 0}), {3, 4}, 0);
  }
  EXPECT_EQ(crossings(polynomial("x^2 = 0", 1), {-3, 0.3f, 0.2f}, {1, 0, 0}).size(), 0u);
  expect_at(crossings(polynomial("x^2*(x^2+y^2+z^2-1)", 2), {-3, 0, 0}, {1, 0, 0}), {2, 4}, 0);
  expect_at(crossings(polynomial("-x^2 = 0", 1, true), {-3, 0.3f, 0.2f}, {1, 0, 0}), {});
}

/// Without its even factors a polynomial may be a constant. With one sign it is the whole box, with the other
/// nothing, with or without another term that is negligibly small.
TEST(PolynomialSurfaces, EvenFactorsAloneFillTheBox) {
  for (const char* equation : {"-x^2", "-3*x^4*y^2*z^6", "-x^2 - 1e-9*y^4", "1 = 2"}) {
    SCOPED_TRACE(equation);
    expect_at(crossings(polynomial(equation, 1), {-3, 0.3f, 0.2f}, {1, 0, 0}), {2, 4}, 0);
    expect_at(crossings(polynomial(equation, 1), {0.5f, 0.3f, 3}, {0, 0, -2}), {1, 2}, 0);
    expect_at(crossings(polynomial(equation, 1, true), {-3, 0.3f, 0.2f}, {1, 0, 0}), {});
    EXPECT_EQ(crossings(polynomial(equation, 1), {-3, 1.5f, 0}, {1, 0, 0}).size(), 0u);
  }
  for (const char* equation : {"x^2", "3*x^4*y^2*z^6", "2 = 1", "x = x"})
    EXPECT_EQ(crossings(polynomial(equation, 1), {-3, 0.3f, 0.2f}, {1, 0, 0}).size(), 0u) << equation;
}

/// Rays through singular points, along lines in the surface, and with directions that have zeros.
TEST(PolynomialSurfaces, SingularPoints) {
  // A cone's tip: through it the sign changes along the axis not at all.
  const PolynomialShape cone = polynomial("x^2 + y^2 - z^2", 1);
  expect_at(crossings(cone, {0, 0, 3}, {0, 0, -1}), {2, 4}, 0);
  EXPECT_EQ(crossings(cone, {3, 0, 0}, {-1, 0, 0}).size(), 0u);
  // A line in Clebsch's cubic never leaves it, and one beside it is decided by the sign.
  EXPECT_EQ(crossings(polynomial("x*y*z", 1, true), {-3, 0, 0.5f}, {1, 0, 0}).size(), 0u);
  expect_at(crossings(polynomial("x*y*z", 1, true), {-3, 0.5f, -0.5f}, {2, 0, 0}), {1.5f}, 0);
  // A plane is met once by every ray that reaches it.
  expect_at(crossings(polynomial("y", 10, true), {0, 5, 0}, {0.1f, -1, 0.2f}), {5}, 0);
}

/// The same surface far away, huge and tiny.
TEST(PolynomialSurfaces, AnyScaleAndPlace) {
  for (const double size : {1e-12, 1e-3, 1.0, 1e3, 1e12}) {
    const double q = size * size;
    PolynomialShape s;
    s.terms = {{2, 0, 0, 1 / q}, {0, 2, 0, 1 / q}, {0, 0, 2, 1 / q}, {0, 0, 0, -1}};
    s.lo = Vec3d{-2, -2, -2} * size, s.hi = Vec3d{2, 2, 2} * size;
    const float f = static_cast<float>(size);
    expect_at(crossings(s, {-3 * f, 0, 0}, {1, 0, 0}), {2 * f, 4 * f}, 1e-6f * f);
  }
  // (x - 1000)^2 + ... multiplied out loses six digits of sixteen.
  PolynomialShape s;
  s.terms = expand_polynomial("(x - 1000)^2 + y^2 + z^2 - 1");
  s.lo = {998, -2, -2}, s.hi = {1002, 2, 2};
  expect_at(crossings(s, {990, 0, 0}, {1, 0, 0}), {9, 11}, 1e-5f);
  const Ray ray{{1e5f, 3, 0}, 0, {0, -1, 0}, kInf};
  expect_at(all_crossings(polynomial("x^4 + y^4 + z^4 - 1", 2), ray, Affine::translation({1e5, 0, 0})),
            {2, 4}, 0);
}

TEST(PolynomialSurfaces, NothingForNan) {
  const PolynomialShape s = polynomial("x^2 + y^2 + z^2 - 1", 1);
  EXPECT_EQ(crossings(s, {kNan, 0, 0}, {1, 0, 0}).size(), 0u);
  EXPECT_EQ(crossings(s, {-3, 0, 0}, {1, kNan, 0}).size(), 0u);
  EXPECT_EQ(crossings(s, {-3, 0, 0}, {0, 0, 0}).size(), 0u);
}

/// Every method finds the two crossings of a torus's equation that are far apart.
TEST(PolynomialSurfaces, EveryRootFinder) {
  using roots::Method;
  for (const Method method : {Method::automatic, Method::closed, Method::bernstein, Method::sturm,
                              Method::laguerre, Method::bisection, Method::newton}) {
    PolynomialShape s = polynomial("(x^2 + y^2 + z^2 + 0.75)^2 = 4*(x^2 + y^2)", 2);
    s.root_finder = method;
    expect_at(crossings(s, {-3, 0, 0.1f}, {0, 0.01f, 1}), {});
    const auto hits = crossings(s, {1, 0, -3}, {0, 0, 1});
    expect_at(hits, {2.5f, 3.5f});
  }
}

/// One source is a sphere; two far apart are two; a weight below zero makes a dent.
TEST(Blobs, OfFewSources) {
  using Kind = BlobSource::Kind;
  BlobShape one;
  one.sources = {{Kind::point, {1, 2, 3}, {}, 0, 4}};
  expect_at(crossings(one, {-3, 2, 3}, {1, 0, 0}), {2, 6});
  BlobShape two;
  two.sources = {{Kind::point, {-100, 0, 0}, {}, 0, 1}, {Kind::point, {100, 0, 0}, {}, 0, 1}};
  expect_at(crossings(two, {-200, 0, 0}, {1, 0, 0}), {99, 101, 299, 301}, 1e-2f);
  BlobShape dent = one;
  dent.sources.push_back({Kind::point, {1, 2, 5}, {}, 0, -1});
  const auto hits = crossings(dent, {1, 2, 9}, {0, 0, -1});
  ASSERT_EQ(hits.size(), 2u);
  EXPECT_GT(hits[0].t, 4.1f);
}

/// One source makes a ball; of several, the box is no larger than if all were at the one that lies farthest.
TEST(Blobs, BoxesOfPoints) {
  for (const Vec3d& at : {Vec3d{0, 0, 0}, Vec3d{100, -100, 3}, Vec3d{-0.5, 20, -1000}}) {
    BlobShape one;
    one.sources = {{BlobSource::Kind::point, at, {}, 0, 4}};
    one.iso = 0.25;
    const auto ball = blob_box(one);
    ASSERT_TRUE(ball);
    BlobShape three = one;
    three.sources.push_back({BlobSource::Kind::point, at + Vec3d{1, 2, -1}, {}, 0, 1});
    three.sources.push_back({BlobSource::Kind::point, at + Vec3d{-1, 0.5, 0}, {}, 0, -2});
    const auto box = blob_box(three);
    ASSERT_TRUE(box);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR((*ball)[0][k], at[k] - 4, 1e-8);
      EXPECT_NEAR((*ball)[1][k], at[k] + 4, 1e-8);
      EXPECT_LE((*ball)[0][k], at[k] - 4);
      EXPECT_GE((*ball)[1][k], at[k] + 4);
      // Weights of 5 at one point reach sqrt(20).
      EXPECT_LT((*box)[0][k], at[k] - 4);
      EXPECT_GT((*box)[1][k], at[k] + 4);
      EXPECT_GT((*box)[0][k], at[k] - 1 - std::sqrt(20.0));
      EXPECT_LT((*box)[1][k], at[k] + 2 + std::sqrt(20.0));
    }
  }
}

/// Through a source the sum is infinite, along a line as well.
TEST(Blobs, RaysThroughSources) {
  using Kind = BlobSource::Kind;
  BlobShape line;
  line.sources = {{Kind::line, {0, 0, 0}, {0, 0, 1}, 0, 0.25}};
  line.bounded = true, line.lo = {-1, -1, -1}, line.hi = {1, 1, 1};
  expect_at(crossings(line, {0, 0, -5}, {0, 0, 1}), {4, 6}, 0);
  expect_at(crossings(line, {-5, 0, 0}, {1, 0, 0}), {4.5f, 5.5f});
  BlobShape plane;
  plane.sources = {{Kind::plane, {}, {0, 2, 0}, 0.5, 0.01}};
  plane.bounded = true, plane.lo = {-1, -1, -1}, plane.hi = {1, 1, 1};
  expect_at(crossings(plane, {0, 5, 0}, {0, -1, 0}), {4.4f, 4.6f});
  expect_at(crossings(plane, {-5, 0.5f, 0}, {1, 0, 0}), {4, 6}, 0);
}

RevolutionShape rings() {
  RevolutionShape s;
  s.profile = RevolutionShape::Profile::linear;
  s.points = {{1, 0}, {1, 1}, {2, 1}, {2, 2}, {0, 4}};
  return s;
}

/// Rays along the axis, through a tip, in the plane of a ring, and past edges by one unit in the last place.
TEST(Revolutions, EdgesAndAxis) {
  const RevolutionShape s = rings();
  expect_at(crossings(s, {0, -1, 0}, {0, 1, 0}), {1, 5}, 0);
  expect_at(crossings(s, {1.5f, -1, 0}, {0, 1, 0}), {2, 3.5f}, 0);
  expect_at(crossings(s, {-5, 0.5f, 0}, {1, 0, 0}), {4, 6}, 0);
  expect_at(crossings(s, {-5, 1.5f, 0}, {1, 0, 0}), {3, 7}, 0);
  EXPECT_EQ(crossings(s, {-5, std::nextafter(4.0f, 5.0f), 0}, {1, 0, 0}).size(), 0u);
  EXPECT_EQ(crossings(s, {std::nextafter(2.0f, 3.0f), -1, 0}, {0, 1, 0}).size(), 0u);
  EXPECT_EQ(crossings(s, {std::nextafter(2.0f, 1.0f), -1, 0}, {0, 1, 0}).size(), 2u);
  // In the plane where two pieces meet it is one of the two, never a leak.
  EXPECT_EQ(crossings(s, {-5, 1, 0}, {1, 0, 0}).size() % 2, 0u);
  RevolutionShape open = s;
  open.open = true;
  const auto through = crossings(open, {0.5f, -1, 0}, {0, 1, 0});
  ASSERT_EQ(through.size(), 1u);
  EXPECT_EQ(through[0].t, 4.5f);
  EXPECT_EQ(through[0].v, 1);
}

/// A cylinder given as a Bezier curve has the crossings of a cylinder; a profile may turn back.
TEST(Revolutions, Curves) {
  LatheShape tube;
  tube.points = {{1, 0}, {1, 1}, {1, 2}, {1, 3}};
  expect_at(crossings(tube, {-5, 1.5f, 0}, {1, 0, 0}), {4, 6});
  expect_at(crossings(tube, {0, -2, 0}, {0, 1, 0}), {2, 5});
  expect_at(crossings(tube, {0.25f, -2, 0}, {0, 2, 0}), {1, 2.5f});
  // A ring of square section.
  LatheShape ring;
  const auto side = [&](double r0, double y0, double r1, double y1) {
    if (ring.points.empty()) ring.points.push_back({r0, y0});
    for (int i = 1; i <= 3; ++i) ring.points.push_back({r0 + (r1 - r0) * i / 3, y0 + (y1 - y0) * i / 3});
  };
  side(1, 0, 2, 0), side(2, 0, 2, 1), side(2, 1, 1, 1), side(1, 1, 1, 0);
  expect_at(crossings(ring, {-5, 0.5f, 0}, {1, 0, 0}), {3, 4, 6, 7});
  expect_at(crossings(ring, {1.5f, -1, 0}, {0, 1, 0}), {1, 2});
  EXPECT_EQ(crossings(ring, {0.5f, -1, 0}, {0, 1, 0}).size(), 0u);
}

/// A cone given as a Bezier curve has the crossings of a cone, to a float, also where a ray that hardly rises
/// meets it at a slant.
TEST(Revolutions, CurvesMetAtASlant) {
  LatheShape cone;
  cone.open = true;
  for (int i = 0; i < 4; ++i) cone.points.push_back({1.5 - i / 3.0, -1 + 2 * i / 3.0});
  CaseRandom random(7);
  int count = 0;
  for (int power = -14; power <= 0; ++power)
    for (int i = 0; i < 200; ++i) {
      const double y = 0.9 * random.sign(), angle = 180 * random.sign(),
                   rise = std::ldexp(random.sign(), power);
      const double slant = random.magnitude(-3, 0), back = random.magnitude(-3, -1.5);
      const Affine turn = Affine::rotation({0, angle, 0});
      const Vec3d d{slant, rise, 1}, at{1 - 0.5 * y, y, 0};
      const Ray ray{Vec3f(turn.point(at - d * back)), 0, Vec3f(turn.vector(d)), kInf};
      // |(x, z)| = 1 - y / 2.
      const Vec3l o(ray.origin), v(ray.direction);
      const long double r = 1 - 0.5L * o.y, dr = -0.5L * v.y;
      const long double a = v.x * v.x + v.z * v.z - dr * dr, b = o.x * v.x + o.z * v.z - r * dr,
                        c = o.x * o.x + o.z * o.z - r * r, q = b * b - a * c;
      const long double w = b > 0 ? -b - std::sqrt(q) : -b + std::sqrt(q);
      const long double t = std::min(w / a, c / w) > 0 ? std::min(w / a, c / w) : std::max(w / a, c / w);
      const std::vector<Hit> hits = all_crossings(cone, ray);
      if (!(q > 1e-8) || std::abs(o.y + t * v.y) > 0.99) continue;
      ++count;
      ASSERT_FALSE(hits.empty());
      EXPECT_NEAR(hits[0].t, t, 0x1p-24 * t + 0x1p-38) << "rise " << rise << ", slant " << slant;
    }
  EXPECT_GT(count, 2000);
}

}  // namespace
}  // namespace oktett::polynomial_surfaces_test
