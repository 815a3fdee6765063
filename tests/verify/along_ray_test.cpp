#include "verify/oracles/along_ray.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace oktett::along_ray_test {
namespace {

using enum AlongRay::Crossing;

/// A ray at a slant of 1 to 100 to a wall, which stands at x = 10^-6 in the space of a shape that is placed
/// at `x`.
AlongRay at_a_slant(const ExactOracle& oracle, float x) {
  return AlongRay(oracle, Affine::translation({-static_cast<double>(x), 0, 0}),
                  {{x, 0, 0}, 0, {0.01f, 1, 0}});
}

ExactOracle wall() {
  return {{}, [](const Vec3l& p) { return p.x < 1e-6L ? -1.0L : 1.0L; }, {-1, -1, -1}, {1, 1, 1}};
}

// Doubles near 2 * 10^5 are 3 * 10^-11 apart, which is 3 * 10^-9 along the ray.
TEST(AlongRay, FarAwayRoundingOfTheOriginDecides) {
  const ExactOracle oracle = wall();
  const AlongRay near = at_a_slant(oracle, 0), far = at_a_slant(oracle, 2e5f);
  const long double t = near.crossings().at(0);
  EXPECT_EQ(near.crosses(t), yes);
  EXPECT_EQ(near.crosses(t + 2e-9L), no);
  EXPECT_EQ(far.crosses(t + 2e-9L), nearly);
  EXPECT_EQ(far.crosses(t + 1e-6L), no);
  EXPECT_LT(near.room(t), 1e-10L);
  EXPECT_GT(far.room(t), 2e-9L);
  EXPECT_LT(far.room(t), 1e-6L);
}

/// Whether a list holds a number up to the slack there.
bool holds(const std::vector<long double>& list, const AlongRay& ray, long double t) {
  return std::ranges::any_of(list, [&](long double u) { return std::abs(t - u) <= ray.slack(t); });
}

// Between random points, and between such next to corners of a grid, where sides and ends of shapes lie.
TEST(AlongRay, NothingIsWhereAWayIsClear) {
  const std::vector<std::string> names = exact_oracle_names();
  for (std::size_t form = 0; form < names.size(); ++form) {
    CaseRandom random(form + 1);
    std::uint64_t crossings = 0, samples = 0, spared = 0;
    for (int trial = 0; trial < 12; ++trial) {
      const ExactOracle oracle = draw_exact_oracle(form, random);
      if (!oracle.clear) break;
      ExactOracle plain = oracle;
      plain.clear = {};
      const auto point = [&] {
        Vec3d p;
        for (int k = 0; k < 3; ++k) {
          double u = random.unit();
          if (trial % 4 == 0) u = std::round(4 * u) / 4 + 1e-6 * random.sign();
          p[k] = oracle.lo[k] + (oracle.hi[k] - oracle.lo[k]) * u;
        }
        return p;
      };
      for (int i = 0; i < 12; ++i) {
        const Vec3d from = point(), to = point();
        if (from == to) continue;
        const Ray ray{Vec3f(from - (to - from) * 2.0), 0, Vec3f(to - from)};
        const AlongRay with(oracle, {}, ray), without(plain, {}, ray);
        const std::vector<long double> found = with.crossings();
        for (const long double t : without.crossings()) {
          ++crossings;
          EXPECT_TRUE(holds(found, with, t)) << names[form] << ", trial " << trial << ", ray " << i;
        }
        for (int k = 0; k < 32; ++k) {
          // Short stretches, most of which are clear, and samples within.
          const long double t = with.begin + (with.end - with.begin) * random.unit(),
                            d = (with.end - with.begin) * random.magnitude(-5, -1);
          const Vec3l o(ray.origin), way(ray.direction);
          ++samples;
          if (!oracle.clear(Vec3d(o + way * t), Vec3d(o + way * (t + d)))) continue;
          ++spared;
          for (int n = 0; n < 8; ++n) {
            const long double t0 = t + d * n / 8, t1 = t + d * (n + 1) / 8;
            if ((with(t0) < 0) == (with(t1) < 0)) continue;
            EXPECT_GE(with.ends(bisected(with, t0, t1)), 0)
                << names[form] << ", trial " << trial << ", ray " << i;
          }
        }
      }
    }
    if (samples == 0) continue;
    EXPECT_GT(crossings, 20u) << names[form];
    EXPECT_GT(spared, samples / 2) << names[form];
  }
}

}  // namespace
}  // namespace oktett::along_ray_test
