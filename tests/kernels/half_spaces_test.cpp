#include "kernels/exact/polyhedron.h"

#include <gtest/gtest.h>

#include <cmath>

#include "kernels/exact/quadratic.h"

namespace oktett::half_spaces_test {
namespace {

using Kind = ConvexSolid::Kind;

std::vector<HalfSpace> cube(double size, const Vec3d& center = {0, 0, 0}) {
  std::vector<HalfSpace> planes;
  for (int k = 0; k < 6; ++k) {
    Vec3d n{0, 0, 0};
    n[k / 2] = k % 2 == 0 ? 3 : -0.5;
    planes.push_back({n, dot(n, center) + length(n) * size});
  }
  return planes;
}

TEST(HalfSpaces, FindTheCornersOfACube) {
  for (const double size : {1e-12, 1.0, 1e12}) {
    const Vec3d center = Vec3d{3, -5, 7} * size;
    const ConvexSolid solid = intersect(cube(size, center));
    ASSERT_EQ(solid.kind, Kind::solid);
    EXPECT_EQ(solid.faces.size(), 6u);
    EXPECT_EQ(solid.vertices.size(), 24u) << "each corner once per face";
    for (const Vec3d& v : solid.vertices)
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(std::abs(v[k] - center[k]), size, 0x1p-40 * size);
  }
}

TEST(HalfSpaces, LeaveOutWhatDoesNotBound) {
  std::vector<HalfSpace> planes = cube(1);
  planes.insert(planes.begin(), {{1, 1, 1}, 100});
  planes.push_back({{1, 2, 0}, 100});
  const ConvexSolid solid = intersect(planes);
  EXPECT_EQ(solid.faces, (std::vector<std::uint32_t>{1, 2, 3, 4, 5, 6}));
}

TEST(HalfSpaces, ManyPlanesMakeABall) {
  std::vector<HalfSpace> planes;
  for (std::size_t i = 0; i < kMaxHalfSpaces; ++i) {
    const double z = 1 - (2 * static_cast<double>(i) + 1) / kMaxHalfSpaces,
                 a = 2.399963 * static_cast<double>(i);
    const double r = std::sqrt(1 - z * z);
    planes.push_back({{r * std::cos(a), r * std::sin(a), z}, 1});
  }
  const ConvexSolid solid = intersect(planes);
  ASSERT_EQ(solid.kind, Kind::solid);
  EXPECT_EQ(solid.faces.size(), kMaxHalfSpaces);
  for (const Vec3d& v : solid.vertices) {
    EXPECT_GT(length(v), 1);
    EXPECT_LT(length(v), 1.01);
  }
}

TEST(HalfSpaces, KnowWhatIsNotBounded) {
  EXPECT_EQ(intersect({}).kind, Kind::unbounded);
  for (int left_out = 0; left_out < 6; ++left_out) {
    std::vector<HalfSpace> planes = cube(1);
    planes.erase(planes.begin() + left_out);
    EXPECT_EQ(intersect(planes).kind, Kind::unbounded) << left_out;
  }
  // A prism without ends whose sides are parallel only as well as doubles can say.
  std::vector<HalfSpace> prism;
  for (int i = 0; i < 7; ++i) {
    const double a = 0.9 * i;
    const Vec3d u{0.48, 0.6, 0.64}, v{0.8, -0.6, 0};
    prism.push_back({u * std::cos(a) + v * std::sin(a), 1});
  }
  EXPECT_EQ(intersect(prism).kind, Kind::unbounded);
  // A wedge: three planes through a line and two ends of four.
  EXPECT_EQ(
      intersect(std::vector<HalfSpace>{{{1, 0, 0}, 1}, {{-1, 1, 0}, 1}, {{0, 0, 1}, 1}, {{0, 0, -1}, 1}})
          .kind,
      Kind::unbounded);
}

TEST(HalfSpaces, KnowWhatIsEmpty) {
  std::vector<HalfSpace> planes = cube(1);
  planes.push_back({{1, 1, 1}, -3.001});
  EXPECT_EQ(intersect(planes).kind, Kind::empty);
  planes.back().offset = -3;
  EXPECT_EQ(intersect(planes).kind, Kind::empty) << "only a corner";
  planes.back().offset = -2.9;
  EXPECT_EQ(intersect(planes).kind, Kind::solid);
  EXPECT_EQ(intersect(cube(0)).kind, Kind::empty);
  planes = cube(1);
  planes[0].offset = -3, planes[1].offset = 0.5;
  EXPECT_EQ(intersect(planes).kind, Kind::empty) << "flat";
}

/// Long needles and thin plates are solids; slivers beyond the stated bounds are not.
TEST(HalfSpaces, NeedlesAndPlates) {
  std::vector<HalfSpace> planes = cube(1);
  planes[0].offset = 3e6, planes[1].offset = 0.5e6;
  EXPECT_EQ(intersect(planes).kind, Kind::solid);
  planes = cube(1);
  planes[0].offset = 3e-9, planes[1].offset = 0.5e-9;
  EXPECT_EQ(intersect(planes).kind, Kind::solid);
  planes[0].offset = 3e-14, planes[1].offset = 0.5e-14;
  EXPECT_EQ(intersect(planes).kind, Kind::empty);
}

/// Whole numbers, the same in every run.
struct CaseNumbers {
  std::uint64_t state = 1;
  std::int64_t whole(std::int64_t below) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return static_cast<std::int64_t>(state >> 33) % below;
  }
};

/// Compared with exact integers where the terms cancel completely or almost completely.
TEST(Quadratic, DiscriminantsHaveTheRightSign) {
  __extension__ typedef __int128 Wide;
  CaseNumbers random;
  int zeros = 0, cancelled = 0;
  const auto sign = [](Wide x) { return (x > 0) - (x < 0); };
  const auto sign_of = [](double x) { return (x > 0) - (x < 0); };
  for (int i = 0; i < 100000; ++i) {
    // o x d = l for o = (-n, m), d = (m, n) l with l = m^2 + n^2 and |d| = l sqrt(l); o moved along d and off
    // the line by a little or nothing, in units that make the distance 1.
    const std::int64_t m = random.whole(300), n = random.whole(300), k = random.whole(5) - 2;
    const std::int64_t l = m * m + n * n, along = random.whole(1000) - 500;
    const std::int64_t ox = -n + along * m + k, oy = m + along * n, dx = m * l, dy = n * l;
    double out[1];
    circle_discriminant({double(ox), double(oy), double(dx), double(dy)}, out);
    const Wide c = Wide{ox} * dy - Wide{oy} * dx, exact = Wide{dx} * dx + Wide{dy} * dy - c * c;
    ASSERT_EQ(sign_of(out[0]), sign(exact)) << ox << ", " << oy << "; " << dx << ", " << dy;
    // The same numbers as a point and a direction against x^2 + y^2 = w^2.
    const std::int64_t pw = random.whole(2000) - 1000, dw = random.whole(2000) - 1000;
    cone_discriminant({double(ox), double(oy), double(pw), double(dx), double(dy), double(dw)}, out);
    const Wide xw = Wide{ox} * dw - Wide{pw} * dx, yw = Wide{oy} * dw - Wide{pw} * dy;
    ASSERT_EQ(sign_of(out[0]), sign(xw * xw + yw * yw - c * c));
    // And where that is tangent: (3, 4, 5) moved along (-4, 3, 0) has (x, y)^2 = w^2 at one point.
    const std::int64_t s = random.whole(100000) + 1;
    cone_discriminant({3.0 - 4 * along, 4.0 + 3 * along, 5, -4.0 * s, 3.0 * s, 0}, out);
    ASSERT_EQ(out[0], 0);
    zeros += exact == 0, cancelled += exact != 0 && std::abs(double(exact)) < 1e-6 * double(c * c);
  }
  EXPECT_GT(cancelled + zeros, 0);
}

}  // namespace
}  // namespace oktett::half_spaces_test
