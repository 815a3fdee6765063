#include "verify/checks/exact.h"

#include <gtest/gtest.h>

#include <cmath>

#include "accel/accel.h"
#include "tests/support/limits.h"
#include "verify/oracles/exact.h"

namespace oktett::exact_test {
namespace {

/// The gradient of f by central differences, of length 1; zero near edges, where two steps do not agree.
Vec3d gradient(const SurfaceFunction& f, const Vec3l& p, long double size) {
  constexpr long double kSteps[3] = {1e-6L, 1e-8L, 1e-5L};
  Vec3l found[3];
  for (int wide = 0; wide < 3; ++wide) {
    const long double h = size * kSteps[wide];
    for (int k = 0; k < 3; ++k) {
      Vec3l a = p, b = p;
      a[k] -= h, b[k] += h;
      found[wide][k] = f(b) - f(a);
    }
    const long double l = std::sqrt(dot(found[wide], found[wide]));
    if (!(l > 0) || !std::isfinite(l)) return {0, 0, 0};
    found[wide] = found[wide] / l;
  }
  for (const Vec3l& other : {found[1], found[2]})
    if (const Vec3l off = found[0] - other; !(dot(off, off) < 1e-12L)) return {0, 0, 0};
  return Vec3d(found[0]);
}

}  // namespace

/// Every form against its oracle: no first hit missed or invented, positions within their bounds, all
/// crossings entering and leaving in turn, the same bits in every mode, width and instruction set.
TEST(Exact, AgreesWithItsOracle) {
  const std::vector<std::string> names = exact_oracle_names();
  for (std::size_t form = 0; form < names.size(); ++form) {
    const ExactTally t = verify_exact(form, 2048, available_isas());
    EXPECT_EQ(t.wrong(), 0u) << names[form] << ": " << t.missed << " missed, " << t.invented << " invented, "
                             << t.off_surface << " off the surface, " << t.lists << " lists, " << t.differing
                             << " differing; " << t.failure;
    EXPECT_GT(t.hits, t.rays / 10) << names[form];
    EXPECT_LE(t.worst_residual, 1) << names[form];
  }
}

ExactTally tally_of_trial(const char* name, std::uint64_t trial) {
  const std::vector<std::string> names = exact_oracle_names();
  const auto form = static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  return verify_exact(form, kRaysPerShape, available_isas(), trial);
}

/// Where a pole lies within the bound of a position, the values around it are infinite.
TEST(Exact, PolesWithinTheBoundAreCreases) {
  const ExactTally t = tally_of_trial("ratiohyperboloid", 8617734704473994922u);
  EXPECT_EQ(t.wrong(), 0u) << t.failure;
  EXPECT_GT(t.creased, 0u);
}

/// Next to a cusp (exponents 7 and 0.06) the surface is thinner than all points of a grid within the bound.
TEST(Exact, SliversThinnerThanTheBoundAreCreases) {
  const ExactTally t = tally_of_trial("supertoroid", 8617734704474000252u);
  EXPECT_EQ(t.wrong(), 0u) << t.failure;
  EXPECT_GT(t.creased, 0u);
}

/// Geometric normals are those of the oracle's function.
TEST(Exact, NormalsAreGradientsOfTheOracle) {
  const std::vector<std::string> names = exact_oracle_names();
  CaseRandom random(21);
  for (std::size_t form = 0; form < names.size(); ++form) {
    int checked = 0, hits = 0;
    for (int trial = 0; trial < 12; ++trial) {
      const ExactOracle oracle = draw_exact_oracle(form, random);
      const auto accel = build_accel({{oracle.shape, {}, kNoId}});
      const Vec3d middle = (oracle.lo + oracle.hi) * 0.5, half = (oracle.hi - oracle.lo) * 0.5;
      const double size = max_component(half);
      for (int i = 0; i < 60; ++i) {
        const Vec3d from = middle + normalize(random.vector()) * (4 * size);
        const Ray ray{Vec3f(from), 0, Vec3f(normalize(middle + half * random.vector() * 0.9 - from)), kInf};
        const Hit hit = closest_hit(*accel, ray);
        if (!hit.valid()) continue;
        ++hits;
        const SurfaceInteraction s = surface_interaction(*accel, ray, hit);
        const Vec3d expected = gradient(oracle.f, Vec3l(s.position), size);
        if (expected == Vec3d{0, 0, 0}) continue;
        // Where edges of an outline lie on each other, both sides are outside.
        const Vec3l step(Vec3d(s.geometric_normal) * (1e-6 * size)), at(s.position);
        if (oracle.f(at + step) > 0 && oracle.f(at - step) > 0) continue;
        ++checked;
        EXPECT_GT(dot(expected, Vec3d(s.geometric_normal)), 1 - 1e-5)
            << names[form] << ", trial " << trial << ", ray " << i << ": " << expected.x << " " << expected.y
            << " " << expected.z << " for " << s.geometric_normal.x << " " << s.geometric_normal.y << " "
            << s.geometric_normal.z;
      }
    }
    EXPECT_GT(checked, hits / 2) << names[form];
    EXPECT_GT(hits, 50) << names[form];
  }
}

}  // namespace oktett::exact_test
