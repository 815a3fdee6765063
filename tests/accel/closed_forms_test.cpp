#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "accel/accel.h"
#include "tests/accel/all_crossings.h"
#include "tests/support/limits.h"

namespace oktett::closed_forms_test {
namespace {

std::shared_ptr<const Accel> accel_of(ExactForm form, const Affine& to_world = {}) {
  return build_accel({{ExactShape{std::move(form)}, to_world}});
}

std::vector<Hit> crossings(const Accel& accel, const Vec3f& from, const Vec3f& direction) {
  return all_crossings(accel, {from, 0, direction, kInf});
}

struct Crossing {
  float t;
  int part, turn;
};
void expect_crossings(const Accel& accel, const Vec3f& from, const Vec3f& direction,
                      std::initializer_list<Crossing> expected) {
  SCOPED_TRACE(testing::Message() << "from " << from.x << ", " << from.y << ", " << from.z << " towards "
                                  << direction.x << ", " << direction.y << ", " << direction.z);
  const std::vector<Hit> all = crossings(accel, from, direction);
  ASSERT_EQ(all.size(), expected.size());
  std::size_t i = 0;
  for (const Crossing& c : expected) {
    EXPECT_FLOAT_EQ(all[i].t, c.t);
    EXPECT_EQ(all[i].u, c.part) << "crossing " << i;
    EXPECT_EQ(all[i].v, c.turn) << "crossing " << i;
    ++i;
  }
}

const float kBelow1 = std::nextafter(1.0f, 0.0f), kAbove1 = std::nextafter(1.0f, 2.0f);

/// Rays along the axis and the generators stay inside or outside: there is no threshold.
TEST(Cylinder, RaysAlongTheAxis) {
  const auto accel = accel_of(CylinderShape{});
  expect_crossings(*accel, {0, -5, 0}, {0, 1, 0}, {{4, 1, -1}, {6, 2, 1}});
  expect_crossings(*accel, {0, 5, 0}, {0, -2, 0}, {{2, 2, -1}, {3, 1, 1}});
  expect_crossings(*accel, {kBelow1, -5, 0}, {0, 1, 0}, {{4, 1, -1}, {6, 2, 1}});
  expect_crossings(*accel, {1, -5, 0}, {0, 1, 0}, {});
  expect_crossings(*accel, {kAbove1, -5, 0}, {0, 1, 0}, {});
  expect_crossings(*accel, {0.6f, 0, 0.6f}, {0, 1, 0}, {{1, 2, 1}});
  // Nearly along it, the other direction components far below what a threshold would see.
  expect_crossings(*accel, {0.5f, -5, 0}, {1e-20f, 1, 1e-30f}, {{4, 1, -1}, {6, 2, 1}});
  const auto open = accel_of(CylinderShape{{0, -1, 0}, {0, 1, 0}, 1, true});
  expect_crossings(*open, {0.5f, -5, 0}, {0, 1, 0}, {});
  expect_crossings(*open, {0, 2, 0}, {1, -2, 0}, {{1, 0, 1}});
}

TEST(Cylinder, TangentsTouchAndDoNotHit) {
  const auto accel = accel_of(CylinderShape{});
  expect_crossings(*accel, {1, 0, -5}, {0, 0, 1}, {});
  expect_crossings(*accel, {kAbove1, 0, -5}, {0, 0, 1}, {});
  const float half = std::sqrt(1 - kBelow1 * static_cast<double>(kBelow1));
  expect_crossings(*accel, {kBelow1, 0, -5}, {0, 0, 1}, {{5 - half, 0, -1}, {5 + half, 0, 1}});
  // In the plane of an end.
  expect_crossings(*accel, {-5, 1, 0}, {1, 0, 0}, {});
  expect_crossings(*accel, {-5, kBelow1, 0}, {1, 0, 0}, {{4, 0, -1}, {6, 0, 1}});
}

TEST(Cylinder, RaysThatStartOnIt) {
  const auto accel = accel_of(CylinderShape{});
  expect_crossings(*accel, {1, 0, 0}, {-1, 0, 0}, {{2, 0, 1}});
  expect_crossings(*accel, {1, 0, 0}, {1, 0, 0}, {});
  expect_crossings(*accel, {0, 1, 0}, {0, -1, 0}, {{2, 1, 1}});
  expect_crossings(*accel, {0, 1, 0}, {0, 1, 0}, {});
}

/// Scaling by a power of two changes no bit.
template <class Shape, class Scaled>
void expect_same_at_all_scales(const Shape& shape, const Scaled& scaled) {
  const auto unit = accel_of(shape);
  for (const int exponent : {-50, -30, 30, 50}) {
    const float s = std::ldexp(1.0f, exponent);
    const auto accel = accel_of(scaled(std::ldexp(1.0, exponent)));
    for (int i = 0; i < 200; ++i) {
      const Vec3f from{2 - 0.03f * i, 1.7f * std::sin(0.7f * i), 2.3f * std::cos(1.3f * i)};
      const Vec3f direction{0.3f * std::sin(3.1f * i) - from.x, -from.y, 0.4f * std::cos(2.7f * i) - from.z};
      const std::vector<Hit> expected = crossings(*unit, from, direction);
      EXPECT_EQ(crossings(*accel, from * s, direction * s), expected) << exponent << ", " << i;
    }
  }
}
TEST(Cylinder, TinyAndHuge) {
  expect_same_at_all_scales(CylinderShape{{0, -1, 0}, {0, 1, 0}, 0.5}, [](double s) {
    return CylinderShape{{0, -s, 0}, {0, s, 0}, 0.5 * s};
  });
}
TEST(Cone, TinyAndHuge) {
  expect_same_at_all_scales(ConeShape{{0, -1, 0}, {0, 1, 0}, 0.5, 0.25}, [](double s) {
    return ConeShape{{0, -s, 0}, {0, s, 0}, 0.5 * s, 0.25 * s};
  });
}
TEST(Quadric, TinyAndHuge) {
  expect_same_at_all_scales(QuadricShape{{1, 2, 4, 0.5, 0, -0.25, 0, 0, 0, -1}, true}, [](double s) {
    return QuadricShape{{1, 2, 4, 0.5, 0, -0.25, 0, 0, 0, -s * s}, true, {-s, -s, -s}, {s, s, s}};
  });
}

std::vector<ExactForm> all_forms() {
  PolyhedronShape cube;
  for (int k = 0; k < 6; ++k) {
    cube.planes.push_back({{0, 0, 0}, 1});
    cube.planes.back().normal[k / 2] = k % 2 == 0 ? 1 : -1;
  }
  return {CylinderShape{},
          ConeShape{},
          cube,
          QuadricShape{},
          QuadricShape{{1, 1, -1, 0, 0, 0, 0, 0, 0, -1}},
          QuadricShape{{1, 1, -1, 0, 0, 0, 0, 0, 0, -1}, true}};
}

TEST(ClosedForms, BadRaysHitNothing) {
  for (const ExactForm& form : all_forms()) {
    const auto accel = accel_of(form);
    for (int k = 0; k < 3; ++k)
      for (const float bad : {kNan, kInf, -kInf}) {
        Vec3f v{0.1f, 0.2f, 0.3f};
        v[k] = bad;
        EXPECT_TRUE(crossings(*accel, v, {1, 1, 1}).empty()) << form.index() << ", " << bad;
        if (!std::isnan(bad)) continue;
        EXPECT_TRUE(crossings(*accel, {0, 0, 0}, v).empty()) << form.index();
      }
    EXPECT_TRUE(crossings(*accel, {0, 0, 0}, {0, 0, 0}).empty()) << form.index();
    EXPECT_TRUE(crossings(*accel, {5, 0, 0}, {0, 0, 0}).empty()) << form.index();
  }
}

/// A ray from the middle of a solid has one crossing, for any length of the direction.
TEST(ClosedForms, DirectionsOfAnyLength) {
  for (const ExactForm& form : all_forms()) {
    const auto accel = accel_of(form);
    for (const int exponent : {-100, -50, 50, 100}) {
      const float s = std::ldexp(1.0f, exponent);
      const std::vector<Hit> a = crossings(*accel, {0.01f, 0, 0}, {1, 0.5f, 0.25f}),
                             b = crossings(*accel, {0.01f, 0, 0}, Vec3f{1, 0.5f, 0.25f} * s);
      ASSERT_EQ(a.size(), 1u) << form.index();
      ASSERT_EQ(b.size(), 1u) << form.index();
      EXPECT_EQ(b[0].t * s, a[0].t) << form.index();
      EXPECT_EQ(a[0].v, 1) << form.index();
    }
  }
}

/// At a distance of 131072 a float resolves 1/64. A shift that is exact there shifts hits exactly.
TEST(ClosedForms, FarAway) {
  for (const ExactForm& form : all_forms()) {
    const auto near = accel_of(form), far = accel_of(form, Affine::translation({131072, -131072, 131072}));
    int hits = 0;
    for (int i = 0; i < 300; ++i) {
      const Vec3f from{3, static_cast<float>(i % 17) / 8 - 1, static_cast<float>(i % 23) / 8 - 1.5f};
      const Vec3f direction{-1, static_cast<float>(i % 5) / 4 - 0.5f, static_cast<float>(i % 7) / 4 - 0.75f};
      const std::vector<Hit> a = crossings(*near, from, direction),
                             b = crossings(*far, from + Vec3f{131072, -131072, 131072}, direction);
      ASSERT_EQ(a.size(), b.size()) << form.index() << ", " << i;
      for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k].t, b[k].t, 1e-6 * a[k].t) << form.index();
      hits += !a.empty();
    }
    EXPECT_GT(hits, 20) << form.index();
  }
}

