#include "kernels/exact/ovus.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "verify/cases/kernel_cases.h"

namespace oktett::ovus_test {
namespace {

using D = Simd<double, 1, ScalarIsa>;
using Real = long double;

/// Any form; pointed, nearly balls, and two equal radii.
OvusShape draw(CaseRandom& random) {
  const double a = random.magnitude(-1, 1), kind = random.unit();
  double ratio = 0.02 + 1.96 * random.unit();
  if (kind < 0.15) ratio = random.magnitude(-6, -1);
  if (kind > 0.75) ratio = 2 - random.magnitude(-6, -1);
  if (kind > 0.9) ratio = 1;
  return {a, a * ratio};
}

/// The profile by the angle of its normal from the bottom: the circles, and the angles at which they meet.
struct Profile {
  explicit Profile(const OvusShape& s) : a(s.bottom_radius), b(s.top_radius) {
    arc = 2 * std::max(a, b);
    // With the sides of the triangle of the three centres, by the law of cosines.
    const Real p = arc - a, q = arc - b, along = (p * p + a * a - q * q) / (2 * a);
    height = along, across = std::sqrt((p - along) * (p + along));
    low = std::atan2(across, along), high = std::atan2(across, along - a);
  }
  /// The radius and the height where the normal has an angle.
  std::pair<Real, Real> at(Real angle) const {
    const Real x = std::sin(angle), y = -std::cos(angle);
    if (angle < low) return {a * x, a * y};
    if (angle > high) return {b * x, a + b * y};
    return {arc * x - across, height + arc * y};
  }

