/// \file Media on grids: densities, blocks along rays, delta and ratio tracking against quadrature.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "render/medium/block_walk.h"
#include "render/medium/density_noise.h"
#include "render/medium/medium_tracker.h"
#include "tests/render/medium_support.h"

namespace oktett {
namespace {

using namespace test;

constexpr double kPi = std::numbers::pi;

double random(std::uint32_t i, std::uint32_t k) {
  return static_cast<double>(random_bits(9, i, k) >> 11) * 0x1p-53;
}

/// Random densities, many of them 0 and a few large.
std::shared_ptr<const DensityGrid> random_grid(std::uint32_t nx, std::uint32_t ny, std::uint32_t nz) {
  Column<float> values(std::size_t{nx} * ny * nz);
  for (std::uint32_t i = 0; i < values.size(); ++i) {
    const double u = random(i, 77);
    values[i] = static_cast<float>(u < 0.5 ? 0 : u < 0.9 ? u : 4 * u);
  }
  return std::make_shared<const DensityGrid>(nx, ny, nz, std::move(values));
}

TEST(DensityGrid, InterpolatesBetweenItsValues) {
  // x + 10 y + 100 z is linear, so interpolation gives it back.
  Column<float> values(3 * 4 * 5);
  for (std::uint32_t i = 0; i < 60; ++i)
    values[i] = static_cast<float>(i % 3 + 10 * (i / 3 % 4) + 100 * (i / 12));
  const DensityGrid grid(3, 4, 5, std::move(values));
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const Vec3d p{2 * random(i, 0), 3 * random(i, 1), 4 * random(i, 2)};
    EXPECT_NEAR(grid.at(p), p.x + 10 * p.y + 100 * p.z, 1e-10);
  }
  EXPECT_EQ(grid.at({2, 3, 4}), 432);
  for (const Vec3d& outside : {Vec3d{-1e-9, 1, 1}, {1, 3.001, 1}, {1, 1, 5}, {NAN, 1, 1}, {1e300, 0, 0}})
    EXPECT_EQ(grid.at(outside), 0);
  EXPECT_EQ(grid.most(), 432);
}

TEST(DensityGrid, BadValuesCountAsNothing) {
  Column<float> values(8, 1.0f);
  values[0] = NAN, values[1] = -3, values[2] = INFINITY;
  const DensityGrid grid(2, 2, 2, std::move(values));
  EXPECT_EQ(grid.at({0, 0, 0}), 0);
  EXPECT_EQ(grid.at({1, 0, 0}), 0);
  EXPECT_EQ(grid.at({0, 1, 0}), 0);
  EXPECT_EQ(grid.at({1, 1, 1}), 1);
  EXPECT_EQ(DensityGrid(9, 9, 9, Column<float>(8, 1.0f)).most(), 0) << "too few values";
}

// The spans of blocks follow each other without gaps from where the ray enters the grid to where it leaves
// it, and no density in a span exceeds its bound.
TEST(BlockWalk, CoversTheRayWithBounds) {
  const auto grid = random_grid(40, 9, 23);
  const Vec3d size{39, 8, 22};
  for (std::uint32_t i = 0; i < 3000; ++i) {
    Vec3d origin, direction;
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<std::uint32_t>(axis);
      origin[axis] = size[axis] * (2 * random(i, k) - 0.5), direction[axis] = random(i, 3 + k) - 0.5;
      // Along axes, and from whole numbers, where blocks meet.
      if (random(i, 6 + k) < 0.3) direction[axis] = 0;
      if (random(i, 9 + k) < 0.3) origin[axis] = 8 * std::floor(origin[axis] / 8);
    }
    const double length = 60 * random(i, 20);
    BlockWalk walk(*grid, origin, direction, length);
    double first = -1, last = 0;
    BlockSpan span;
    int count = 0;
    while (walk.next(span)) {
      ASSERT_LT(++count, 30);
      if (first < 0)
        first = span.begin;
      else
        EXPECT_EQ(span.begin, last);
      last = span.end;
      for (int n = 0; n <= 8; ++n) {
        const double t = span.begin + (span.end - span.begin) * n / 8;
        EXPECT_LE(grid->at(origin + direction * t), span.most);
      }
    }
    // Nothing is left out.
    for (int n = 0; n < 200; ++n) {
      const double t = length * (n + 0.5) / 200;
      const bool outside = first < 0 || t < first - 1e-9 || t > last + 1e-9;
      EXPECT_TRUE(!outside || grid->at(origin + direction * t) == 0);
    }
  }
}

TEST(BlockWalk, EndsForAnyRay) {
  const auto grid = random_grid(20, 20, 20);
  const double inf = std::numeric_limits<double>::infinity();
  for (const double a : {0.0, 1.0, -1e300, 1e-300, static_cast<double>(NAN), inf, 19.0})
    for (const double b : {0.0, -1.0, 1e300, -1e-300, static_cast<double>(NAN), -inf})
      for (const double length : {0.0, 1.0, inf, static_cast<double>(NAN)}) {
        BlockWalk walk(*grid, {a, 5, 5}, {b, 0.5, 0}, length);
        BlockSpan span;
        int count = 0;
        while (walk.next(span)) ASSERT_LT(++count, 20);
      }
}

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

TEST(DensityNoise, LooksTheSameAlwaysAndStaysInRange) {
  DensityNoise noise;
  noise.size = 24, noise.falloff = 0.5;
  const auto a = density_of(noise), b = density_of(noise);
  noise.seed = 1;
  const auto other = density_of(noise);
  double sum = 0, difference = 0;
  for (int z = 0; z < 24; ++z)
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 24; ++x) {
        const Vec3d p{x + 0.0, y + 0.0, z + 0.0};
        const double value = a->at(p);
        EXPECT_TRUE(value >= 0 && value <= 1);
        EXPECT_EQ(value, b->at(p));
        sum += value, difference += std::abs(value - other->at(p));
      }
  EXPECT_GT(sum, 100);
  EXPECT_GT(difference, 0.1 * sum);
  EXPECT_EQ(a->at({0, 0, 0}), 0) << "the corners are faded out";
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
    const double phase = 0.75 / (4 * kPi * std::pow(1.25 - cosine, 1.5));
    depth += here * step / 2;
    for (int c = 0; c < 3; ++c) {
      const auto scattering = static_cast<double>(m.scattering[c]);
      const double sigma = scattering + static_cast<double>(m.absorption[c]);
      want[c] += scattering * here * std::exp(-sigma * (depth + shadow)) * phase * kPi / (r * r) * step;
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
}  // namespace oktett
