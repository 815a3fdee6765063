#include "core/noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/noise_places.h"
#include "verify/oracles/exact_noise.h"

namespace oktett::noise_test {
namespace {

double unit(std::mt19937& random) { return (random() + 0.5) / 4294967296.0; }

/// A place near the origin, far away, or on a border of a cell.
double coordinate(std::mt19937& random) {
  const double x = 8 * unit(random) - 4;
  switch (random() % 4) {
    case 0:
      return std::round(x);
    case 1:
      return x * 0x1p20;
    default:
      return x;
  }
}

TEST(Noise, SeveralPlacesHaveTheSameBitsInAllSets) {
  const double inf = std::numeric_limits<double>::infinity();
  std::vector<Vec3d> places = {{0, 0, 0},          {-0.0, 1, -1},           {1e18, 0.5, 0},
                               {-3, -7.5, 0x1p51}, {0x1.8p50, 0, 0.3},      {-1e-300, 5e-324, -0.25},
                               {0.5, inf, 0.5},    {std::nan(""), 0.5, 0.5}};
  std::mt19937 random(2);
  while (places.size() < 20000)
    places.push_back({coordinate(random), coordinate(random), coordinate(random)});
  for (const Isa isa : available_isas()) {
    SCOPED_TRACE(to_string(isa));
    const NoiseAtPlaces code = noise_at_places(isa);
    // Of all lengths, so that the last ones are not as many as are taken at once.
    for (std::size_t begin = 0, count = 0; begin < places.size(); begin += count) {
      count = std::min<std::size_t>(1 + random() % 20, places.size() - begin);
      std::vector<double> values(count, 7);
      code(&places[begin], count, values.data());
      for (std::size_t i = 0; i < count; ++i)
        ASSERT_EQ(std::bit_cast<std::uint64_t>(values[i]),
                  std::bit_cast<std::uint64_t>(gradient_noise(places[begin + i])))
            << begin + i;
    }
  }
}

constexpr NoiseKind kKinds[] = {NoiseKind::gradient, NoiseKind::povray};

TEST(Noise, ValuesAndDerivatives) {
  std::mt19937 random(1);
  for (int i = 0; i < 40000; ++i) {
    const NoiseKind kind = kKinds[i % 2];
    const Vec3d p{coordinate(random), coordinate(random), coordinate(random)};
    const NoiseSlope s = noise_slope(p, kind);
    EXPECT_EQ(s.value, noise_value(p, kind));
    if (kind == NoiseKind::gradient) {
      EXPECT_EQ(s.value, gradient_noise(p));
    }
    EXPECT_NEAR(s.value, static_cast<double>(exact_noise({p.x, p.y, p.z}, kind)), kNoiseError);
    for (int k = 0; k < 3; ++k) {
      const long double h = 0x1p-20L;
      Vec3<long double> a{p.x, p.y, p.z}, b = a;
      a[k] -= h, b[k] += h;
      const long double slope = (exact_noise(b, kind) - exact_noise(a, kind)) / (2 * h);
      // Differences are off by a sixth of the third derivative times h^2, which is 60 times 2 at most; where
      // the second derivative jumps, by h times what it jumps by, at most 60, over 4.
      const bool jumps = kind == NoiseKind::povray && std::abs(p[k] - std::round(p[k])) < 0x1p-19;
      EXPECT_NEAR(s.gradient[k], static_cast<double>(slope), jumps ? 0x1p-16 : 0x1p-34)
          << p.x << " " << p.y << " " << p.z;
    }
  }
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()})
    for (const NoiseKind kind : kKinds) EXPECT_TRUE(std::isnan(noise_value({0.5, bad, 0.5}, kind)));
}

