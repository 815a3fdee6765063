#pragma once
/// \file Hits that path tracing shades together, in columns: what the code of each instruction set works on.

#include <cstdint>

#include "accel/interaction_block.h"
#include "render/light/light_sample.h"
#include "render/path_surface.h"
#include "render/raised_points.h"
#include "render/shading_columns.h"

namespace oktett {

/// Bounces before Russian roulette begins. From then on a path goes on with the square root of its throughput
/// as probability: the noise of bounces grows less than the time falls. The root, as short paths bring most
/// of the noise, and long ones most of the time. At mirrors and clear glass what they alone leave of the
/// light takes the place of the throughput: a path through clear glass to an emitter brings much light, and
/// no light sample replaces it.
inline constexpr unsigned kSureBounces = 2;

/// tmax of a shadow ray over the vector to a point on a light: it ends before the light's surface, whose
/// place is known to a few units in the last place of its coordinates only. It is 1 less the larger of
/// kLeastGap and of kPlaceError times the greatest coordinate over the distance, but no more than half.
inline constexpr float kPlaceError = 0x1p-20f, kLeastGap = 0x1p-13f;

/// What a light sample is for its hit.
enum class LightKind : std::uint8_t {
  none,
  delta,            ///< a light that no other ray can meet
  left_to_photons,  ///< the same, but photons bring its light through glass, so that it must not pass
                    ///< straight
  area
};

/// The hits of an InteractionBlock, with their rays, random numbers and light samples. Lanes read whole
/// groups, so entries behind the last hit, up to the end of its group, hold copies of it.
struct PathBlock {
  static constexpr std::size_t kMost = InteractionBlock::kMost;
  static constexpr std::size_t kGroup = 8;  ///< the most lanes of any instruction set

  std::size_t count = 0;
  std::uint32_t ray[kMost];     ///< entry of the wavefront's rays
  std::uint64_t key[kMost];     ///< of the pixel's random numbers
  std::uint32_t number[kMost];  ///< of the sample in its pixel
  std::uint8_t bounces[kMost];
  bool asks_lights;  ///< some light can be sampled

  float direction[3][kMost];  ///< unit direction in which the ray travels
  float throughput[3][kMost];
  float ng[3][kMost], ns[3][kMost];  ///< as in ShadingPoint
  std::uint64_t behind = 0;          ///< bit k: hit k is seen from behind

  float lobe[kMost], roulette[kMost];  ///< [0, 1); the latter only for paths that may end
  double direction_x[kMost], direction_y[kMost];
  double light[kMost], light_x[kMost], light_y[kMost];  ///< only if `asks_lights`

  LightKind light_kind[kMost];
  std::uint32_t light_emitter[kMost];  ///< of the LightSet, where there is a sample
  float light_direction[3][kMost], light_distance[kMost], light_pdf[kMost];
  float light_color[3][kMost];     ///< radiance or irradiance that arrives, textures included
  std::uint64_t raised_light = 0;  ///< bit k: the light sample of hit k is that of its raised point

  RaisedPoints* raised = nullptr;  ///< of the hits; null for places in a medium

  LightPoint from[kMost];  ///< for which lights are sampled, of the hits that are shaded in lanes
};

/// Hits of one PathSurface: entries of a PathBlock, the last one repeated to the end of its group.
struct PathRun {
  const std::uint32_t* entry;
  std::size_t count;
};

/// The columns of the next bounce.
struct PathOnward : OnwardColumns {
  float* pdf;
  float* unsampled;
  LightPoint* from;
  std::uint64_t transmitted = 0;  ///< how many of the rays are
};

/// Where the rays of a block go.
struct PathQueues {
  ShadowColumns delta, area;
  PathOnward next;
};

}  // namespace oktett
