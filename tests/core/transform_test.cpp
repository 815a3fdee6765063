#include "core/transform.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>

namespace oktett {
namespace {

double distance(const Vec3d& a, const Vec3d& b) { return length(a - b); }

TEST(Affine, RowsAreThoseOfTheMatrix) {
  double rows[12];
  for (int k = 0; k < 12; ++k) rows[k] = k + 0.5;
  const Affine a = Affine::from_rows(rows);
  EXPECT_EQ(a.vector({0, 1, 0}), (Vec3d{1.5, 5.5, 9.5}));
  EXPECT_EQ(a.point({0, 0, 0}), (Vec3d{3.5, 7.5, 11.5}));
  float back[12];
  a.to_rows(back);
  for (int k = 0; k < 12; ++k) EXPECT_EQ(back[k], static_cast<float>(rows[k]));
}

TEST(Affine, QuarterTurnsAreExact) {
  const Affine r = Affine::rotation({0, 0, 90});
  EXPECT_EQ(r.vector({1, 0, 0}), (Vec3d{0, 1, 0}));
  EXPECT_EQ(Affine::rotation({0, 0, 360}), Affine{});
  EXPECT_EQ(Affine::rotation({90, 0, 0}).vector({0, 1, 0}), (Vec3d{0, 0, 1}));
  EXPECT_EQ(Affine::rotation({0, 90, 0}).vector({0, 0, 1}), (Vec3d{1, 0, 0}));
}

TEST(Affine, RotationAboutAnAxisAgreesWithAngles) {
  for (double a : {-170.0, -33.0, 0.5, 90.0, 123.0}) {
    const Vec3d v{0.3, -2, 5};
    EXPECT_LT(distance(Affine::rotation({0, 3, 0}, a).vector(v), Affine::rotation({0, a, 0}).vector(v)),
              1e-14);
  }
}

TEST(Affine, InverseUndoes) {
  EXPECT_TRUE(rc::check([](int a, int b, int c, int x, int y, int z) {
    const Affine m = Affine::translation({x % 100 * 1.0, y % 100 * 1.0, z % 100 * 1.0}) *
                     Affine::rotation({a % 360 * 1.0, b % 360 * 1.0, c % 360 * 1.0}) *
                     Affine::scaling({1.5 + std::abs(a % 3), -0.5, 2});
    RC_ASSERT(m.is_invertible());
    RC_ASSERT(m.determinant() < 0);
    const Vec3d p{0.1, -0.7, 3};
    RC_ASSERT(distance(m.inverse().point(m.point(p)), p) < 1e-11);
  }));
}

TEST(Affine, NormalsStayPerpendicular) {
  const Affine m = Affine::rotation({20, 30, 40}) * Affine::scaling({1, 5, 0.2});
  const Vec3d n{1, 2, 3}, along{3, 0, -1};
  ASSERT_EQ(dot(n, along), 0);
  EXPECT_NEAR(dot(m.inverse().normal_by_inverse(n), m.vector(along)), 0, 1e-13);
}

TEST(Affine, TellsSingularMaps) {
  EXPECT_FALSE(Affine::scaling({1, 0, 1}).is_invertible());
  EXPECT_FALSE(Affine::scaling({0, 0, 0}).is_invertible());
  EXPECT_FALSE(Affine::translation({std::nan(""), 0, 0}).is_invertible());
  EXPECT_TRUE(Affine::scaling({1e-20, 1e20, 1}).is_invertible());
  Affine flat;
  flat.m = {{{1, 0, 1, 0}, {0, 1, 1, 0}, {1, 1, 2 + 0x1p-51, 0}}};
  EXPECT_FALSE(flat.is_invertible());
}

TEST(Affine, RecognisesSimilarities) {
  EXPECT_NEAR((Affine::rotation({10, 20, 30}) * Affine::scaling({3, 3, -3})).uniform_scale(), 3, 1e-12);
  EXPECT_EQ(Affine::scaling({3, 3, 3.001}).uniform_scale(), 0);
}

// Every image of a point of the box lies in the bounds of the image.
TEST(TransformBounds, ContainsTheImage) {
  EXPECT_TRUE(rc::check([](int a, int b, int c, unsigned corner) {
    const Affine m = Affine::translation({a * 0.1, 1e3, b * 1e-3}) *
                     Affine::rotation({a * 1.1, b * 2.3, c * 0.7}) *
                     Affine::scaling({1, 0.1 + std::abs(b % 7), 3});
    const Box box{{-1, 2, 1e-3f}, {0.5f, 2.5f, 7}};
    Vec3d p;
    for (int k = 0; k < 3; ++k) p[k] = corner >> k & 1 ? box.lo[k] : box.hi[k];
    const Vec3d q = m.point(p);
    const Box image = transform_bounds(m, box);
    for (int k = 0; k < 3; ++k) RC_ASSERT(image.lo[k] <= q[k] && q[k] <= image.hi[k]);
  }));
  EXPECT_TRUE(transform_bounds(Affine{}, Box{}).empty());
}

}  // namespace
}  // namespace oktett
