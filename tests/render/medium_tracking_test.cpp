/// \file Media on grids: delta and ratio tracking against quadrature.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "render/medium/medium_tracker.h"
#include "tests/render/medium_support.h"

namespace oktett::medium_tracking_test {
namespace {

using namespace test;

/// A grid in a place that is turned and stretched.
Medium cloud() {
  Medium m;
  m.absorption = {0.2f, 1, 0}, m.scattering = {1, 0.5f, 2}, m.emission = {0.1f, 0.3f, 2};
  m.grid = random_grid(12, 10, 17);
  m.grid_place =
      Affine::translation({-1, -1.2, 0.3}) * Affine::rotation({20, 30, 40}) * Affine::scaling({2, 3, 2});
  return m;
}

/// Depth of a segment: the integral of the density by the midpoint rule.
std::vector<double> densities(const Medium& m, const MediumSegment& s, int steps) {
  const Affine to_unit = m.grid_place.inverse();
  std::vector<double> found;
  for (int i = 0; i < steps; ++i) {
    const double t = s.length * (i + 0.5) / steps;
    const Vec3d p = to_unit.point(Vec3d(s.origin) + Vec3d(s.direction) * t);
    Vec3d cells;
    for (int axis = 0; axis < 3; ++axis) cells[axis] = p[axis] * (m.grid->size(axis) - 1.0);
    found.push_back(m.grid->at(cells));
  }
  return found;
}

/// A sum with its standard error.
struct Sum {
  double sum = 0, squares = 0;
  int count = 0;
  void add(double x) { sum += x, squares += x * x, ++count; }
  double mean() const { return sum / count; }
  double error() const { return std::sqrt(std::max(0.0, squares / count - mean() * mean()) / count); }
};

// Ratio tracking and delta tracking against ray marching: what passes, what is scattered before and behind
// the middle, and what glows, per channel.
TEST(GridTracking, MatchesRayMarching) {
  const Medium m = cloud();
  const MediumTracker tracker(m);
  for (const auto& [origin, towards] :
       {std::pair{Vec3f{0, 0, 5}, Vec3f{0.1f, 0.2f, -1}}, std::pair{Vec3f{-4, 0.5f, 1}, Vec3f{1, 0, 0.05f}},
        std::pair{Vec3f{0, 0.3f, 1}, Vec3f{0, 1, 0.2f}}}) {
    const MediumSegment segment{origin, normalize(towards), 6};
    constexpr int kSteps = 40000, kPaths = 100000;
    const std::vector<double> density = densities(m, segment, kSteps);
    const Color throughput{1, 0.5f, 0.8f};
    Sum through[3], near[3], far[3], glow[3], passed[3];
    for (std::uint32_t i = 0; i < kPaths; ++i) {
      TrackingNumbers numbers(3, i), others(4, i);
      const MediumPassage p = tracker.pass(segment, throughput, {0.5, 0.5}, numbers);
      const Color ratio = tracker.transmittance(segment, others);
      const bool is_near = p.t < segment.length / 2;
      for (int c = 0; c < 3; ++c) {
        const auto value = static_cast<double>(p.throughput[c]);
        through[c].add(p.scattered ? 0 : value);
        near[c].add(p.scattered && is_near ? value : 0), far[c].add(p.scattered && !is_near ? value : 0);
        glow[c].add(static_cast<double>(p.emitted[c])), passed[c].add(static_cast<double>(ratio[c]));
      }
    }
    for (int c = 0; c < 3; ++c) {
      const auto scattering = static_cast<double>(m.scattering[c]),
                 weight = static_cast<double>(throughput[c]);
      const double sigma = scattering + static_cast<double>(m.absorption[c]), step = segment.length / kSteps;
      double depth = 0, halves[2] = {}, light = 0;
      for (int i = 0; i < kSteps; ++i) {
        const double d = density[static_cast<std::size_t>(i)];
        const double left = weight * std::exp(-sigma * (depth + d * step / 2)) * d * step;
        halves[i < kSteps / 2 ? 0 : 1] += scattering * left;
        light += static_cast<double>(m.emission[c]) * left;
        depth += d * step;
      }
      const double want = std::exp(-sigma * depth);
      ASSERT_LT(want, 0.9) << "the ray meets the cloud";
      const auto expect = [&](const Sum& sum, double value, const char* what) {
        EXPECT_NEAR(sum.mean(), value, 3.5 * sum.error() + 2e-4 * value + 1e-6) << what << " " << c;
      };
      expect(passed[c], want, "ratio tracking"), expect(through[c], weight * want, "delta tracking");
      expect(near[c], halves[0], "near"), expect(far[c], halves[1], "far"), expect(glow[c], light, "glow");
    }
  }
}

// Media that only absorb are not scattered, and those that only glow have no extinction.
// Little light passes, of which Russian roulette keeps the mean.
TEST(GridTracking, ThickMediaPassWhatBeersLawSays) {
  Medium m;
  m.absorption = {4, 1.3f, 1.25f};
  m.grid = std::make_shared<DensityGrid>(2, 2, 2, Column<float>(8, 1.0f));
  m.grid_place = Affine::scaling({2, 1, 1});
  const MediumTracker tracker(m);
  Vec3d sum, squares;
  const int count = 400000;
  for (int i = 0; i < count; ++i) {
    TrackingNumbers numbers(5, static_cast<std::uint32_t>(i));
    const Vec3d passed(tracker.transmittance({{-1, 0.5f, 0.5f}, {1, 0, 0}, 4}, numbers));
    sum += passed, squares += passed * passed;
  }
  for (int c = 0; c < 3; ++c) {
    const double mean = sum[c] / count, error = std::sqrt((squares[c] / count - mean * mean) / count);
    EXPECT_NEAR(mean, std::exp(-2 * static_cast<double>(m.absorption[c])), 3.5 * error);
    EXPECT_LT(error, (c == 0 ? 0.1 : 0.005) * mean);
  }
}

TEST(GridTracking, MediaWithoutScatteringPassOrGlow) {
  Medium m = cloud();
  m.scattering = {0, 0, 0};
  const MediumSegment segment{{0, 0, 5}, normalize(Vec3f{0.1f, 0.2f, -1}), 6};
  double depth = 0;
  for (const double d : densities(m, segment, 20000)) depth += d * segment.length / 20000;
  Sum through, glow;
  for (std::uint32_t i = 0; i < 50000; ++i) {
    TrackingNumbers numbers(3, i);
    const MediumPassage p = MediumTracker(m).pass(segment, {1, 1, 1}, {0.5, 0.5}, numbers);
    ASSERT_FALSE(p.scattered);
    through.add(static_cast<double>(p.throughput.y));
  }
  EXPECT_NEAR(through.mean(), std::exp(-depth), 3.5 * through.error());
  m.absorption = {0, 0, 0};
  for (std::uint32_t i = 0; i < 50000; ++i) {
    TrackingNumbers numbers(3, i);
    const MediumPassage p = MediumTracker(m).pass(segment, {1, 1, 1}, {0.5, 0.5}, numbers);
    ASSERT_EQ(p.throughput, (Color{1, 1, 1}));
    glow.add(static_cast<double>(p.emitted.z));
  }
  EXPECT_NEAR(glow.mean(), 2 * depth, 3.5 * glow.error());
  EXPECT_GT(depth, 0.5);
}

TEST(GridTracking, ExtremeMediaAreDefined) {
  Medium m = cloud();
  m.scattering = m.absorption = {1e9f, 1e9f, 1e9f};
  const MediumSegment endless{
      {0, 0, 5}, normalize(Vec3f{0.1f, 0.2f, -1}), std::numeric_limits<double>::infinity()};
  TrackingNumbers numbers(1, 1);
  const MediumPassage p = MediumTracker(m).pass(endless, {1, 1, 1}, {0.5, 0.5}, numbers);
  EXPECT_TRUE(p.scattered || p.throughput == (Color{0, 0, 0}));
  EXPECT_EQ(MediumTracker(m).transmittance(endless, numbers), (Color{0, 0, 0}));
  // Places without number in empty space beside a speck of very dense smoke: the path gives up.
  Column<float> speck(16 * 16 * 16, 0.0f);
  speck[0] = 1e9f;
  m.grid = std::make_shared<const DensityGrid>(16, 16, 16, std::move(speck));
  m.grid_place = {};
  const MediumSegment beside{{0.3f, 0.3f, -1}, {0, 0, 1}, 4};
  EXPECT_EQ(MediumTracker(m).pass(beside, {1, 1, 1}, {0.5, 0.5}, numbers).throughput, (Color{0, 0, 0}));
  // A place without inverse is nowhere.
  m.grid_place = Affine::scaling({1, 0, 1});
  EXPECT_EQ(MediumTracker(m).transmittance(beside, numbers), (Color{1, 1, 1}));
  const MediumSegment nowhere{{NAN, 0, 0}, {0, 0, 1}, 4};
  m = cloud();
  EXPECT_EQ(MediumTracker(m).transmittance(nowhere, numbers), (Color{1, 1, 1}));
}

Mean seen(const Scene& scene) { return mean_of(run(scene).picture); }

// Single scattering of a point light in a cloud that fills the box [-1, 1]^3 of a sphere twice as large, by
// quadrature over the way and over the way to the light.
TEST(GridTransport, SingleScatteringMatchesQuadrature) {
  Scene scene = medium_scene(256, 0);
  Medium m;
  m.absorption = {0.2f, 0.5f, 0}, m.scattering = {1, 0.5f, 2}, m.anisotropy = 0.5f;
  m.grid = random_grid(6, 6, 6);
  m.grid_place = Affine::translation({-1, -1, -1}) * Affine::scaling({2, 2, 2});
  add_object(scene, SphereShape{{0, 0, 0}, 2}, add_interior(scene, m));
  scene.lights = {PointLight{{0.5, 3, 0.25}, {1, 1, 1}, true}};
  const Mean mean = seen(scene);
  constexpr int kSteps = 1500, kShadowSteps = 300;
  const std::vector<double> way = densities(m, {{0, 0, 1}, {0, 0, -1}, 2}, kSteps);
  Vec3d want{0, 0, 0};
  double depth = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double step = 2.0 / kSteps, here = way[static_cast<std::size_t>(i)];
    const Vec3d p{0, 0, 1 - (i + 0.5) * step}, to = Vec3d{0.5, 3, 0.25} - p;
    const double r = length(to), cosine = -to.z / r;
    double shadow = 0;
    for (const double d : densities(m, {Vec3f(p), Vec3f(to / r), r}, kShadowSteps))
      shadow += d * r / kShadowSteps;
    const double phase = 0.75 / (4 * std::numbers::pi * std::pow(1.25 - cosine, 1.5));
    depth += here * step / 2;
    for (int c = 0; c < 3; ++c) {
      const auto scattering = static_cast<double>(m.scattering[c]);
      const double sigma = scattering + static_cast<double>(m.absorption[c]);
      want[c] +=
          scattering * here * std::exp(-sigma * (depth + shadow)) * phase * std::numbers::pi / (r * r) * step;
    }
    depth += here * step / 2;
  }
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(mean.value[c], want[c], 3.5 * mean.error[c] + 1e-3 * want[c]) << c;
    EXPECT_LT(mean.error[c], 0.01 * want[c]);
  }
}