/// The default cone has its base at y = -1 and its tip at y = 1.
TEST(Cone, RaysThroughTheTip) {
  const auto accel = accel_of(ConeShape{});
  const std::vector<Hit> down = crossings(*accel, {0, 5, 0}, {0, -1, 0});
  ASSERT_EQ(down.size(), 2u);
  EXPECT_EQ(down[0].t, 4);
  EXPECT_EQ(down[1].t, 6);
  EXPECT_EQ(down[1].u, 1);
  // Through the tip at a slant: in there, out through the base.
  const std::vector<Hit> slant = crossings(*accel, {-0.25f, 2, 0}, {0.25f, -1, 0});
  ASSERT_EQ(slant.size(), 2u);
  EXPECT_FLOAT_EQ(slant[0].t, 1);
  EXPECT_FLOAT_EQ(slant[1].t, 3);
  // Past it: the mirror image above the tip is no part of it.
  expect_crossings(*accel, {-5, 1, 0}, {1, 0, 0}, {});
  expect_crossings(*accel, {-5, 1.5f, 0}, {1, 0, 0}, {});
  EXPECT_EQ(crossings(*accel, {-5, kBelow1, 0}, {1, 0, 0}).size(), 2u);
}

/// A ray along a generator on the surface crosses nothing; one inside crosses base and side once each.
TEST(Cone, RaysAlongGenerators) {
  const auto accel = accel_of(ConeShape{});
  expect_crossings(*accel, {2, -3, 0}, {-1, 2, 0}, {});
  for (int i = 1; i < 24; ++i) {
    const float shift = std::ldexp(1.0f, -i);
    const std::vector<Hit> in = crossings(*accel, {2 - shift, -3, 0}, {-1, 2, 0});
    ASSERT_EQ(in.size(), 2u) << i;
    EXPECT_FLOAT_EQ(in[0].t, 1);
    EXPECT_EQ(in[0].u, 1);
    EXPECT_EQ(in[1].u, 0);
    // 1 - x = (1 + y) / 2 on the other side, where x = 2 - shift - t is negative.
    EXPECT_FLOAT_EQ(in[1].t, 2 - shift / 2);
    EXPECT_TRUE(crossings(*accel, {2 + shift, -3, 0}, {-1, 2, 0}).empty()) << i;
  }
}