/// Dense samples lie in the enclosures, and these are not much wider than the samples.
TEST(Noise, EnclosuresHoldSamples) {
  std::mt19937 random(2);
  double wide = 0, needed = 0;
  for (int i = 0; i < 1800; ++i) {
    const NoiseKind kind = kKinds[i / 3 % 2];
    const double size = i % 3 == 0 ? 1.5 : i % 3 == 1 ? 0.25 : 0x1p-10;
    Vec3d lo, hi;
    for (int k = 0; k < 3; ++k)
      lo[k] = coordinate(random), hi[k] = lo[k] + (random() % 8 ? size * unit(random) : 0);
    const NoiseRange r = noise_range(lo, hi, kind);
    long double least = 2, most = -2;
    constexpr int kSide = 6;
    for (int n = 0; n < kSide * kSide * kSide; ++n) {
      const int step[3] = {n % kSide, n / kSide % kSide, n / kSide / kSide};
      Vec3<long double> p;
      for (int k = 0; k < 3; ++k)
        p[k] = lo[k] + (static_cast<long double>(hi[k]) - lo[k]) * step[k] / (kSide - 1);
      const long double value = exact_noise(p, kind);
      least = std::min(least, value), most = std::max(most, value);
      ASSERT_LE(r.lo, value);
      ASSERT_GE(r.hi, value);
      for (int k = 0; k < 3; ++k) {
        const long double h = 0x1p-20L;
        Vec3<long double> a = p, b = p;
        a[k] -= h, b[k] += h;
        const long double slope = (exact_noise(b, kind) - exact_noise(a, kind)) / (2 * h);
        const long double off = kind == NoiseKind::povray ? 0x1p-15L : 0x1p-34L;
        ASSERT_LE(r.slope_lo[k], slope + off);
        ASSERT_GE(r.slope_hi[k], slope - off);
      }
    }
    if (i % 3 == 1) wide += r.hi - r.lo, needed += static_cast<double>(most - least);
  }
  EXPECT_LT(wide, 3 * needed);
}

TEST(Noise, LargeAndFarBoxesHaveTheGreatestBounds) {
  for (const NoiseKind kind : kKinds) {
    const NoiseBounds most = bounds_of(kind);
    for (const NoiseRange& r :
         {noise_range({0, 0, 0}, {9, 1, 1}, kind), noise_range({-1e300, 0, 0}, {-1e300, 0, 0}, kind),
          noise_range({0, 0, 0}, {1, std::numeric_limits<double>::infinity(), 1}, kind)}) {
      EXPECT_EQ(r.lo, -most.value);
      EXPECT_EQ(r.hi, most.value);
      EXPECT_EQ(r.slope_hi, (Vec3d{most.slope, most.slope, most.slope}));
    }
  }
  // A side of exactly two cells needs no third one.
  EXPECT_LT(noise_range({3, 0.5, 0.5}, {5, 0.5, 0.5}).hi, 1);
}

struct Span {
  double lo, hi;
};
Span operator*(const Span& a, const Span& b) {
  const double p[4] = {a.lo * b.lo, a.lo * b.hi, a.hi * b.lo, a.hi * b.hi};
  return {*std::min_element(p, p + 4), *std::max_element(p, p + 4)};
}
Span operator+(const Span& a, const Span& b) { return {a.lo + b.lo, a.hi + b.hi}; }
double most(const Span& a) { return std::max(std::abs(a.lo), std::abs(a.hi)); }

/// The weight of a corner along one axis, and its first and second derivatives, over a range of places.
void weights(NoiseKind kind, int side, double lo, double hi, Span (&w)[3]) {
  const bool cubic = kind == NoiseKind::povray;
  const auto fade = [&](double t) {
    return cubic ? t * t * (3 - 2 * t) : t * t * t * (t * (t * 6 - 15) + 10);
  };
  const auto slope = [&](double t) { return cubic ? 6 * t * (1 - t) : 30 * t * t * (t - 1) * (t - 1); };
  const auto bend = [&](double t) { return cubic ? 6 - 12 * t : 60 * t * (2 * t - 1) * (t - 1); };
  // The slope has its greatest value at 1/2, the second derivative at (3 -+ sqrt(3)) / 6.
  const auto over = [&](const auto& f, std::initializer_list<double> extremes) {
    Span s{std::min(f(lo), f(hi)), std::max(f(lo), f(hi))};
    for (const double t : extremes)
      if (lo < t && t < hi) s = {std::min(s.lo, f(t)), std::max(s.hi, f(t))};
    return s;
  };
  const double at = std::sqrt(3.0) / 6;
  w[0] = over(fade, {}), w[1] = over(slope, {0.5}), w[2] = over(bend, {0.5 - at, 0.5 + at});
  if (side == 0) w[0] = {1 - w[0].hi, 1 - w[0].lo}, w[1] = {-w[1].hi, -w[1].lo}, w[2] = {-w[2].hi, -w[2].lo};
}

