#pragma once
/// \file Scenes with media, and what their pictures show on the average.

#include <gtest/gtest.h>

#include "core/random.h"
#include "render/medium/density_grid.h"
#include "tests/render/test_scenes.h"

namespace oktett::test {

/// A picture of 16 x 16 pixels by path tracing, of a view so narrow that all pixels see the same.
inline Scene medium_scene(std::uint32_t samples, std::uint32_t depth) {
  Scene scene = bare_scene(16);
  scene.integrator.kind = IntegratorKind::path;
  scene.integrator.samples = samples, scene.integrator.depth = depth;
  scene.camera.from = {0, 0, 5}, scene.camera.at = {0, 0, 0}, scene.camera.fov = 0.001;
  return scene;
}

/// An invisible boundary around a medium.
inline std::uint32_t add_interior(Scene& scene, const Medium& medium) {
  scene.media.push_back(medium);
  Material m = diffuse({1, 1, 1});
  m.surface = false;
  m.interior = static_cast<std::uint32_t>(scene.media.size() - 1);
  return add_material(scene, m);
}

/// Clear glass that attenuates like a medium.
inline Material filled(Scene& scene, float ior, const Color& absorption,
                       std::int32_t priority = kNoPriority) {
  Material m = glass(ior);
  Medium medium;
  medium.absorption = absorption;
  scene.media.push_back(medium);
  m.interior = static_cast<std::uint32_t>(scene.media.size() - 1);
  m.priority = priority;
  return m;
}

/// The mean of all pixels and its standard error, by the scatter of the pixels.
struct Mean {
  Vec3d value, error;
};

inline Mean mean_of(const Picture& picture) {
  Mean mean;
  int channel = 0;
  for (const char* name : {"R", "G", "B"}) {
    const auto& values = picture.find(name)->values;
    const auto count = static_cast<double>(values.size());
    double sum = 0, squares = 0;
    for (const float v : values) sum += static_cast<double>(v);
    for (const float v : values) squares += std::pow(static_cast<double>(v) - sum / count, 2);
    mean.value[channel] = sum / count;
    mean.error[channel] = std::sqrt(squares / (count - 1) / count);
    ++channel;
  }
  return mean;
}

/// Within three standard errors, and a little for rounding.
inline void expect_mean(const Mean& mean, const Vec3d& want, double most_error) {
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(mean.value[c], want[c], 3 * mean.error[c] + 1e-5 * std::abs(want[c])) << "channel " << c;
    EXPECT_LE(mean.error[c], most_error * std::abs(want[c]) + 1e-6) << "channel " << c;
  }
}

inline Vec3d exp_of(const Vec3d& v) { return {std::exp(v.x), std::exp(v.y), std::exp(v.z)}; }

/// A random number in [0, 1).
inline double random(std::uint32_t i, std::uint32_t k) {
  return static_cast<double>(random_bits(9, i, k) >> 11) * 0x1p-53;
}

/// Random densities, many of them 0 and a few large.
inline std::shared_ptr<const DensityGrid> random_grid(std::uint32_t nx, std::uint32_t ny, std::uint32_t nz) {
  Column<float> values(std::size_t{nx} * ny * nz);
  for (std::uint32_t i = 0; i < values.size(); ++i) {
    const double u = random(i, 77);
    values[i] = static_cast<float>(u < 0.5 ? 0 : u < 0.9 ? u : 4 * u);
  }
  return std::make_shared<const DensityGrid>(nx, ny, nz, std::move(values));
}

}  // namespace oktett::test
