#include "kernels/exact/march.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "tests/support/random_roots.h"

namespace oktett::march_test {
namespace {

using D = Simd<double, 1, ScalarIsa>;
using I = Interval<D>;
using J = Dual<I>;

constexpr int kRoom = 64;

double number(const D& d) { return d.part[0].v; }
J constant(double c) { return {I(D(c)), I(D(0.0))}; }

struct Field {
  std::function<J(const J&)> f;
  mutable int evaluations = 0;
  J over(const I& t) const { return ++evaluations, f({t, I(D(1.0))}); }
  I at(const D& t) const { return ++evaluations, f({I(t), I(D(1.0))}).v; }
};

struct Found {
  std::vector<double> t, turn, part;
  double first_sign;
  int evaluations;
};

Found find(const std::function<J(const J&)>& f, double a, double b,
           interval::Jumps jumps = interval::Jumps::list) {
  const Field field{f};
  Crossings<kRoom, D> out;
  const D sign = interval::march<kRoom>(field, D(a), D(b), D(b), D::M::all_true(), jumps, out);
  Found r;
  for (int k = 0; k < kRoom && number(out.t[k]) < roots::kNoRoot; ++k)
    r.t.push_back(number(out.t[k])), r.turn.push_back(number(out.turn[k])),
        r.part.push_back(number(out.part[k]));
  r.first_sign = number(sign), r.evaluations = field.evaluations;
  return r;
}

void expect_roots(const Found& found, const std::vector<double>& roots, double tolerance = 1e-11) {
  ASSERT_EQ(found.t.size(), roots.size());
  for (std::size_t i = 0; i < roots.size(); ++i) {
    EXPECT_NEAR(found.t[i], roots[i], tolerance);
    EXPECT_EQ(found.turn[i], (i % 2 == 0) == (found.first_sign < 0) ? 1 : -1);
    EXPECT_EQ(found.part[i], 0);
  }
}

/// (t - r1) (t - r2) ...
std::function<J(const J&)> product(std::vector<double> roots, double factor = 1) {
  return [=](const J& t) {
    J p = constant(factor);
    for (const double r : roots) p = p * (t - constant(r));
    return p;
  };
}

TEST(March, FindsKnownRoots) {
  expect_roots(find(product({0.3}), 0, 1), {0.3});
  expect_roots(find(product({0.1, 0.5, 0.7, 0.70001, 0.9}), 0, 1), {0.1, 0.5, 0.7, 0.70001, 0.9});
  expect_roots(find(product({0.5, 0.5 + 1e-6}, -1), 0, 1), {0.5, 0.5 + 1e-6}, 1e-9);
  expect_roots(find(product({-1, 2}), 0, 1), {});
  expect_roots(find([](const J& t) { return sin(t); }, 0.5, 50),
               {1 * M_PI, 2 * M_PI, 3 * M_PI, 4 * M_PI, 5 * M_PI, 6 * M_PI, 7 * M_PI, 8 * M_PI, 9 * M_PI,
                10 * M_PI, 11 * M_PI, 12 * M_PI, 13 * M_PI, 14 * M_PI, 15 * M_PI});
}

/// Beside a pole the enclosure is wide but its sign is certain. That is not the rounding noise of a touch.
TEST(March, PolesInTheMiddleAreNoNoise) {
  const double root = std::sqrt(0.01 / 0.6);
  expect_roots(find(
                   [](const J& t) {
                     const J z = t + J{I(D(-1e-17), D(3e-17)), I(D(0.0))};
                     return constant(0.6) - constant(0.01) / (sqr(z) + constant(1e-60));
                   },
                   -0.5, 0.5),
               {-root, root});
}

/// Random roots, far apart or close together, are all found, as far as doubles can resolve them.
TEST(March, FindsRandomRoots) {
  std::mt19937 random(3);
  int checked = 0;
  for (int k = 0; k < 2000; ++k) {
    const std::vector<double> roots = test::random_roots(random);
    if (test::least_gap(roots) < 1e-5) continue;
    ++checked;
    expect_roots(find(product(roots), 0, 1), roots, 1e-9);
  }
  EXPECT_GT(checked, 1500);
}

/// Touching is no crossing; it costs few steps although rounding hides the sign over 2^-26 of the range.
TEST(March, PassesOverTouching) {
  const Found one = find(product({0.3, 0.3}), 0, 1);
  EXPECT_TRUE(one.t.empty());
  EXPECT_EQ(one.first_sign, 1);
  EXPECT_LT(one.evaluations, 1000);
  EXPECT_TRUE(find(product({0.3, 0.3, 0.7, 0.7}, -1), 0, 1).t.empty());
  expect_roots(find(product({0.3, 0.3, 0.6}), 0, 1), {0.6});
  // Touching fourfold, over 2^-13 of the range.
  EXPECT_TRUE(find(product({0.3, 0.3, 0.3, 0.3}), 0, 1).t.empty());
}

/// A flat crossing counts once, anywhere in the range where rounding hides the sign.
TEST(March, FindsFlatCrossings) {
  expect_roots(find(product({0.3, 0.3, 0.3}), 0, 1), {0.3}, 1e-4);
  expect_roots(find(product({0.3, 0.3, 0.3, 0.3, 0.3}), 0, 1), {0.3}, 1e-2);
}

TEST(March, FollowsTheSurface) {
  // Zero all along, and zero up to 1/2.
  const Found zero = find([](const J& t) { return t - t; }, 0, 1);
  EXPECT_TRUE(zero.t.empty());
  EXPECT_LT(zero.evaluations, 1000);
  const auto ramp = [](const J& t) { return max(t - constant(0.5), constant(0)); };
  EXPECT_TRUE(find(ramp, 0, 1).t.empty());
  // From negative over zero to positive: one crossing in between.
  const auto stairs = [](const J& t) {
    return max(t - constant(0.75), constant(0)) + min(t - constant(0.25), constant(0));
  };
  const Found one = find(stairs, 0, 1);
  ASSERT_EQ(one.t.size(), 1u);
  EXPECT_GE(one.t[0], 0.2499);
  EXPECT_LE(one.t[0], 0.7501);
}

TEST(March, BearsSteepSlopes) {
  expect_roots(find(product({0.3}, 1e300), 0, 1), {0.3});
  expect_roots(find(product({0.3}, 1e-280), 0, 1), {0.3});
  expect_roots(find([](const J& t) { return exp(t * constant(700)) - constant(1e150); }, 0, 1),
               {std::log(1e150) / 700});
  expect_roots(find([](const J& t) { return atan((t - constant(0.3)) * constant(1e12)); }, 0, 1), {0.3});
  // Infinitely steep.
  const auto root = [](const J& t) { return sign(t - constant(0.3)) * sqrt(abs(t - constant(0.3))); };
  expect_roots(find(root, 0, 1), {0.3});
}

/// Signs change at steps, poles and borders of the domain; the latter two can be left out.
TEST(March, TellsJumpsFromCrossings) {
  const auto pole = [](const J& t) { return constant(1) / (t - constant(0.3)); };
  const Found listed = find(pole, 0, 1);
  ASSERT_EQ(listed.t.size(), 1u);
  EXPECT_NEAR(listed.t[0], 0.3, 1e-11);
  EXPECT_EQ(listed.part[0], interval::kJumpPart);
  EXPECT_TRUE(find(pole, 0, 1, interval::Jumps::drop).t.empty());
  const auto square_pole = [](const J& t) { return constant(1) / sqr(t - constant(0.3)) - constant(400); };
  expect_roots(find(square_pole, 0, 1), {0.25, 0.35});
  // Poles between the zeros of the tangent.
  const auto tangent = [](const J& t) { return tan(t); };
  const Found zeros = find(tangent, 1, 8, interval::Jumps::drop);
  ASSERT_EQ(zeros.t.size(), 2u);
  EXPECT_NEAR(zeros.t[0], M_PI, 1e-11);
  EXPECT_NEAR(zeros.t[1], 2 * M_PI, 1e-11);
  EXPECT_EQ(find(tangent, 1, 8).t.size(), 5u);
  // sqrt(t - 0.3) - 0.5 is undefined, hence positive, up to 0.3, then negative up to 0.55.
  const auto border = [](const J& t) { return sqrt(t - constant(0.3)) - constant(0.5); };
  const Found solid = find(border, 0, 1);
  ASSERT_EQ(solid.t.size(), 2u);
  EXPECT_NEAR(solid.t[0], 0.3, 1e-11);
  EXPECT_EQ(solid.part[0], interval::kJumpPart);
  EXPECT_EQ(solid.turn[0], -1);
  EXPECT_NEAR(solid.t[1], 0.55, 1e-11);
  EXPECT_EQ(solid.part[1], 0);
  // Over a step the surface stands upright.
  expect_roots(find([](const J& t) { return floor(t * constant(10)) - constant(4.5); }, 0, 1), {0.5});
}

/// A walk that is resumed where the last one was full finds the same crossings.
TEST(March, ResumesWhereItStopped) {
  const Field field{[](const J& t) { return sin(t * constant(40)); }};
  std::vector<double> all;
  for (double a = 0.01; a < 1;) {
    Crossings<3, D> out;
    interval::march<3>(field, D(a), D(1.0), D(1.0), D::M::all_true(), interval::Jumps::list, out);
    for (int k = 0; k < 3; ++k)
      if (number(out.t[k]) < 1) all.push_back(number(out.t[k]));
    a = number(out.up_to);
  }
  ASSERT_EQ(all.size(), 12u);
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_NEAR(all[i], (i + 1.0) * M_PI / 40, 1e-11);
}

/// A crossing at the end of the range is followed beyond the end if that is allowed.
TEST(March, SettlesTheEnd) {
  const Field field{[](const J& t) {
    const J s = t - constant(0.5);
    return s * s * s;
  }};
  for (const double limit : {0.5, 0.6}) {
    Crossings<1, D> out;
    interval::march<1>(field, D(0.0), D(0.5), D(limit), D::M::all_true(), interval::Jumps::list, out);
    EXPECT_EQ(number(out.t[0]) < 1, limit > 0.5);
  }
}

/// Steps and infinite slopes are distinguished from other crossings on request.
TEST(March, TellsSteps) {
  const auto step = [](const J& t) { return floor(t + constant(0.3)) - constant(0.5); };
  const auto root = [](const J& t) {
    return sqrt(abs(t - constant(0.7))) * (t - constant(0.7)) + sign(t - constant(0.7));
  };
  for (const auto& [f, at] : {std::pair<std::function<J(const J&)>, double>{step, 0.7}, {root, 0.7}}) {
    for (const auto jumps : {interval::Jumps::list, interval::Jumps::drop, interval::Jumps::list_steep}) {
      const Found found = find(f, 0, 1, jumps);
      ASSERT_EQ(found.t.size(), 1u);
      EXPECT_NEAR(found.t[0], at, 1e-11);
      EXPECT_EQ(found.part[0], jumps == interval::Jumps::list_steep ? interval::kJumpPart : 0);
    }
  }
  EXPECT_EQ(find([](const J& t) { return t - constant(0.3); }, 0, 1, interval::Jumps::list_steep).part[0], 0);
}

/// A ray into the wall of a logarithm at a small angle: each step is 0.08 % of the remaining way.
TEST(March, ReachesWallsAtSmallAngles) {
  const std::uint64_t before = interval::uncertified_count();
  const Found found = find(
      [](const J& t) {
        const J x = constant(1) + t, y = constant(-2.005) * t;
        return log(sqr(x) + y - sqr(t) - constant(1) + constant(0.0025)) - constant(50);
      },
      0, 4, interval::Jumps::list_steep);
  EXPECT_EQ(interval::uncertified_count(), before);
  ASSERT_EQ(found.t.size(), 1u);
  EXPECT_NEAR(found.t[0], 0.5, 1e-9);
  EXPECT_EQ(found.part[0], interval::kJumpPart);
}

/// Ordinary functions never exhaust the steps.
TEST(March, GivesUpOnlyOnMonsters) {
  const std::uint64_t before = interval::uncertified_count();
  find([](const J& t) { return sin(constant(100) * t) + cos(constant(31) * t * t) - constant(0.1); }, 0, 10);
  find([](const J& t) { return sin(constant(1) / t); }, 1e-3, 1);
  EXPECT_EQ(interval::uncertified_count(), before);
  // Surely not defined: outside.
  const Found none = find([](const J& t) { return constant(1) / (floor(t) - floor(t)); }, 0.1, 0.9);
  EXPECT_EQ(none.first_sign, 1);
  EXPECT_TRUE(none.t.empty());
  EXPECT_EQ(interval::uncertified_count(), before);
  // Zero with a step every 1e-9, for all that intervals can tell.
  const auto monster = [](const J& t) {
    const J steps = floor(t * constant(1e9));
    return steps - steps;
  };
  find(monster, 0.1, 1);
  EXPECT_EQ(interval::uncertified_count(), before + 1);
  // Not defined anywhere, or all over the place, for all that intervals can tell.
  EXPECT_TRUE(find([](const J& t) { return constant(1) / (t - t); }, 0.1, 1).t.empty());
  EXPECT_EQ(interval::uncertified_count(), before + 2);
}

}  // namespace
}  // namespace oktett::march_test