TEST(Cone, EqualRadiiMakeACylinder) {
  const auto cone = accel_of(ConeShape{{0, -1, 0}, {0.5, 1, 0.25}, 0.7, 0.7}),
             cylinder = accel_of(CylinderShape{{0, -1, 0}, {0.5, 1, 0.25}, 0.7});
  for (int i = 0; i < 500; ++i) {
    const Vec3f from{3 * std::sin(0.7f * i), 2 * std::cos(1.1f * i), 3 * std::cos(0.7f * i)};
    const Vec3f direction = Vec3f{std::sin(2.3f * i), std::sin(3.7f * i), std::cos(5.1f * i)} - from;
    const std::vector<Hit> a = crossings(*cone, from, direction), b = crossings(*cylinder, from, direction);
    ASSERT_EQ(a.size(), b.size()) << i;
    for (std::size_t k = 0; k < a.size(); ++k) {
      EXPECT_FLOAT_EQ(a[k].t, b[k].t) << i;
      EXPECT_EQ(a[k].u, b[k].u) << i;
    }
  }
}

TEST(Polyhedron, EdgesAndCornersOfACube) {
  const auto accel = accel_of(all_forms()[2]);
  const std::vector<Hit> diagonal = crossings(*accel, {-2, -2, -2}, {1, 1, 1});
  ASSERT_EQ(diagonal.size(), 2u);
  EXPECT_EQ(diagonal[0].t, 1);
  EXPECT_EQ(diagonal[1].t, 3);
  // In the plane of a face, along an edge, past an edge.
  expect_crossings(*accel, {-2, 1, 0}, {1, 0, 0}, {});
  expect_crossings(*accel, {-2, 1, 1}, {1, 0, 0}, {});
  expect_crossings(*accel, {-2, 1, 0}, {1, -1, 0}, {{1, 0, -1}, {2, 2, 1}});
  EXPECT_EQ(crossings(*accel, {-2, 0, 0}, {1, 1, 0}).size(), 0u) << "touches an edge";
  EXPECT_EQ(crossings(*accel, {-2, kBelow1, kBelow1}, {1, 0, 0}).size(), 2u);
}

