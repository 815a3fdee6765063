#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "tests/support/limits.h"
#include "verify/checks/kernels.h"

namespace oktett::kernels_test {
namespace {

class Kernel : public testing::TestWithParam<int> {
 protected:
  KernelId id() const { return static_cast<KernelId>(GetParam()); }
};

// Every kernel agrees with the oracle within its tolerance, and gives the same bits in every width and
// instruction set.
TEST_P(Kernel, AgreesWithTheOracleEverywhere) {
  for (int c = 0; c < kCaseClasses; ++c) {
    const CaseClass kind = static_cast<CaseClass>(c);
    const KernelTally t = verify_kernel(id(), kind, 12000, available_isas());
    EXPECT_EQ(t.failure, "") << to_string(kind);
    EXPECT_EQ(t.differing, 0u) << to_string(kind);
    if (must_be_right(id(), kind)) {
      EXPECT_EQ(t.wrong, 0u) << to_string(kind);
      EXPECT_GT(t.hits, t.rays / 20) << to_string(kind);
    }
    EXPECT_LE(t.worst_ulps, 0.51) << to_string(kind);
  }
}

struct Outcome {
  float t, u, v;
  bool hit;
};

std::vector<Outcome> run(KernelId id, const KernelCases& cases, std::size_t begin, std::size_t count, Isa isa,
                         int width) {
  // One element more, to see that nothing is written past the end.
  std::vector<float> t(count + 1, -7), u(count + 1, -7), v(count + 1, -7);
  std::vector<std::uint8_t> hit(count + 1, 77);
  KernelProbe r = cases.run(begin, count);
  r.t = t.data(), r.u = u.data(), r.v = v.data(), r.hit = hit.data();
  probe_kernel(isa, id, width, r);
  EXPECT_EQ(hit[count], 77) << "written past the end";
  EXPECT_EQ(t[count], -7) << "written past the end";
  std::vector<Outcome> out;
  for (std::size_t i = 0; i < count; ++i) out.push_back({t[i], u[i], v[i], hit[i] != 0});
  return out;
}

// Counts around the width, from places in a column that no register is aligned to.
TEST_P(Kernel, CountsAndAlignmentDoNotMatter) {
  KernelCases cases;
  cases.fill(id(), CaseClass::random, 0, 64);
  const std::vector<Outcome> all = run(id(), cases, 0, 64, Isa::scalar, 1);
  for (const Isa isa : available_isas())
    for (const int width : probe_widths(isa))
      for (const std::size_t begin : {0u, 1u, 3u, 7u})
        for (const std::size_t count : {width - 1, width, width + 1, 2 * width + 1}) {
          if (count == 0) continue;
          const std::vector<Outcome> part = run(id(), cases, begin, count, isa, width);
          for (std::size_t i = 0; i < count; ++i) {
            ASSERT_EQ(part[i].hit, all[begin + i].hit) << width << ' ' << begin << ' ' << count << ' ' << i;
            if (part[i].hit && id() != KernelId::slab) {
              ASSERT_EQ(part[i].t, all[begin + i].t);
            }
          }
        }
}

// Rays that by definition hit nothing.
TEST_P(Kernel, UnusableRaysHitNothing) {
  KernelCases cases;
  cases.fill(id(), CaseClass::vertex, 0, 16);
  RayBatch rays;
  for (std::size_t i = 0; i < 16; ++i) {
    Ray r = cases.rays[i];
    r.tmin = 0, r.tmax = kInf;
    switch (i) {
      case 0:
        r.origin.x = kNan;
        break;
      case 1:
        r.origin.z = kInf;
        break;
      case 2:
        r.direction.y = kNan;
        break;
      case 3:
        r.direction.x = -kInf;
        break;
      case 4:
        r.direction = {0, 0, 0};
        break;
      case 5:
        r.direction = {-0.0f, 0, -0.0f};
        break;
      case 6:
        r.tmin = kNan;
        break;
      case 7:
        r.tmax = kNan;
        break;
      case 8:
        r.tmin = r.tmax = 1;
        break;
      case 9:
        r.tmax = 0;
        break;
      case 10:
        r.tmax = -1;
        break;
      case 11:
        r.tmin = -1;
        break;
      case 12:
        r.tmin = kInf;
        break;
      case 13:
        r.direction = {1e-45f, 0, 0};
        break;
      case 14:
        r.origin.y = -kInf;
        break;
      default:
        r.direction.z = kInf;
    }
    rays.push_back(r);
  }
  cases.rays = rays;
  for (const Isa isa : available_isas())
    for (const int width : probe_widths(isa)) {
      const std::vector<Outcome> out = run(id(), cases, 0, 16, isa, width);
      for (std::size_t i = 0; i < 16; ++i)
        EXPECT_FALSE(out[i].hit) << to_string(isa) << ' ' << width << " case " << i;
    }
}

INSTANTIATE_TEST_SUITE_P(All, Kernel, testing::Range(0, kKernels), [](const auto& p) {
  return std::string(to_string(static_cast<KernelId>(p.param)));
});

// A ray that starts on a sphere does not meet it there again, within rounding, but meets the far side.
TEST(SphereKernel, RayFromTheSurfaceMeetsTheFarSide) {
  KernelCases cases;
  cases.fill(KernelId::sphere_geometric, CaseClass::vertex, 0, 1);
  const double column[] = {0, 0, 0, 1};
  for (int k = 0; k < 4; ++k) cases.shape[k][0] = column[k];
  cases.rays.set(0, {{-1, 0, 0}, 0, {1, 0, 0}, kInf});
  for (const KernelId id : {KernelId::sphere_geometric, KernelId::sphere_algebraic}) {
    const Outcome o = run(id, cases, 0, 1, Isa::scalar, 1)[0];
    EXPECT_TRUE(o.hit);
    EXPECT_EQ(o.t, 2.0f);
  }
}

}  // namespace
}  // namespace oktett::kernels_test
