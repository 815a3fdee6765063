/// \file Texture coordinates of exact surfaces against formulas for their own spaces.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "accel/accel.h"
#include "core/random.h"

namespace oktett::surface_uv_test {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// The distance of two numbers on a circle of circumference 1.
double apart(double a, double b) {
  const double d = std::abs(a - b);
  return std::abs(d - std::floor(d + 0.5));
}

/// The angle of (x, y), counter-clockwise from -x, as a part of a turn.
double turn(double x, double y) { return 0.5 + std::atan2(y, x) / kTurn; }

struct Uv {
  double u, v;
};

/// Expects these uv at random hits of the shape, which is moved; NaN: not compared. Also expects that a small
/// step along dp/du changes only u, and one along dp/dv only v, by what their lengths say.
void expect_uv(const ExactForm& form, const std::function<Uv(const Vec3d&)>& want, const char* what) {
  const Affine place =
      Affine::translation({1, 2, 3}) * Affine::rotation({30, 40, 50}) * Affine::scaling({2, 2, 2});
  Geometry geometry;
  geometry.shape = ExactShape{form};
  geometry.transform = place;
  const auto accel = build_accel({geometry});
  const Affine back = place.inverse();
  int found = 0;
  for (std::uint32_t i = 0; i < 4000 && found < 300; ++i) {
    const auto number = [&](std::uint32_t k) { return 2 * static_cast<double>(random_float(5, i, k)) - 1; };
    const Vec3d from = normalize(Vec3d{number(0), number(1), number(2)}) * 5.0;
    const Vec3d to = Vec3d{number(3), number(4), number(5)};
    const Ray ray{Vec3f(place.point(from)), 0, Vec3f(place.vector(to - from))};
    const Hit hit = closest_hit(*accel, ray);
    if (!hit.valid()) continue;
    const SurfaceInteraction s = surface_interaction(*accel, ray, hit);
    const Vec3d p = back.point(Vec3d(s.position));
    const Uv uv = want(p);
    ++found;
    if (!std::isnan(uv.u)) {
      EXPECT_LT(apart(s.uv.x, uv.u), 2e-5) << what << ' ' << p.x << ' ' << p.y << ' ' << p.z;
    }
    if (!std::isnan(uv.v)) {
      EXPECT_NEAR(s.uv.y, uv.v, 2e-5) << what << ' ' << p.x << ' ' << p.y << ' ' << p.z;
    }
    const Vec3d along = back.vector(Vec3d(s.tangent));
    if (!(length(along) > 1e-3)) continue;
    const double step = 1e-4 / length(along);
    const Uv next = want(p + along * step), before = want(p - along * step);
    if (std::isnan(next.u)) continue;
    EXPECT_LT(apart(next.u - before.u, 2 * step), 0.02 * step) << what;
    if (!std::isnan(next.v)) {
      EXPECT_NEAR(next.v, before.v, 1e-3 * step) << what;
    }
    const Vec3d up = back.vector(Vec3d(s.bitangent));
    // A step past the edge of a part is none along dp/dv.
    if (!(length(up) > 1e-3) || std::isnan(next.v)) continue;
    const double rise = 1e-4 / length(up);
    const Uv above = want(p + up * rise), below = want(p - up * rise);
    EXPECT_LT(apart(above.u, below.u), 0.02 * rise) << what;
    EXPECT_LT(apart(above.v - below.v, 2 * rise), 0.02 * rise) << what;
  }
  EXPECT_GT(found, 100) << what;
}

TEST(SurfaceUv, OfToriRunsAroundTheRingAndTheTube) {
  TorusShape torus;
  torus.major = 0.8, torus.minor = 0.35;
  expect_uv(
      torus,
      [](const Vec3d& p) {
        return Uv{turn(p.x, p.y), turn(std::hypot(p.x, p.y) - 0.8, p.z)};
      },
      "torus");
}

TEST(SurfaceUv, OfColumnsRunsFromEndToEnd) {
  CylinderShape column;
  column.from = {0.2, -0.5, 0.1}, column.to = {0.2, 0.9, 0.1}, column.radius = 0.6;
  const auto v_of = [](double radius_at_bottom, double radius_at_top) {
    return [=](const Vec3d& p) {
      const double y = (p.y + 0.5) / 1.4, rho = std::hypot(p.x - 0.2, p.z - 0.1);
      const double v = y < 1e-5 ? rho / radius_at_bottom : y > 1 - 1e-5 ? rho / radius_at_top : y;
      return Uv{NAN, v};
    };
  };
  expect_uv(column, v_of(0.6, 0.6), "cylinder");
  ConeShape cone;
  cone.from = column.from, cone.to = column.to, cone.from_radius = 0.8, cone.to_radius = 0.3;
  expect_uv(cone, v_of(0.8, 0.3), "cone");
}

TEST(SurfaceUv, OfQuadricsRunsAroundZAndUpTheBox) {
  QuadricShape hyperboloid;
  hyperboloid.coefficients = {1, 1, -0.5, 0, 0, 0, 0, 0, 0, -0.2};
  hyperboloid.clipped = hyperboloid.open = true;
  hyperboloid.lo = {-1, -1, -0.6}, hyperboloid.hi = {1, 1, 0.8};
  expect_uv(
      hyperboloid,
      [](const Vec3d& p) {
        return Uv{turn(p.x, p.y), (p.z + 0.6) / 1.4};
      },
      "hyperboloid");
  // An ellipsoid has a box of its own.
  expect_uv(
      QuadricShape{},
      [](const Vec3d& p) {
        return Uv{turn(p.x, p.y), (p.z + 1) / 2};
      },
      "ball");
}

TEST(SurfaceUv, OfSuperquadricsFollowsTheirForm) {
  SuperquadricShape s;
  s.form = SuperquadricShape::Form::ellipsoid;
  s.radii = {1, 1, 0.5};
  expect_uv(
      s,
      [](const Vec3d& p) {
        return Uv{turn(p.x, p.y), 0.5 + std::atan2(p.z / 0.5, std::hypot(p.x, p.y)) / std::numbers::pi};
      },
      "superellipsoid");
  s.form = SuperquadricShape::Form::toroid;
  s.radii = {1, 1, 1}, s.q = 0.5, s.d = 0.8, s.e = 0.3;
  expect_uv(
      s,
      [](const Vec3d& p) {
        return Uv{turn(p.x, p.y), turn(std::hypot(p.x, p.y) - 0.8, p.z)};
      },
      "supertoroid");
}

TEST(SurfaceUv, OfRevolutionsRunsAroundYAndUp) {
  RevolutionShape vase;
  vase.profile = RevolutionShape::Profile::linear;
  vase.points = {{0.4, -0.7}, {0.8, 0.1}, {0.3, 0.9}};
  vase.open = true;
  expect_uv(
      vase,
      [](const Vec3d& p) {
        return Uv{turn(p.z, p.x), (p.y + 0.7) / 1.6};
      },
      "revolution");
}

TEST(SurfaceUv, OfPrismsRunsAlongTheOutlineAndUp) {
  PrismShape s;
  s.outlines = {{{-0.8, -0.8}, {0.8, -0.8}, {0.8, 0.8}, {-0.8, 0.8}}};
  s.from = -0.7, s.to = 0.9;
  const auto on_side = [](double x, double z) {
    const double a = std::abs(x), b = std::abs(z);
    if (b > a) return z < 0 ? (x + 0.8) / 6.4 : 0.5 + (0.8 - x) / 6.4;
    return x > 0 ? 0.25 + (z + 0.8) / 6.4 : 0.75 + (0.8 - z) / 6.4;
  };
  expect_uv(
      s,
      [&](const Vec3d& p) {
        const bool flat = std::abs(p.y + 0.7) < 1e-5 || std::abs(p.y - 0.9) < 1e-5;
        if (flat) return Uv{(p.x + 0.8) / 1.6, (p.z + 0.8) / 1.6};
        return Uv{on_side(p.x, p.z), (p.y + 0.7) / 1.6};
      },
      "prism");
  // A pyramid: up each side u stays the same.
  s.sweep = PrismShape::Sweep::conic, s.from = 0, s.to = 1;
  expect_uv(
      s,
      [&](const Vec3d& p) {
        if (std::abs(p.y - 1) < 1e-5) return Uv{(p.x + 0.8) / 1.6, (p.z + 0.8) / 1.6};
        return Uv{on_side(p.x / p.y, p.z / p.y), p.y};
      },
      "pyramid");
}

}  // namespace
}  // namespace oktett::surface_uv_test