/// Bounds on the noise and its derivatives in a box of a cell, for the worst of all vectors: of those of a
/// corner the product's two greatest components count; of POV-Ray's all three, and a value of up to 1/2.
void bound(NoiseKind kind, const Vec3d& lo, const Vec3d& hi, double (&sum)[4]) {
  std::fill(sum, sum + 4, 0.0);
  const Span none{0, 0}, two{2, 2};
  for (int corner = 0; corner < 8; ++corner) {
    Span w[3][3], way[3];
    for (int k = 0; k < 3; ++k) {
      const int side = corner >> k & 1;
      weights(kind, side, lo[k], hi[k], w[k]);
      way[k] = {lo[k] - side, hi[k] - side};
    }
    const auto weight = [&](int x, int y) { return w[0][x] * w[1][y] * w[2][0]; };
    const Span at = weight(0, 0), by_x = weight(1, 0), by_y = weight(0, 1), by_xx = weight(2, 0),
               by_xy = weight(1, 1);
    double component[4][3];
    for (int k = 0; k < 3; ++k) {
      component[0][k] = most(at * way[k]);
      component[1][k] = most(by_x * way[k] + (k == 0 ? at : none));
      component[2][k] = most(by_xx * way[k] + (k == 0 ? two * by_x : none));
      component[3][k] = most(by_xy * way[k] + (k == 0 ? by_y : k == 1 ? by_x : none));
    }
    for (int i = 0; i < 4; ++i) {
      std::sort(component[i], component[i] + 3);
      sum[i] += component[i][1] + component[i][2];
      if (kind == NoiseKind::povray) sum[i] += component[i][0];
    }
    if (kind == NoiseKind::povray) {
      const Span* const of[4] = {&at, &by_x, &by_xx, &by_xy};
      for (int i = 0; i < 4; ++i) sum[i] += 0.5 * most(*of[i]);
    }
  }
}

/// Whether all places in the box keep the bounds; boxes are halved along all axes where that is not seen.
bool keeps(NoiseKind kind, const Vec3d& lo, const Vec3d& hi, int depth) {
  double sum[4];
  bound(kind, lo, hi, sum);
  constexpr double kSlack = 1e-9;
  const NoiseBounds most = bounds_of(kind);
  if (sum[0] < most.value - kSlack && sum[1] < most.slope - kSlack && sum[2] < most.bend - kSlack &&
      sum[3] < most.twist - kSlack)
    return true;
  if (depth == 0) return false;
  for (int part = 0; part < 8; ++part) {
    Vec3d from = lo, to = hi;
    for (int k = 0; k < 3; ++k) {
      const double middle = 0.5 * (lo[k] + hi[k]);
      (part >> k & 1 ? from : to)[k] = middle;
    }
    if (!keeps(kind, from, to, depth - 1)) return false;
  }
  return true;
}

TEST(Noise, GreatestBoundsHold) {
  for (const NoiseKind kind : kKinds) EXPECT_TRUE(keeps(kind, {0, 0, 0}, {1, 1, 1}, 14));
  double middle[4];
  bound(NoiseKind::gradient, {0.5, 0.5, 0.5}, {0.5, 0.5, 0.5}, middle);
  EXPECT_NEAR(middle[0], 1, 1e-12);
  EXPECT_NEAR(middle[1], 3.75, 1e-12);
}

}  // namespace
}  // namespace oktett::noise_test
