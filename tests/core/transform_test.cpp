#include "core/transform.h"

#include <gmp.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>

#include "tests/support/dice.h"

namespace oktett::transform_test {
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

/// The product of two maps in rational numbers, less the identity: the greatest entry of each row, relative
/// to that of the row of `a`.
double distance_from_inverse(const Affine& a, const Affine& b) {
  mpq_t sum, x, y;
  mpq_inits(sum, x, y, nullptr);
  double worst = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      mpq_set_si(sum, i == j ? -1 : 0, 1);
      double size = 0;
      for (int k = 0; k < 3; ++k) {
        mpq_set_d(x, a.m[i][k]), mpq_set_d(y, b.m[k][j]);
        mpq_mul(x, x, y), mpq_add(sum, sum, x);
        size += std::abs(a.m[i][k] * b.m[k][j]);
      }
      worst = std::max(worst, std::abs(mpq_get_d(sum)) / size);
    }
  mpq_clears(sum, x, y, nullptr);
  return worst;
}

/// A map that turns, flattens and turns again has an inverse whose cofactors cancel.
TEST(Affine, InvertsFlatMaps) {
  Dice<double> dice(1);
  int inverted = 0;
  for (int i = 0; i < 20000; ++i) {
    const double flat = std::ldexp(1.0, -dice.below(41));
    const Affine m = Affine::rotation(dice.vec(180)) * Affine::scaling({1, flat, 1}) *
                     Affine::rotation(dice.vec(180)) * Affine::scaling({1, 1, dice.range(0.5, 2)});
    if (!m.is_invertible()) continue;
    ++inverted;
    EXPECT_LT(distance_from_inverse(m.inverse(), m), 0x1p-46) << "flat by " << flat;
    const Vec3d p = dice.vec(3);
    const Affine moved = Affine::translation(p) * m;
    const Vec3d there = m.inverse().vector(p), shift = moved.inverse().point({0, 0, 0});
    EXPECT_LT(distance(there, -shift), 0x1p-46 / flat);
  }
  EXPECT_GT(inverted, 18000);
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
}  // namespace oktett::transform_test
