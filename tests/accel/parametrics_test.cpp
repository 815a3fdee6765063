/// \file Surfaces given by functions of u and v against values that are known.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "kernels/exact/march.h"
#include "tests/accel/all_crossings.h"
#include "verify/cases/kernel_cases.h"

namespace oktett::parametrics_test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr double kPi = std::numbers::pi;

ParametricShape surface(const std::string& x, const std::string& y, const std::string& z, double u0,
                        double u1, double v0, double v1) {
  ParametricShape s;
  const auto compiled = [](const std::string& text) {
    return UvFunction{compile_function(text, kSurfaceVariables)};
  };
  s.x = compiled(x), s.y = compiled(y), s.z = compiled(z);
  s.from[0] = u0, s.to[0] = u1, s.from[1] = v0, s.to[1] = v1;
  return s;
}

ParametricShape ball(double radius = 1) {
  const std::string r = std::to_string(radius);
  ParametricShape s =
      surface(r + "*cos(v)*cos(u)", r + "*cos(v)*sin(u)", r + "*sin(v)", -kPi, kPi, -kPi / 2, kPi / 2);
  s.open = false;
  return s;
}

TEST(Parametrics, ABallIsMetAsASphereIs) {
  CaseRandom random(3);
  for (const double size : {1e-3, 1.0, 1e3}) {
    const auto accel = build_accel({{ExactShape{ExactForm(ball(size))}, {}}});
    for (int n = 0; n < 400; ++n) {
      Vec3d at = random.vector() * (0.9 * size), from = normalize(random.vector()) * (4 * size);
      // Through poles and along the seam.
      if (n % 100 == 0) at = {0, 0, (n % 200 == 0 ? 1 : -1) * size};
      if (n % 5 == 1) at.y = from.y = 0, from = normalize(from) * (4 * size);
      const Ray ray{Vec3f(from), 0, Vec3f(at - from), kInf};
      const std::vector<Hit> hits = all_crossings(*accel, ray);
      const Vec3d o(ray.origin), d(ray.direction);
      const double b = dot(o, d), dd = dot(d, d), disc = b * b - dd * (dot(o, o) - size * size);
      if (std::abs(disc) < 1e-4 * b * b) continue;
      ASSERT_EQ(hits.size(), disc > 0 ? 2u : 0u) << n << " " << size;
      if (hits.empty()) continue;
      EXPECT_NEAR(hits[0].t, (-b - std::sqrt(disc)) / dd, 1e-5);
      EXPECT_NEAR(hits[1].t, (-b + std::sqrt(disc)) / dd, 1e-5);
      EXPECT_EQ(hits[0].v, -1);
      EXPECT_EQ(hits[1].v, 1);
      const SurfaceInteraction s = surface_interaction(*accel, ray, hits[0]);
      EXPECT_LT(length(Vec3d(s.geometric_normal) - Vec3d(s.position) / size), 1e-4);
    }
  }
}

TEST(Parametrics, HitsHaveTheirParametersAndDerivatives) {
  // A helicoid.
  const auto accel =
      build_accel({{ExactShape{ExactForm(surface("u*cos(v)", "u*sin(v)", "0.2*v", 0.1, 1, -4, 4))}, {}}});
  for (double u = 0.15; u < 1; u += 0.1)
    for (double v = -3.9; v < 4; v += 0.37) {
      const Vec3d p{u * std::cos(v), u * std::sin(v), 0.2 * v};
      const Vec3d by_u{std::cos(v), std::sin(v), 0}, by_v{-u * std::sin(v), u * std::cos(v), 0.2};
      const Vec3d n = normalize(cross(by_u, by_v)), from = p + n * 0.05;
      const Ray ray{Vec3f(from), 0, Vec3f(p - from), kInf};
      const Hit hit = closest_hit(*accel, ray);
      ASSERT_TRUE(hit.valid());
      EXPECT_NEAR(hit.t, 1, 1e-4);
      EXPECT_EQ(hit.v, -1);
      const SurfaceInteraction s = surface_interaction(*accel, ray, hit);
      EXPECT_NEAR(s.uv.x, u, 1e-5);
      EXPECT_NEAR(s.uv.y, v, 1e-5);
      EXPECT_LT(length(Vec3d(s.tangent) - by_u), 1e-4);
      EXPECT_LT(length(Vec3d(s.bitangent) - by_v), 1e-4);
      EXPECT_LT(length(Vec3d(s.geometric_normal) - n), 1e-4);
    }
}

