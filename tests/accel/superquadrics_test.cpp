#include <gtest/gtest.h>

#include <cmath>

#include "accel/accel.h"
#include "tests/accel/all_crossings.h"
#include "tests/support/limits.h"

namespace oktett::superquadrics_test {
namespace {

using Form = SuperquadricShape::Form;

SuperquadricShape shape(Form form, double p, double q, double r, bool ratio = false) {
  SuperquadricShape s;
  s.form = form, s.ratio = ratio, s.p = p, s.q = q, s.r = r;
  return s;
}
SuperquadricShape ellipsoid(double p, bool ratio = false) { return shape(Form::ellipsoid, p, p, p, ratio); }
SuperquadricShape torus(bool ratio = false) { return shape(Form::toroid, 2, 0.5, 2, ratio); }

std::shared_ptr<const Accel> accel_of(const SuperquadricShape& s, const Affine& to_world = {}) {
  return build_accel({{ExactShape{s}, to_world}});
}

std::vector<Hit> crossings(const Accel& accel, const Vec3f& from, const Vec3f& direction) {
  return all_crossings(accel, {from, 0, direction, kInf});
}

/// Crossings lie at `places`, entering and leaving in turn; the last one leaves.
void expect_at(const SuperquadricShape& s, const Vec3f& from, const Vec3f& direction,
               std::initializer_list<double> places) {
  const std::vector<Hit> all = crossings(*accel_of(s), from, direction);
  ASSERT_EQ(all.size(), places.size());
  std::size_t i = 0;
  for (const double t : places) {
    EXPECT_FLOAT_EQ(all[i].t, static_cast<float>(t)) << "crossing " << i;
    EXPECT_EQ(all[i].v, (places.size() - i) % 2 == 1 ? 1 : -1) << "crossing " << i;
    ++i;
  }
}

// At z = 0 the ray is outside over a length of 2e-12, far less than the spacing of floats.
TEST(Superquadrics, LeavesAndEntersAtOneFloat) {
  const SuperquadricShape cusp = shape(Form::hyperboloid, 2, 2, 0.25);
  expect_at(cusp, {1.0005f, 0, -3}, {0, 0, 1}, {1, 3, 3, 5});
  expect_at(cusp, {1.0005f, 0, -1}, {0, 0, 1}, {1, 1, 3});
  expect_at(cusp, {1.0005f, 0, 1}, {0, 0, -1}, {1, 1, 3});
}

TEST(Superquadrics, KnownCrossings) {
  // An octahedron, a rounded cube and what is hollow.
  expect_at(ellipsoid(1), {0.25f, 0.125f, -3}, {0, 0, 1}, {2.375, 3.625});
  const double x = std::pow(0.875, 0.25);
  expect_at(ellipsoid(4), {-3, 0.5f, 0.5f}, {1, 0, 0}, {3 - x, 3 + x});
  expect_at(ellipsoid(0.5), {-3, 0.0625f, 0.25f}, {1, 0, 0}, {3 - 0.0625, 3 + 0.0625});
  const double y = std::pow(1 - 2 * std::pow(0.5, 2.5), 1 / 2.5);
  expect_at(ellipsoid(2.5), {0.5f, 0, 0.5f}, {0, 0.5f, 0}, {2 * y});
  // g_2(1/2) = 1/3 and g_2(0.8) = 2/3.
  expect_at(ellipsoid(2, true), {-3, 0.5f, 0}, {1, 0, 0}, {2.2, 3.8});
  expect_at(ellipsoid(0.5, true), {-3, 0.25f, 0}, {1, 0, 0}, {3 - 3.0 / 7, 3 + 3.0 / 7});
  expect_at(shape(Form::hyperboloid, 2, 2, 2), {-3, 0, 0}, {1, 0, 0}, {2, 4});
  // Through the faces of its box.
  expect_at(shape(Form::hyperboloid, 2, 2, 2), {0.5f, 0.5f, -3}, {0, 0, 1}, {1, 5});
  SuperquadricShape open = shape(Form::hyperboloid, 2, 2, 2);
  open.open = true;
  expect_at(open, {0.5f, 0.5f, -3}, {0, 0, 1}, {});
  expect_at(open, {-3, 0, 1}, {1, 0, 0}, {3 - std::sqrt(2), 3 + std::sqrt(2)});
  expect_at(torus(), {-3, 0, 0}, {1, 0, 0}, {1.5, 2.5, 3.5, 4.5});
  expect_at(torus(), {0, 0, 0}, {0, -1, 0}, {0.5, 1.5});
  // g_{1/2}(2 g_2(x)) = 1 +- g_2^-1(1/4): x along an axis.
  const double tube = 2 * 0.25 / 1.25;
  const auto ring = [](double w) {
    const double sum = 0.5 * w / (1 - 0.5 * w);
    return 2 * sum / (1 + sum);
  };
  expect_at(torus(true), {0, 0, 0}, {1, 0, 0}, {ring(1 - tube), ring(1 + tube)});
}

TEST(Superquadrics, RadiiStretch) {
  SuperquadricShape s = shape(Form::ellipsoid, 2, 4, 8);
  s.radii = {0.5, 2, 3};
  expect_at(s, {-3, 0, 0}, {1, 0, 0}, {2.5, 3.5});
  expect_at(s, {0, -3, 0}, {0, 1, 0}, {1, 5});
  expect_at(s, {0, 0, -6}, {0, 0, 2}, {1.5, 4.5});
}

/// A ray that touches does not hit, and one that enters by next to nothing has both crossings: on a sphere,
/// on a body that is nearly a cube, and on an octahedron.
TEST(Superquadrics, TangentsTouchAndDoNotHit) {
  const float below = std::nextafter(1.0f, 0.0f);
  const double half = std::sqrt(1 - below * static_cast<double>(below));
  expect_at(ellipsoid(2), {1, 0, -5}, {0, 0, 1}, {});
  expect_at(ellipsoid(2), {below, 0, -5}, {0, 0, 1}, {5 - half, 5 + half});
  expect_at(ellipsoid(2), {std::nextafter(1.0f, 2.0f), 0, -5}, {0, 0, 1}, {});
  // Along a face of what is nearly a cube, at depths that double can tell.
  for (int i = 4; i < 24; ++i) {
    const double depth = std::ldexp(1.0, -i), left = -std::expm1(40 * std::log1p(-depth));
    const double z = std::pow(left, 1.0 / 40);
    expect_at(ellipsoid(40), {static_cast<float>(1 - depth), 0, -5}, {0, 0, 1}, {5 - z, 5 + z});
  }
  // Along the edges of the octahedron.
  expect_at(ellipsoid(1), {1, 0, -5}, {0, 0, 1}, {});
  expect_at(ellipsoid(1), {-2, 0, 3}, {1, 0, -1}, {});
}

TEST(Superquadrics, RaysThatStartOnThem) {
  for (const double p : {0.5, 1.0, 1.5, 2.0, 3.0, 20.0})
    for (const bool ratio : {false, true}) {
      expect_at(ellipsoid(p, ratio), {1, 0, 0}, {1, 0, 0}, {});
      expect_at(ellipsoid(p, ratio), {1, 0, 0}, {-1, 0, 0}, {2});
    }
  expect_at(torus(), {1.5f, 0, 0}, {1, 0, 0}, {});
  expect_at(torus(), {1.5f, 0, 0}, {-1, 0, 0}, {1, 2, 3});
}

std::vector<SuperquadricShape> all_shapes() {
  std::vector<SuperquadricShape> all;
  for (const bool ratio : {false, true}) {
    for (const double p : {0.7, 1.0, 1.3, 2.0, 5.5}) all.push_back(ellipsoid(p, ratio));
    all.push_back(shape(Form::ellipsoid, 1.5, 4, 2.25, ratio));
    all.push_back(shape(Form::hyperboloid, 1.5, 2, 2.5, ratio));
    all.push_back(torus(ratio));
  }
  return all;
}

TEST(Superquadrics, BadRaysHitNothing) {
  for (const SuperquadricShape& s : all_shapes()) {
    const auto accel = accel_of(s);
    for (int k = 0; k < 3; ++k) {
      for (const float bad : {kNan, kInf, -kInf}) {
        Vec3f v{0.1f, 0.2f, 0.3f};
        v[k] = bad;
        EXPECT_TRUE(crossings(*accel, v, {1, 1, 1}).empty()) << bad;
      }
      Vec3f d{0.1f, 0.2f, 0.3f};
      d[k] = kNan;
      EXPECT_TRUE(crossings(*accel, {0, 0, 0}, d).empty());
    }
    EXPECT_TRUE(crossings(*accel, {0.5f, 0, 0}, {0, 0, 0}).empty());
  }
}

Vec3f origin_of(int i) { return {2.5f - 0.03f * i, 1.7f * std::sin(0.7f * i), 2.3f * std::cos(1.3f * i)}; }
Vec3f direction_of(int i) {
  return Vec3f{0.7f * std::sin(3.1f * i), 0.4f * std::sin(1.9f * i), 0.5f * std::cos(2.7f * i)} -
         origin_of(i);
}

/// Scaling the shape or the direction by a power of two changes no bit.
TEST(Superquadrics, TinyAndHuge) {
  for (const SuperquadricShape& s : all_shapes()) {
    const auto unit = accel_of(s);
    int hits = 0;
    for (const int exponent : {-50, 50}) {
      const double scale = std::ldexp(1.0, exponent);
      const auto scaled = accel_of(s, Affine::scaling({scale, scale, scale}));
      for (int i = 0; i < 60; ++i) {
        const std::vector<Hit> expected = crossings(*unit, origin_of(i), direction_of(i));
        const float f = static_cast<float>(scale);
        EXPECT_EQ(crossings(*scaled, origin_of(i) * f, direction_of(i) * f), expected) << i;
        std::vector<Hit> longer = crossings(*unit, origin_of(i), direction_of(i) * f);
        for (Hit& h : longer) h.t *= f;
        EXPECT_EQ(longer, expected) << i;
        hits += !expected.empty();
      }
    }
    EXPECT_GT(hits, 20);
  }
}

/// In planes of symmetry two components are exactly zero all along the ray.
TEST(Superquadrics, RaysInPlanesOfSymmetry) {
  for (const double p : {1.0, 1.1, 1.5, 3.5})
    for (int axis = 0; axis < 3; ++axis) {
      Vec3f from{0, 0, 0}, direction{0, 0, 0};
      from[axis] = -4, direction[axis] = 1;
      expect_at(ellipsoid(p), from, direction, {3, 5});
      from[(axis + 1) % 3] = -4, direction[(axis + 1) % 3] = 1;
      const double d = std::pow(0.5, 1 / p);
      expect_at(ellipsoid(p), from, direction, {4 - d, 4 + d});
    }
}

/// The exact normal against central differences of the function.
TEST(Superquadrics, NormalsAreGradients) {
  for (const SuperquadricShape& s : all_shapes()) {
    const Affine place = Affine::scaling({1, 2, 0.5});
    const auto exact = build_accel({{ExactShape{s}, place}});
    const auto central = build_accel({{ExactShape{s, NormalMethod::central}, place}});
    int smooth = 0, hits = 0;
    for (int i = 0; i < 60; ++i) {
      const Ray ray{Vec3f(place.point(Vec3d(origin_of(i)))), 0, Vec3f(place.vector(Vec3d(direction_of(i)))),
                    kInf};
      std::vector<Hit> list;
      all_hits(*exact, ray, list, Isa::scalar);
      for (const Hit& h : list) {
        const Vec3f a = surface_interaction(*exact, ray, h).geometric_normal,
                    b = surface_interaction(*central, ray, h).geometric_normal;
        EXPECT_NEAR(length(a), 1, 1e-6);
        // Out of the inside.
        EXPECT_GT(dot(a, ray.direction) * h.v, 0) << i;
        ++hits, smooth += length(a - b) < 1e-5f;
      }
    }
    EXPECT_GT(hits, 20);
    EXPECT_GE(smooth, hits - 2);
  }
}

TEST(Superquadrics, SenselessOnesHaveNoSurface) {
  std::vector<SuperquadricShape> bad(8);
  bad[0].p = 0, bad[1].q = -1, bad[2].r = kNan, bad[3].radii.x = 0, bad[4].radii.z = -1,
  bad[5].radii.y = kInf;
  bad[6] = torus(), bad[6].e = 0;
  bad[7] = shape(Form::hyperboloid, 2, 2, 2), bad[7].hi.x = bad[7].lo.x;
  for (std::size_t i = 0; i < bad.size(); ++i)
    EXPECT_TRUE(crossings(*accel_of(bad[i]), {-3, 0.1f, 0.2f}, {1, 0, 0}).empty()) << i;
}

}  // namespace
}  // namespace oktett::superquadrics_test
