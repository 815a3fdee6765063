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
  for (const KernelId id :
       {KernelId::sphere_geometric, KernelId::sphere_algebraic, KernelId::sphere_in_range}) {
    const Outcome o = run(id, cases, 0, 1, Isa::scalar, 1)[0];
    EXPECT_TRUE(o.hit);
    EXPECT_EQ(o.t, 2.0f);
  }
}

float shifted_by_ulps(float t, int ulps) {
  for (; ulps > 0; --ulps) t = std::nextafter(t, kInf);
  for (; ulps < 0; ++ulps) t = std::nextafter(t, -kInf);
  return t;
}

// Rays that begin or end at a root, a neighbouring number or 1 / 1000 of the distance away from it: leaving
// out roots that are not on the ray changes no hit.
TEST(SphereKernel, RootsThatAreLeftOutAreNotOnTheRay) {
  constexpr std::size_t kCount = 4096;
  std::size_t hits = 0, misses = 0;
  for (int c = 0; c < kCaseClasses; ++c) {
    KernelCases cases;
    cases.fill(KernelId::sphere_geometric, static_cast<CaseClass>(c), 0, kCount);
    const auto set_range = [&](std::size_t i, float tmin, float tmax) {
      Ray ray = cases.rays[i];
      ray.tmin = tmin, ray.tmax = tmax;
      cases.rays.set(i, ray);
    };
    for (std::size_t i = 0; i < kCount; ++i) set_range(i, 0, kInf);
    const std::vector<Outcome> near = run(KernelId::sphere_geometric, cases, 0, kCount, Isa::scalar, 1);
    for (std::size_t i = 0; i < kCount; ++i)
      if (near[i].hit) set_range(i, near[i].t, kInf);
    const std::vector<Outcome> far = run(KernelId::sphere_geometric, cases, 0, kCount, Isa::scalar, 1);
    for (int shift = -3; shift <= 3; ++shift)
      for (const bool at_end : {false, true})
        for (const std::vector<Outcome>* roots : {&near, &far}) {
          for (std::size_t i = 0; i < kCount; ++i) {
            const float t = (*roots)[i].t;
            const float moved = shift == -3  ? t * 0.999f
                                : shift == 3 ? t * 1.001f
                                             : shifted_by_ulps(t, shift);
            if (!(*roots)[i].hit || !(moved >= 0)) continue;
            at_end ? set_range(i, 0, moved) : set_range(i, moved, kInf);
          }
          const std::vector<Outcome> all = run(KernelId::sphere_geometric, cases, 0, kCount, Isa::scalar, 1);
          for (const Isa isa : available_isas()) {
            const int width = probe_widths(isa).back();
            const std::vector<Outcome> some = run(KernelId::sphere_in_range, cases, 0, kCount, isa, width);
            for (std::size_t i = 0; i < kCount; ++i) {
              ASSERT_EQ(some[i].hit, all[i].hit) << exact_text(cases.rays[i]);
              if (all[i].hit) {
                ASSERT_EQ(some[i].t, all[i].t) << exact_text(cases.rays[i]);
              }
              ++(all[i].hit ? hits : misses);
            }
          }
        }
  }
  EXPECT_GT(hits, misses / 10);
  EXPECT_GT(misses, hits / 10);
}

}  // namespace
}  // namespace oktett::kernels_test