/// Bounds are those of the corners. They are tight for turned shapes too, unlike the image of the own box.
TEST(ClosedForms, BoundsAreTight) {
  const auto expect_box = [](const Accel& accel, const Vec3d& lo, const Vec3d& hi) {
    const Box b = bounds(accel);
    for (int k = 0; k < 3; ++k) {
      EXPECT_LE(b.lo[k], lo[k]);
      EXPECT_GE(b.hi[k], hi[k]);
      EXPECT_NEAR(b.lo[k], lo[k], 1e-4);
      EXPECT_NEAR(b.hi[k], hi[k], 1e-4);
    }
  };
  const double r = std::sqrt(0.5);
  expect_box(*accel_of(CylinderShape{{0, 0, 0}, {3, 3, 0}, 1}), {-r, -r, -1}, {3 + r, 3 + r, 1});
  expect_box(*accel_of(CylinderShape{{0, 0, 0}, {0, 0, 2}, 1}, Affine::rotation({0, 0, 30})), {-1, -1, 0},
             {1, 1, 2});
  expect_box(*accel_of(ConeShape{{0, 0, 0}, {3, 3, 0}, 1, 0}), {-r, -r, -1}, {3, 3, 1});
  PolyhedronShape octahedron;
  for (int k = 0; k < 8; ++k)
    octahedron.planes.push_back({{k & 1 ? 1. : -1., k & 2 ? 1. : -1., k & 4 ? 1. : -1.}, 1});
  expect_box(*accel_of(octahedron), {-1, -1, -1}, {1, 1, 1});
  expect_box(*accel_of(octahedron, Affine::rotation({0, 45, 0})), {-r, -1, -r}, {r, 1, r});
  // A tilted ellipsoid: (x + y)^2 + (x - y)^2 / 4 + z^2 = 1 reaches sqrt(1/4 + 1) along x and y.
  expect_box(*accel_of(QuadricShape{{1.25, 1.25, 1, 1.5, 0, 0, 0, 0, 0, -1}}),
             {-std::sqrt(1.25), -std::sqrt(1.25), -1}, {std::sqrt(1.25), std::sqrt(1.25), 1});
  // A paraboloid in a box wider than it.
  expect_box(*accel_of(QuadricShape{{1, 1, 0, 0, 0, 0, 0, 0, -1, 0}, true, {-9, -9, -9}, {9, 9, 4}}),
             {-2, -2, 0}, {2, 2, 4});
}

