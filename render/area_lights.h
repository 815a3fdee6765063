#pragma once
/// \file Glowing surfaces as emitters of Whitted's model: points on them, which many hits share.

#include <cstdint>
#include <vector>

#include "render/scene.h"
#include "render/scene_lights.h"
#include "render/shading_columns.h"
#include "render/texture_sampler.h"

namespace oktett {

/// Points on the glowing surfaces of a scene, in patterns. The hits of a camera sample are lit by the points
/// of one pattern. Neighbouring pixels have different patterns (interleaved sampling, Keller and Heidrich
/// 2001), and so have the samples of a pixel. As many shadow rays end at each point, they make beams.
struct AreaLights {
  std::uint32_t samples = 0;        ///< points of a pattern; 0: nothing glows
  std::uint32_t patterns = 0;       ///< a multiple of 16
  std::uint32_t penumbra = 1;       ///< patterns that a hit in a penumbra asks, its own included; divides 16
  bool at_random = false;           ///< each pixel begins with a random pattern, see film/tile.h
  std::uint64_t key = 0;            ///< of the random numbers that choose it
  std::vector<LightSource> points;  ///< those of pattern p are points[p * samples] and on

  bool empty() const { return points.empty(); }
  /// The first of the patterns that a hit of pattern `p` asks if it lies in a penumbra.
  std::uint32_t first_in_penumbra(std::uint32_t p) const { return p - p % penumbra; }
  /// The pattern of a sample of the pixel in column x and row y.
  std::uint32_t pattern(std::uint32_t x, std::uint32_t y, std::uint32_t sample) const;
};

/// Patterns of IntegratorSettings::light_samples points each. A surface is chosen by its radiance times its
/// area, and a point on it uniformly. The points of each pattern are spread evenly, and so are all together.
AreaLights area_lights(const SceneLights& lights, const TextureSampler* textures,
                       const IntegratorSettings& settings);

}  // namespace oktett
