#pragma once
/// \file Whole scenes: all ways of tracing against each other, the scene against each of its objects alone,
/// and the objects against their oracles.

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "core/isa.h"
#include "core/ray.h"
#include "render/scene.h"

namespace oktett {

/// Counts over the rays of scenes.
struct SceneTally {
  std::uint64_t scenes = 0, objects = 0, rays = 0, hits = 0;
  std::set<std::string> kinds;  ///< of the known shapes in them
  std::uint64_t compared = 0;   ///< pairs of a ray and an object whose oracle was asked
  std::uint64_t differing = 0;  ///< a mode, batch size, query, instruction set or build quality differs
  std::uint64_t apart = 0;      ///< hits of the scene that are not those of its objects
  std::uint64_t untrue = 0;     ///< hits that an oracle denies, crossings that are missed
  std::string failure;          ///< the first one
  std::uint64_t scene = 0;      ///< its scene's number

  std::uint64_t wrong() const { return differing + apart + untrue; }
  void add(const SceneTally& other);
};

/// Traces `rays` through `scene` in all ways. The oracles of objects that have the names of known shapes are
/// asked, too. `turn` tells which instruction set is asked in all ways. A function of its arguments alone.
SceneTally check_scene(const Scene& scene, const RayBatch& rays, const std::vector<Isa>& isas,
                       std::uint64_t turn = 0);

/// Rays through `scene`, which is number `number`: from one point and from all around, along axes, with
/// limits, and from points where others have hit.
RayBatch draw_rays(const Scene& scene, std::uint64_t number);

/// The random scenes `first` to `first` + `count` - 1.
SceneTally verify_scenes(std::uint64_t count, const std::vector<Isa>& isas, std::uint64_t first = 0);

}  // namespace oktett
