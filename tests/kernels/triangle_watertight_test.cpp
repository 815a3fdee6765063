#include "kernels/triangle/triangle_watertight.h"

#include <gtest/gtest.h>

#include <cmath>

#include "accel/traverse/leaf.h"
#include "tests/support/limits.h"
#include "tests/support/triangle_cases.h"

namespace oktett::triangle_watertight_test {
namespace {

constexpr int kLanes = 4;
using F = Simd<float, kLanes, ScalarIsa>;
using D = Simd<double, kLanes, ScalarIsa>;
using State = RayState<kLanes, ScalarIsa>;

struct Decision {
  bool valid, hit;
  HitLanes<F> lanes;
  State state;
  TriangleLanes<F> triangle;
};

Decision decide(const TriangleCase& c) {
  Decision r;
  r.valid = r.state.set(broadcast<F>(c.ray.origin), broadcast<F>(c.ray.direction), F(c.ray.tmin),
                        F(c.ray.tmax), Box{}) != 0;
  const int z = r.state.z_axis_of(0);
  r.triangle = {broadcast<F>(c.corner[0]), broadcast<F>(c.corner[1]), broadcast<F>(c.corner[2])};
  const TriangleLanes<F> permuted{permute_to_z(r.triangle.a, z), permute_to_z(r.triangle.b, z),
                                  permute_to_z(r.triangle.c, z)};
  r.hit = r.valid &&
          any(decide_watertight(load_shear(r.state, z), permuted, F(c.ray.tmin), F(c.ray.tmax), r.lanes));
  return r;
}

float first_lane(const F& lanes) {
  float v[kLanes];
  lanes.store(v);
  return v[0];
}

class FilterScale : public testing::TestWithParam<float> {};

// The filter keeps whatever the decision accepts, also with the range of the ray ending exactly at the hit.
TEST_P(FilterScale, NeverRejectsWhatTheDecisionAccepts) {
  TriangleRandom random(static_cast<std::uint64_t>(std::ilogb(GetParam()) + 1000));
  int accepted = 0;
  for (int i = 0; i < 60000; ++i) {
    const TriangleCase c = adversarial_case(random, GetParam());
    const Decision d = decide(c);
    if (!d.hit) continue;
    ++accepted;
    const FilterTriangle<F> tri = filter_triangle(d.triangle);
    const F d_max = F::load(d.state.d_max);
    for (const float tmax : {kInf, first_lane(d.lanes.t)}) {
      const RayLanes<F> ray{broadcast<F>(c.ray.origin), broadcast<F>(c.ray.direction), F(0.0f), F(tmax)};
      ASSERT_EQ(bits(filter_watertight(ray, d_max, tri)), 15u) << "case " << i << " tmax " << tmax;
      ASSERT_EQ(bits(filter_watertight(ray.d, ray.tmax, origin_triangle(tri, ray.o, d_max))), 15u)
          << "case " << i << " tmax " << tmax;
    }
  }
  EXPECT_GT(accepted, 6000);
}

INSTANTIATE_TEST_SUITE_P(Scales, FilterScale,
                         testing::Values(1.0f, 1e-12f, 1e-15f, 1e-18f, 1e-20f, 1e-21f, 1e-22f, 1e-25f, 1e-30f,
                                         1e6f, 1e12f, 1e15f, 1e18f, 1e19f, 1e20f, 1e25f, 1e30f));

// A triangle far smaller than its distance keeps its hits.
TEST(Filter, KeepsTinyTrianglesFarAway) {
  TriangleRandom random(7);
  int accepted = 0;
  for (int i = 0; i < 100000; ++i) {
    TriangleCase c = adversarial_case(random, std::exp2(-20 - 30 * random.unit()));
    c.ray.origin = random.vector();
    c.ray.direction = c.corner[0] - c.ray.origin;
    const Decision d = decide(c);
    if (!d.hit) continue;
    ++accepted;
    const RayLanes<F> ray{broadcast<F>(c.ray.origin), broadcast<F>(c.ray.direction), F(0.0f), F(kInf)};
    ASSERT_NE(bits(filter_watertight(ray, F::load(d.state.d_max), filter_triangle(d.triangle))), 0u) << i;
  }
  EXPECT_GT(accepted, 100);
}

#if defined(__SIZEOF_FLOAT128__)
__extension__ typedef __float128 Quad;
#else
using Quad = long double;
#endif

// The sign of an edge function is exact: products of doubles fit into 113 bits.
TEST(EdgeFunction, SignIsExact) {
  TriangleRandom random(3);
  const auto number = [&] {
    const double m = static_cast<double>(static_cast<std::int64_t>(random.bits()) >> 11);
    return std::ldexp(m, static_cast<int>(random.bits() % 8) - 52);
  };
  for (int i = 0; i < 200000; ++i) {
    const double px = number(), py = number(), k = number();
    // q is nearly parallel to p, so that the products nearly or exactly cancel.
    double qx = px * k, qy = py * k;
    if (i % 3 == 0) qx = px * 3, qy = py * 3;
    if (i % 3 == 1) qx = std::nextafter(qx, 1e9);
    const auto e = edge_function(D(px), D(py), D(qx), D(qy));
    const auto flipped = edge_function(D(qx), D(qy), D(px), D(py));
    const Quad m = Quad(px) * Quad(qy), n = Quad(py) * Quad(qx);
    if (m > n) {
      ASSERT_EQ(bits(e.positive), 15u) << i;
    }
    if (m < n) {
      ASSERT_EQ(bits(e.negative), 15u) << i;
    }
    ASSERT_EQ(bits(e.positive), bits(flipped.negative)) << i;
    ASSERT_EQ(bits(e.negative), bits(flipped.positive)) << i;
    ASSERT_EQ(bits(e.positive & e.negative), 0u) << i;
    double value[kLanes], opposite[kLanes];
    e.value.store(value), flipped.value.store(opposite);
    ASSERT_EQ(value[0], -opposite[0]) << i;
  }
}

// Only an edge from a point to itself owns neither side.
TEST(EdgeFunction, TieRuleChoosesExactlyOneSide) {
  for (int x = -2; x <= 2; ++x)
    for (int y = -2; y <= 2; ++y)
      for (int k = -3; k <= 3; ++k) {
        const auto e = edge_function(D(1.0 * x), D(1.0 * y), D(1.0 * k * x), D(1.0 * k * y));
        const bool same_point = x == k * x && y == k * y;
        EXPECT_EQ(bits(e.positive | e.negative), same_point ? 0u : 15u) << x << ' ' << y << ' ' << k;
      }
}

}  // namespace
}  // namespace oktett::triangle_watertight_test
