#pragma once
/// \file Light samples for the hits of a block, in columns.

#include <cstdint>

#include "render/context.h"
#include "render/light/light_tree.h"
#include "render/transport/path_block.h"

namespace oktett {

/// Points that have chosen emitters of one kind, with their samples. Lanes read and write whole groups.
struct LightGroup {
  static constexpr std::size_t kMost = PathBlock::kMost;

  std::size_t count = 0;
  std::uint32_t entry[kMost];   ///< of the PathBlock
  std::uint32_t number[kMost];  ///< of the emitter
  const void* emitter[kMost];   ///< of the kind that the function expects
  double probability[kMost];    ///< of the emitter
  float position[3][kMost];
  double x[kMost], y[kMost];  ///< of the unit square; afterwards the place on the emitter

  float direction[3][kMost], distance[kMost], pdf[kMost];  ///< density 0: nothing is found
  float radiance[3][kMost];                                ///< of environments
  float scale[kMost];                                      ///< of points: irradiance over intensity
};

/// Code that samples the lights of groups.
struct LightCode {
  ChooseLights choose;
  MapCode map;
  void (*map_samples)(const EnvironmentTables&, LightGroup&);
  void (*triangle_samples)(LightGroup&);
  void (*rectangle_samples)(LightGroup&);
  void (*disk_samples)(LightGroup&);
  void (*sphere_samples)(LightGroup&);  ///< points outside of the spheres
  void (*point_samples)(LightGroup&);   ///< the emitters are LightCone
  void (*sun_directions)(LightGroup&);  ///< of suns of some size
};

/// Chooses lights for the entries listed in `entry`, whose `from` is set, and fills their light columns, with
/// the bits of LightSet::sample.
void sample_lights(const RenderContext& context, const std::uint32_t* entry, std::size_t count, PathBlock& c);

/// Moves those of these samples to the raised points of their hits, see RaisedPoints, that come from above
/// the shading normal's horizon, but from behind the plane of the triangle. They keep their places on
/// emitters, and their densities become those at the raised points.
void raise_lights(const RenderContext& context, const std::uint32_t* entry, std::size_t count, PathBlock& c);

}  // namespace oktett