/// Straight lines that lie in x^2 + y^2 - z^2 = 1 cross nothing; lines beside them cross faces of the box
/// only.
TEST(Quadric, LinesThatLieInAHyperboloid) {
  const auto accel = accel_of(QuadricShape{{1, 1, -1, 0, 0, 0, 0, 0, 0, -1}, true, {-4, -4, -2}, {4, 4, 2}});
  expect_crossings(*accel, {1, -5, -5}, {0, 1, 1}, {});
  expect_crossings(*accel, {kAbove1, -5, -5}, {0, 1, 1}, {});
  expect_crossings(*accel, {kBelow1, -5, -5}, {0, 1, 1}, {{3, 5, -1}, {7, 6, 1}});
  // Along an asymptote.
  expect_crossings(*accel, {-5, 0, -5}, {1, 0, 1}, {{3, 5, -1}, {7, 6, 1}});
  const auto whole = accel_of(QuadricShape{{1, 1, -1, 0, 0, 0, 0, 0, 0, -1}});
  EXPECT_EQ(stats(*whole).unbounded, 1u);
  expect_crossings(*whole, {-5, 0, -5}, {1, 0, 1}, {});
  expect_crossings(*whole, {-5, 0, 0}, {1, 0, 0}, {{4, 0, -1}, {6, 0, 1}});
  // Parallel to an asymptote there is one crossing: z^2 - (z + c)^2 = -1 at z = (1 - c^2) / (2 c).
  expect_crossings(*whole, {-4, 0, -5}, {1, 0, 1}, {{5, 0, 1}});
}

TEST(Quadric, LeadingCoefficientZero) {
  const auto whole = accel_of(QuadricShape{{1, 1, 0, 0, 0, 0, 0, 0, -1, 0}});
  expect_crossings(*whole, {0.5f, 0, -5}, {0, 0, 1}, {{5.25f, 0, -1}});
  expect_crossings(*whole, {0.5f, 0, 5}, {0, 0, -1}, {{4.75f, 0, 1}});
  const auto cut = accel_of(QuadricShape{{1, 1, 0, 0, 0, 0, 0, 0, -1, 0}, true, {-2, -2, -2}, {2, 2, 2}});
  expect_crossings(*cut, {0.5f, 0, -5}, {0, 0, 1}, {{5.25f, 0, -1}, {7, 6, 1}});
  // A half-space in a box is one, too.
  const auto half = accel_of(QuadricShape{{0, 0, 0, 0, 0, 0, 1, 0, 0, -0.25}, true});
  expect_crossings(*half, {-5, 0, 0}, {1, 0, 0}, {{4, 1, -1}, {5.25f, 0, 1}});
}

/// Where the function touches zero without a change of sign, nothing is crossed.
TEST(Quadric, DoublePlanesAreNotHit) {
  const auto accel = accel_of(QuadricShape{{1, 0, 0, 0, 0, 0, 0, 0, 0, 0}});
  expect_crossings(*accel, {-5, 0.5f, 0.25f}, {1, 0.1f, 0}, {});
}

TEST(ClosedForms, DegenerateShapesAreLeftOut) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const ExactForm forms[] = {
      CylinderShape{{0, 0, 0}, {0, 0, 0}},
      CylinderShape{{0, 0, 0}, {0, 1, 0}, 0},
      CylinderShape{{0, 0, 0}, {0, 1, 0}, nan},
      ConeShape{{0, 0, 0}, {0, 1, 0}, 0, 0},
      ConeShape{{0, 0, 0}, {0, 1, 0}, -1, 1},
      PolyhedronShape{},
      PolyhedronShape{{{{1, 0, 0}, 1}, {{-1, 0, 0}, 1}}},
      PolyhedronShape{{{{0, 0, 0}, 1}}},
      QuadricShape{{0, 0, 0, 0, 0, 0, 0, 0, 0, -1}},
      QuadricShape{{1, 1, 1, 0, 0, 0, 0, 0, 0, 1}},
      QuadricShape{{nan, 1, 1, 0, 0, 0, 0, 0, 0, -1}},
  };
  for (const ExactForm& form : forms) {
    const auto accel = accel_of(form);
    EXPECT_TRUE(bounds(*accel).empty());
    EXPECT_TRUE(crossings(*accel, {-5, 0.1f, 0.2f}, {1, 0, 0}).empty());
  }
}

}  // namespace
}  // namespace oktett::closed_forms_test
