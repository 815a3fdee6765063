#pragma once
/// \file Scenes with time, masks, filters and shapes of the program against each of their parts alone.

#include <cstdint>
#include <string>
#include <vector>

#include "core/isa.h"

namespace oktett {

struct TraceScenesTally {
  std::uint64_t scenes = 0, rays = 0, hits = 0;
  std::uint64_t parts = 0;      ///< geometries that rays were traced against alone
  std::uint64_t judged = 0;     ///< hits that filters were asked about
  std::uint64_t differing = 0;  ///< rays with other hits
  std::uint64_t misjudged = 0;  ///< rays of which a filter was asked twice about a hit, or about none
  std::string failure;          ///< the first one
  std::uint64_t scene = 0;      ///< its number

  std::uint64_t wrong() const { return differing + misjudged; }
};

/// `count` random scenes of meshes, spheres, exact surfaces, combinations, shapes of a program, and instances
/// of such scenes, of which many move, hide behind masks, have filters, or coincide. The hits of rays at
/// random times are compared in all bits with what follows from all hits with each geometry alone, as it
/// stands at that time, by sorting, masking and filtering. Scenes are numbered from `first`. A function of
/// its arguments alone.
TraceScenesTally verify_trace_scenes(std::uint64_t count, const std::vector<Isa>& isas,
                                     std::uint64_t first = 0);

}  // namespace oktett