TEST(Parametrics, WhereAFunctionIsNotDefinedIsNothing) {
  const std::uint64_t before = interval::uncertified_count();
  // A disk's worth of a hemisphere over a square.
  const auto accel = build_accel(
      {{ExactShape{ExactForm(surface("u", "v", "sqrt(1 - u^2 - v^2)", -1.5, 1.5, -1.5, 1.5))}, {}}});
  CaseRandom random(4);
  for (int n = 0; n < 120; ++n) {
    const float x = static_cast<float>(1.4 * random.sign()), y = static_cast<float>(1.4 * random.sign());
    const double r2 = static_cast<double>(x) * x + static_cast<double>(y) * y;
    if (std::abs(r2 - 1) < 1e-3) continue;
    const Hit hit = closest_hit(*accel, {{x, y, 3}, 0, {0, 0, -1}, kInf});
    ASSERT_EQ(hit.valid(), r2 < 1) << x << " " << y;
    if (hit.valid()) {
      EXPECT_NEAR(hit.t, 3 - std::sqrt(1 - r2), 1e-5);
    }
  }
  EXPECT_EQ(interval::uncertified_count(), before);
}

TEST(Parametrics, ABoxCutsThem) {
  ParametricShape s = ball();
  s.open = true, s.cut = true, s.lo = {-2, -2, -0.5}, s.hi = {2, 0.25, 0.5};
  const auto accel = build_accel({{ExactShape{ExactForm(s)}, {}}});
  const auto count = [&](const Vec3f& o, const Vec3f& d) {
    return all_crossings(*accel, {o, 0, d, kInf}).size();
  };
  EXPECT_EQ(count({3, 0.1f, 0.1f}, {-1, 0, 0}), 2u);
  EXPECT_EQ(count({0.1f, -3, 0.1f}, {0, 1, 0}), 1u);
  EXPECT_EQ(count({0.1f, 0.1f, 3}, {0, 0, -1}), 0u);
  EXPECT_EQ(count({0.95f, 0.1f, 3}, {0, 0, -1}), 2u);
}

TEST(Parametrics, KinksAndStripsOfOneSideAreMet) {
  const std::uint64_t before = interval::uncertified_count();
  const auto roof = build_accel({{ExactShape{ExactForm(surface("u", "v", "-abs(u)", -1, 1, -1, 1))}, {}}});
  for (const float x : {0.0f, 1e-8f, -0.5f, 0.99f}) {
    const std::vector<Hit> hits = all_crossings(*roof, {{x, 0.3f, 2}, 0, {0, 0, -1}, kInf});
    ASSERT_EQ(hits.size(), 1u) << x;
    EXPECT_NEAR(hits[0].t, 2 + std::abs(x), 1e-6);
  }
  EXPECT_TRUE(all_crossings(*roof, {{-2, 0.3f, 0.001f}, 0, {1, 0, 0}, kInf}).empty());
  // Moebius's strip: a line through its middle meets it once at each side.
  const auto strip =
      build_accel({{ExactShape{ExactForm(surface("(1 + v*cos(u/2))*cos(u)", "(1 + v*cos(u/2))*sin(u)",
                                                 "v*sin(u/2)", 0, 2 * kPi, -0.3, 0.3))},
                    {}}});
  for (int k = 0; k < 64; ++k) {
    const double a = 2 * kPi * k / 64;
    const Vec3d p{std::cos(a), std::sin(a), 0},
        n = normalize(Vec3d{std::cos(a) * std::sin(a / 2), std::sin(a) * std::sin(a / 2), -std::cos(a / 2)});
    const Hit hit = closest_hit(*strip, {Vec3f(p + n * 0.1), 0, Vec3f(n * -0.1), kInf});
    ASSERT_TRUE(hit.valid()) << k;
    EXPECT_NEAR(hit.t, 1, 1e-4);
  }
  EXPECT_EQ(interval::uncertified_count(), before);
}

TEST(Parametrics, WhatHasNoPointsIsNothing) {
  for (const ParametricShape& s : {surface("sqrt(-1 - u^2)", "v", "0", 0, 1, 0, 1),
                                   surface("1", "2", "3", 0, 1, 0, 1), surface("u", "v", "0", 1, 0, 0, 1)})
    EXPECT_TRUE(all_crossings(s, {{0.5f, 0.5f, 1}, 0, {0, 0, -1}, kInf}).empty());
}

}  // namespace
}  // namespace oktett::parametrics_test
