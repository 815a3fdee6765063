#include "accel/traverse/beam/beam_rays.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "core/random.h"

namespace oktett::beam_rays_test {
namespace {

using Beam = BeamRays<ScalarIsa>;

/// Rays from a patch of a bent surface around `center`, in no order, that end in `light`.
RayBatch rays_to(const Vec3f& light, const Vec3f& center, float size, std::uint64_t seed) {
  const std::uint64_t key = mix_bits(seed);
  RayBatch rays;
  for (std::uint32_t i = 0; i < kBeamRays; ++i) {
    const float a = 2 * random_float(key, i, 0) - 1, b = 2 * random_float(key, i, 1) - 1;
    const Vec3f from = center + Vec3f{a, b, 0.2f * a * b} * size;
    const Vec3f to = light - from;
    const float distance = length(to);
    rays.push_back({from, 0, to / distance, distance});
  }
  return rays;
}

struct Scene {
  Vec3f light, center;
  float size;
};

/// Lights along each axis and both ways, near and far, at coarse coordinates.
std::vector<Scene> scenes() {
  std::vector<Scene> all;
  for (const Vec3f& shift : {Vec3f{0, 0, 0}, Vec3f{1000, -3000, 500}, Vec3f{-1e6f, 3e6f, 2e6f}})
    for (const Vec3f& to : {Vec3f{0.1f, 0.2f, 5}, Vec3f{0.1f, 0.2f, -5}, Vec3f{5, 0.3f, 0.1f},
                            Vec3f{-5, 0.3f, 0.1f}, Vec3f{0.3f, 5, 0.1f}, Vec3f{0.3f, -50, 20}})
      for (const float scale : {1e-3f, 1.0f, 1e4f}) all.push_back({shift + to * scale, shift, scale * 0.5f});
  return all;
}

// No line passes the apex farther away than `slip`, and no ray ends farther from it than `behind`, in
// extended precision.
TEST(BeamRays, SlipBoundsHowFarLinesMissTheApex) {
  int beams = 0;
  long double most = 0;
  for (const Scene& s : scenes()) {
    const RayBatch rays = rays_to(s.light, s.center, s.size, 3);
    const Apex apex{s.light, true};
    Beam beam;
    if (!beam.set(rays.span(), apex, 1, true)) continue;
    ++beams;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Ray r = rays[i];
      long double end[3], d[3];
      for (int k = 0; k < 3; ++k) {
        const int axis = beam.axis[k];
        d[k] = r.direction[axis];
        end[k] = static_cast<long double>(r.origin[axis]) + d[k] * r.tmax - s.light[axis];
      }
      const long double x = std::fabs(end[0] - end[2] * d[0] / d[2]),
                        y = std::fabs(end[1] - end[2] * d[1] / d[2]);
      ASSERT_LE(x, beam.slip);
      ASSERT_LE(y, beam.slip);
      ASSERT_LE(std::fabs(end[2]), beam.behind);
      most = std::max(most, std::max(x, y) / beam.slip);
    }
  }
  EXPECT_GT(beams, 20);
  EXPECT_GT(most, 0.9L);  // the bound is no more than it has to be
}

// Rays of no length end somewhere else, but hit nothing wherever that is: they make no beam worse.
TEST(BeamRays, RaysOfNoLengthDoNotCount) {
  int beams = 0;
  for (const Scene& s : scenes()) {
    RayBatch rays = rays_to(s.light, s.center, s.size, 5), without = rays;
    const float ends[] = {0.0f, -0.0f, -1e-6f, -1.0f, -1e6f, -std::numeric_limits<float>::infinity()};
    for (std::size_t i = 0; i < rays.size(); i += 21) {
      rays.tmax[i] = ends[i / 21 % std::size(ends)];
      without.tmax[i] = std::numeric_limits<float>::quiet_NaN();
    }
    const Apex apex{s.light, true};
    Beam beam, expected;
    if (!expected.set(without.span(), apex, 1, true)) continue;
    ++beams;
    ASSERT_TRUE(beam.set(rays.span(), apex, 1, true));
    EXPECT_EQ(beam.slip, expected.slip);
    EXPECT_EQ(beam.behind, expected.behind);
    for (std::size_t i = 0; i < rays.size(); i += 21)
      EXPECT_EQ(beam.hit_lo[i], std::numeric_limits<float>::infinity());
  }
  EXPECT_GT(beams, 20);
}

TEST(BeamRays, SortingKeepsTheRaysAndMakesGroupsSmall) {
  int sorted = 0;
  for (const Scene& s : scenes()) {
    RayBatch rays = rays_to(s.light, s.center, s.size, 4);
    rays.tmax[17] = std::numeric_limits<float>::quiet_NaN();
    rays.direction[1][100] = std::numeric_limits<float>::quiet_NaN();
    const Apex apex{s.light, true};
    Beam beam;
    if (!beam.set(rays.span(), apex, 1, true)) continue;
    const Beam before = beam;
    ASSERT_TRUE(beam.may_sort);
    beam.sort();
    ++sorted;
    std::set<int> seen;
    float area = 0;
    for (int g = 0; g < kBeamGroups; ++g) {
      float least = std::numeric_limits<float>::infinity();
      for (int i = g * kBeamGroup; i < (g + 1) * kBeamGroup; ++i) {
        const int from = beam.order[i];
        seen.insert(from);
        ASSERT_EQ(beam.x[i], before.x[from]);
        ASSERT_EQ(beam.y[i], before.y[from]);
        ASSERT_EQ(beam.hit_lo[i], before.hit_lo[from]);
        ASSERT_EQ(beam.hit_hi[i], before.hit_hi[from]);
        ASSERT_TRUE(beam.x_lo[g] <= beam.x[i] && beam.x[i] <= beam.x_hi[g] && beam.y_lo[g] <= beam.y[i] &&
                    beam.y[i] <= beam.y_hi[g]);
        least = std::min(least, beam.hit_lo[i]);
      }
      ASSERT_EQ(beam.least[g], least);
      area += (beam.x_hi[g] - beam.x_lo[g]) * (beam.y_hi[g] - beam.y_lo[g]);
    }
    EXPECT_EQ(seen.size(), std::size_t{kBeamRays});
    EXPECT_LT(area, 1.5f * (beam.window.x_hi - beam.window.x_lo) * (beam.window.y_hi - beam.window.y_lo));
    EXPECT_FALSE(beam.regular);
    EXPECT_FALSE(beam.may_sort);
  }
  EXPECT_GT(sorted, 20);
}

// A beam that is not whole has no order for its missing rays.
TEST(BeamRays, PartsOfBeamsAreNotSorted) {
  const RayBatch rays = rays_to({0, 0, 5}, {0, 0, 0}, 1, 5);
  Beam beam;
  ASSERT_TRUE(beam.set(rays.span().part(0, 255), {{0, 0, 5}, true}, 1, true));
  EXPECT_FALSE(beam.may_sort);
  ASSERT_TRUE(beam.set(rays.span(), {{0, 0, 5}, true}, 1, false));
  EXPECT_FALSE(beam.may_sort);
}

}  // namespace
}  // namespace oktett::beam_rays_test