// A cloud that only scatters is invisible under a uniform sky.
TEST(GridTransport, AScatteringCloudUnderAUniformSkyIsInvisible) {
  Scene scene = medium_scene(64, 64);
  scene.background = {1, 1, 1};
  Medium m;
  m.scattering = {2, 0.5f, 1}, m.anisotropy = 0.3f;
  m.grid = random_grid(9, 9, 9);
  m.grid_place = Affine::translation({-1, -1, -1}) * Affine::scaling({2, 2, 2});
  add_object(scene, BoxShape{{-1, -1, -1}, {1, 1, 1}}, add_interior(scene, m));
  expect_mean(seen(scene), {1, 1, 1}, 0.01);
}

TEST(GridTransport, PicturesDependNeitherOnThreadsNorSets) {
  Scene scene = bare_scene(16);
  scene.integrator.kind = IntegratorKind::path;
  scene.integrator.samples = 4, scene.integrator.depth = 6;
  scene.background = {0.5f, 0.6f, 0.7f};
  Medium m = cloud();
  m.emission = {0.1f, 0, 0};
  scene.media.push_back(m);
  scene.medium = 0;
  add_object(scene, SphereShape{{0, 3, 1}, 0.3}, add_material(scene, glowing({9, 8, 7})));
  const Picture first = run(scene, [](RenderOptions& o) { o.threads = 1; }).picture;
  for (const Isa isa : available_isas())
    for (const unsigned threads : {1u, 2u}) {
      const Picture other = run(scene, [&](RenderOptions& o) { o.isa = isa, o.threads = threads; }).picture;
      EXPECT_TRUE(same_bytes(first, other)) << to_string(isa) << threads;
    }
}

}  // namespace
}  // namespace oktett::medium_tracking_test
