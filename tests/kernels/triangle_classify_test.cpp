#include "kernels/triangle/triangle_classify.h"

#include <gtest/gtest.h>

#include "accel/traverse/leaf.h"
#include "tests/support/limits.h"
#include "tests/support/triangle_cases.h"

namespace oktett::triangle_classify_test {
namespace {

using F = Simd<float, 1, ScalarIsa>;
using State = RayState<1, ScalarIsa>;

struct Exact {
  bool valid, hit;
  float t;
};

Exact decide(const TriangleCase& c) {
  State r;
  if (r.set(broadcast<F>(c.ray.origin), broadcast<F>(c.ray.direction), F(c.ray.tmin), F(c.ray.tmax), Box{}) ==
      0)
    return {false, false, 0};
  const int z = r.z_axis_of(0);
  const auto corner = [&](int k) { return permute_to_z(broadcast<F>(c.corner[k]), z); };
  HitLanes<F> h;
  const bool hit = any(decide_watertight(load_shear(r, z), {corner(0), corner(1), corner(2)}, F(c.ray.tmin),
                                         F(c.ray.tmax), h));
  return {true, hit, hit ? h.t.part[0].v : 0};
}

struct Verdict {
  bool maybe, sure;
  float lo, hi;
};

Verdict classify(const TriangleCase& c) {
  const float d_max = max_component(abs(c.ray.direction));
  const auto tri = filter_triangle(
      TriangleLanes<F>{broadcast<F>(c.corner[0]), broadcast<F>(c.corner[1]), broadcast<F>(c.corner[2])});
  const auto guess = guess_triangle(broadcast<F>(c.ray.origin), broadcast<F>(c.ray.direction),
                                    F(d_max * kWeightError), F(d_max * kVolumeError), tri);
  const auto h = hit_interval(guess, F(c.ray.tmin), F(c.ray.tmax));
  return {any(maybe_hit(guess, F(c.ray.tmax))), any(h.sure), h.lo.part[0].v, h.hi.part[0].v};
}

struct Tally {
  int hits = 0, sure = 0, missed = 0;
};

/// A sure answer agrees with the decision, for the ray itself and for ranges that end at or beside the hit.
void expect_sure_is_true(TriangleCase c, Tally& tally, int number) {
  const Exact whole = decide(c);
  if (!whole.valid) return;
  tally.hits += whole.hit;
  const float before = std::nextafter(whole.t, 0.0f), after = std::nextafter(whole.t, kInf);
  const float ranges[][2] = {{0, kInf},       {0, whole.t},    {0, before},   {0, after},
                             {whole.t, kInf}, {before, after}, {before, kInf}};
  for (const auto& range : ranges) {
    c.ray.tmin = range[0], c.ray.tmax = range[1];
    if (!(c.ray.tmin < c.ray.tmax)) continue;
    const Exact exact = decide(c);
    const Verdict v = classify(c);
    if (exact.hit) {
      ASSERT_TRUE(v.maybe) << number << " up to " << range[1];
    }
    if (v.maybe && v.sure) {
      ASSERT_TRUE(exact.hit) << number << " from " << range[0] << " up to " << range[1];
      ASSERT_LE(v.lo, exact.t) << number;
      ASSERT_GE(v.hi, exact.t) << number;
      ASSERT_GT(v.lo, range[0]);
      ASSERT_LE(v.hi, range[1]);
      tally.sure += &range == &ranges[0];
    }
    tally.missed += !v.maybe;
  }
}

class ClassifyScale : public testing::TestWithParam<float> {};

TEST_P(ClassifyScale, WhatIsSureIsWhatTheDecisionSays) {
  TriangleRandom random(static_cast<std::uint64_t>(std::ilogb(GetParam()) + 2000));
  Tally tally;
  for (int i = 0; i < 60000; ++i) {
    expect_sure_is_true(adversarial_case(random, GetParam()), tally, i);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(tally.hits, 6000);
  EXPECT_GT(tally.missed, 6000);
  // Where squares of sizes near the smallest numbers, nothing is sure.
  if (GetParam() > 1e-6f) {
    EXPECT_GT(tally.sure, 1000);
  }
}

INSTANTIATE_TEST_SUITE_P(Scales, ClassifyScale,
                         testing::Values(1.0f, 1e-3f, 1e-6f, 1e-9f, 1e3f, 1e6f, 1e9f, 1e10f));

// Small triangles, far away, and rays that pass their edges and corners by a hair.
TEST(Classify, SmallTrianglesSeenFromAfar) {
  TriangleRandom random(5);
  Tally tally;
  for (int i = 0; i < 100000; ++i) {
    TriangleCase c = adversarial_case(random, std::exp2(-20 * random.unit()));
    const Vec3f target = c.ray.origin + c.ray.direction;
    c.ray.origin = random.vector() * std::exp2(20 * random.unit());
    c.ray.direction = target - c.ray.origin;
    expect_sure_is_true(c, tally, i);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(tally.hits, 100);
  EXPECT_GT(tally.missed, 1000);
}

// Directions of any length that the bounds allow.
TEST(Classify, LongAndShortDirections) {
  TriangleRandom random(6);
  Tally tally;
  for (int i = 0; i < 60000; ++i) {
    TriangleCase c = adversarial_case(random, 1);
    c.ray.direction = c.ray.direction * std::exp2(38 * random.sign());
    expect_sure_is_true(c, tally, i);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(tally.sure, 1000);
}

bool is_behind(const TriangleCase& c) {
  const auto lane = [](const Vec3f& v) { return broadcast<F>(v); };
  return any(surely_behind(lane(c.ray.origin), lane(c.ray.direction),
                           TriangleLanes<F>{lane(c.corner[0]), lane(c.corner[1]), lane(c.corner[2])}));
}

TEST(Classify, WhatIsBehindIsNeverHit) {
  TriangleRandom random(11);
  int behind = 0;
  for (int i = 0; i < 200000; ++i) {
    TriangleCase c = adversarial_case(random, std::exp2(30 * random.sign()));
    if (i % 2 == 0) {
      // The triangle is flat along an axis, and the ray begins beside it, from 2^-10 to 2^-70 of its size
      // away.
      const std::uint32_t axis = random.below(3);
      for (Vec3f& p : c.corner) p[axis] = 0;
      const Vec3d a(c.corner[0]), e1 = Vec3d(c.corner[1]) - a, e2 = Vec3d(c.corner[2]) - a;
      const double u = random.unit(), v = (1 - u) * random.unit();
      c.ray.origin = Vec3f(a + e1 * u + e2 * v);
      c.ray.origin[axis] =
          static_cast<float>((length(e1) + length(e2)) * random.sign() * std::exp2(-10 - 60 * random.unit()));
      c.ray.direction = random.vector();
      if (i % 4 == 0) c.ray.direction[axis] *= std::exp2(-20 * random.unit());
    }
    c.ray.tmin = 0, c.ray.tmax = kInf;
    if (!is_behind(c)) continue;
    ++behind;
    ASSERT_FALSE(decide(c).hit) << i;
  }
  EXPECT_GT(behind, 30000);
}

// A floor is flat along an axis: offset_origin moves rays that leave it by 2^-46 of its size.
TEST(Classify, RaysThatLeaveFloorsAreClear) {
  TriangleRandom random(12);
  TriangleCase c;
  c.corner[0] = {-20, 0, -20}, c.corner[1] = {20, 0, 20}, c.corner[2] = {-20, 0, 20};
  for (int i = 0; i < 1000; ++i) {
    const float x = 20 * static_cast<float>(random.sign()), z = 20 * static_cast<float>(random.sign());
    c.ray.origin = {x, 0x1p-46f * 120, z};
    c.ray.direction = {static_cast<float>(random.sign()), static_cast<float>(random.unit()) + 1e-3f, 1};
    ASSERT_TRUE(is_behind(c)) << i;
    c.ray.direction.y = -c.ray.direction.y;
    ASSERT_FALSE(is_behind(c)) << i;
  }
}

// The classification is worth its name: ordinary triangles are clear nearly always.
TEST(Classify, OrdinaryTrianglesAreClear) {
  TriangleRandom random(9);
  int hits = 0, sure = 0, unclear = 0;
  for (int i = 0; i < 20000; ++i) {
    TriangleCase c;
    for (Vec3f& p : c.corner) p = random.vector();
    c.ray.origin = random.vector() * 10;
    c.ray.direction = random.vector() - c.ray.origin;
    const Verdict v = classify(c);
    hits += decide(c).hit, sure += v.maybe && v.sure, unclear += v.maybe && !v.sure;
  }
  EXPECT_GT(hits, 1000);
  EXPECT_GT(sure, hits * 99 / 100);
  EXPECT_LT(unclear, hits / 100);
}

}  // namespace
}  // namespace oktett::triangle_classify_test