  Real a, b, arc, height, across, low, high;
};

Ovus::Pool pool_of(const OvusShape& s) {
  Ovus::Pool pool;
  Ovus::add(pool, s, {});
  return pool;
}

Vec3d point(const Profile& profile, Real angle, double turn) {
  const auto [rho, y] = profile.at(angle);
  return {static_cast<double>(rho * std::sin(Real{turn})), static_cast<double>(y),
          static_cast<double>(rho * std::cos(Real{turn}))};
}
Vec3d normal(Real angle, double turn) {
  return {static_cast<double>(std::sin(angle) * std::sin(Real{turn})), static_cast<double>(-std::cos(angle)),
          static_cast<double>(std::sin(angle) * std::cos(Real{turn}))};
}

template <int K>
std::vector<double> crossings(const Ovus::Pool& pool, const Vec3d& o, const Vec3d& d, double from = -1e9) {
  const Line<D> line{broadcast<D>(pool.frames[0].to_own.point(o)),
                     broadcast<D>(pool.frames[0].to_own.vector(d))};
  Crossings<K, D> out;
  Ovus::crossings<K>(pool, pool.cells[0], line, {D(from), D(1e9), D(0.0), D(0.0)}, D(0.0) == D(0.0), out);
  std::vector<double> t;
  for (const D& x : out.t)
    if (const double at = only_lane(x); at < roots::kNoRoot) t.push_back(at);
  return t;
}

TEST(Ovus, PointsOfTheProfileAreOnIt) {
  CaseRandom random(1);
  for (int i = 0; i < 3000; ++i) {
    const OvusShape s = draw(random);
    const Ovus::Pool pool = pool_of(s);
    ASSERT_EQ(pool.elements.size(), 1u);
    const Profile profile(s);
    const double turn = 7 * random.unit();
    // Often where two circles meet.
    const double part = random.unit();
    const Real angle = part < 0.1   ? profile.low
                       : part < 0.2 ? profile.high
                                    : std::numbers::pi_v<Real> * Real{random.unit()};
    const Vec3d p = pool.frames[0].to_own.point(point(profile, angle, turn));
    const Slope slope = slope_at<Ovus>(pool, 0, 0, p);
    EXPECT_LT(std::abs(slope.value), 1e-14);
    const Vec3d n = pool.frames[0].to_own.normal_by_inverse(slope.gradient);
    EXPECT_LT(length(normalize(n) - normal(angle, turn)), 1e-6);
    for (int k = 0; k < 3; ++k) {
      EXPECT_GE(p[k], pool.cells[0].lo[k] - 1e-14);
      EXPECT_LE(p[k], pool.cells[0].hi[k] + 1e-14);
    }
  }
}

// A line through two points of the surface meets it there and nowhere else.
TEST(Ovus, AreMetInTwoPoints) {
  CaseRandom random(2);
  for (int i = 0; i < 20000; ++i) {
    const OvusShape s = draw(random);
    const Ovus::Pool pool = pool_of(s);
    const Profile profile(s);
    const auto anywhere = [&] {
      return point(profile, std::numbers::pi_v<Real> * Real{random.unit()}, 7 * random.unit());
    };
    const Vec3d p = anywhere(), q = anywhere(), d = q - p;
    const double size = s.bottom_radius + s.top_radius;
    if (length(d) < 1e-3 * size) continue;
    const std::vector<double> t = crossings<2>(pool, p - d, d);
    ASSERT_EQ(t.size(), 2u) << i;
    EXPECT_NEAR(t[0], 1, 1e-9 * size / length(d)) << i;
    EXPECT_NEAR(t[1], 2, 1e-9 * size / length(d)) << i;
    // Where the ray begins between them, the second one is the first that counts.
    EXPECT_EQ(crossings<1>(pool, p - d, d), std::vector<double>{t[0]});
    EXPECT_EQ(crossings<1>(pool, p - d, d, 1.5), std::vector<double>{t[1]});
    EXPECT_EQ(crossings<2>(pool, p - d, d, 1.5), std::vector<double>{t[1]});
  }
}

// A tangent that is moved in by little is met twice, one that is moved out is not, also at the seams.
TEST(Ovus, TangentsDecide) {
  CaseRandom random(3);
  for (int i = 0; i < 20000; ++i) {
    const OvusShape s = draw(random);
    const Ovus::Pool pool = pool_of(s);
    const Profile profile(s);
    const double part = random.unit(), turn = 7 * random.unit();
    Real angle = std::numbers::pi_v<Real> * Real{random.unit()};
    if (part < 0.3) angle = profile.low + 1e-9L * Real{random.sign()};
    if (part > 0.7) angle = profile.high + 1e-9L * Real{random.sign()};
    const Vec3d n = normal(angle, turn), way = normalize(cross(n, random.vector()));
    const double size = s.bottom_radius + s.top_radius;
    const Vec3d p = point(profile, angle, turn), o = p - way * (3 * size);
    EXPECT_EQ(crossings<2>(pool, o - n * (1e-13 * size), way).size(), 2u) << i;
    EXPECT_EQ(crossings<2>(pool, o + n * (1e-13 * size), way).size(), 0u) << i;
  }
}

// Rays in the planes of the seams, and through every point of a seam, meet it.
TEST(Ovus, SeamsHaveNoGaps) {
  CaseRandom random(4);
  for (int i = 0; i < 3000; ++i) {
    const OvusShape s = draw(random);
    const Ovus::Pool pool = pool_of(s);
    const OvusElement& e = pool.elements[0];
    for (const OvusElement::Cap& cap : {e.bottom, e.top}) {
      // Caps that are flatter than the rays are apart.
      if (std::abs(cap.end - cap.center) > cap.radius - 1e-10) continue;
      const double rim = std::sqrt(cap.rim2), turn = 7 * random.unit();
      const Vec3d on{rim * std::cos(turn), rim * std::sin(turn), cap.end};
      const auto in_shape = [&](const Vec3d& p) { return pool.frames[0].to_world.point(p); };
      for (const double lift : {0.0, 1e-17, -1e-17, 1e-16, -1e-16, 1e-12, -1e-12}) {
        const Vec3d level{0, 0, lift * random.unit()};
        const Vec3d o = in_shape(on * Vec3d{3, 3, 1} + level), at = in_shape(Vec3d{0, 0, cap.end} + level);
        EXPECT_EQ(crossings<2>(pool, o, at - o).size(), 2u) << i;
      }
      // From all around to a point of the seam, and on through the egg.
      const Vec3d inside = in_shape({0, 0, 0.5 * (e.bottom.center + e.top.center)}), seam = in_shape(on);
      const Vec3d d = inside + (seam - inside) * 1e-3 * random.sign() - seam;
      const std::vector<double> t = crossings<2>(pool, seam - d, d);
      ASSERT_EQ(t.size(), 2u) << i;
      EXPECT_NEAR(t[0], 1, 1e-9);
    }
  }
}

// Also along the axis, and beside it by less than the last digit.
TEST(Ovus, AxesAreMet) {
  CaseRandom random(5);
  for (int i = 0; i < 1000; ++i) {
    const OvusShape s = draw(random);
    const Ovus::Pool pool = pool_of(s);
    const double top = s.bottom_radius + s.top_radius;
    for (const double beside : {0.0, 1e-300, 1e-20, 1e-16}) {
      const Vec3d o{beside * s.top_radius, 3 * top, -beside * s.top_radius};
      const std::vector<double> t = crossings<2>(pool, o, {0, -1, 0});
      ASSERT_EQ(t.size(), 2u);
      EXPECT_NEAR(t[0], 2 * top, 1e-13 * top);
      EXPECT_NEAR(t[1], 3 * top + s.bottom_radius, 1e-13 * top);
    }
  }
}

// Bounds in the world touch the surface on all sides.
TEST(Ovus, BoundsAreTight) {
  CaseRandom random(6);
  for (int i = 0; i < 10; ++i) {
    const OvusShape s = draw(random);
    const Affine m = Affine::translation(random.vector()) * Affine::rotation(random.vector() * 180.0) *
                     Affine::scaling({1, 0.3 + random.unit(), 2});
    Ovus::Pool pool;
    Ovus::add(pool, s, {m});
    const Box box = Ovus::world_bounds(pool, 0);
    const Profile profile(s);
    const double size = s.bottom_radius + s.top_radius;
    Vec3d lo{1e9, 1e9, 1e9}, hi = -lo;
    for (int j = 0; j <= 200; ++j)
      for (int k = 0; k < 200; ++k) {
        const Vec3d p =
            m.point(point(profile, std::numbers::pi_v<Real> * j / 200, 2 * std::numbers::pi * k / 200.0));
        lo = min(lo, p), hi = max(hi, p);
      }
    for (int k = 0; k < 3; ++k) {
      EXPECT_LE(box.lo[k], lo[k]);
      EXPECT_GE(box.hi[k], hi[k]);
      EXPECT_NEAR(box.lo[k], lo[k], 5e-4 * size);
      EXPECT_NEAR(box.hi[k], hi[k], 5e-4 * size);
    }
  }
}

// v is the length along the profile, u the turn from +z towards +x.
TEST(Ovus, UvRunAlongTheProfile) {
  CaseRandom random(7);
  for (int i = 0; i < 50; ++i) {
    const OvusShape s{1, 0.05 + 1.9 * random.unit()};
    const Ovus::Pool pool = pool_of(s);
    const Profile profile(s);
    constexpr int kSteps = 4000;
    std::vector<double> lengths{0};
    for (int k = 1; k <= kSteps; ++k) {
      const auto p = profile.at(std::numbers::pi_v<Real> * (k - 1) / kSteps),
                 q = profile.at(std::numbers::pi_v<Real> * k / kSteps);
      lengths.push_back(lengths.back() +
                        static_cast<double>(std::hypot(q.first - p.first, q.second - p.second)));
    }
    for (int k = 1; k < 20; ++k) {
      const double turn = 6 * random.unit() - 3;
      const Vec3d p = point(profile, std::numbers::pi_v<Real> * k / 20, turn);
      const SurfaceUv uv = Ovus::uv(pool, 0, 0, pool.frames[0].to_own.point(p));
      EXPECT_NEAR(uv.u.value, 0.5 + turn * 0.5 / std::numbers::pi, 1e-12);
      EXPECT_NEAR(uv.v.value, lengths[kSteps / 20 * static_cast<std::size_t>(k)] / lengths.back(), 1e-6);
    }
  }
}

TEST(Ovus, DegenerateOnesAreLeftOut) {
  for (const OvusShape& s : {OvusShape{0, 1}, OvusShape{1, 0}, OvusShape{1, 2}, OvusShape{1, 3},
                             OvusShape{-1, 0.5}, OvusShape{1, -0.5}, OvusShape{HUGE_VAL, 1}})
    EXPECT_TRUE(pool_of(s).elements.empty());
}

}  // namespace
}  // namespace oktett::ovus_test
