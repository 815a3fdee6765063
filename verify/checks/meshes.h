#pragma once
/// \file Whole meshes: closed ones must be crossed consistently, and every way of tracing must agree.

#include <cstdint>
#include <string>
#include <vector>

#include "accel/accel.h"
#include "core/isa.h"
#include "verify/checks/kernels.h"
#include "verify/oracles/mesh.h"

namespace oktett {

/// Where a mesh stands when it is tried: scaled so that its greatest extent is `size` (0 = as it is), then
/// moved.
struct MeshPlacement {
  const char* name;
  double size;
  Vec3d offset;
};
std::vector<MeshPlacement> mesh_placements();

/// A mesh where it stands.
TriangleMesh placed_as(const TriangleMesh& mesh, const MeshPlacement& placement);

/// Counts over the rays of one mesh in one placement.
struct MeshTally : FirstFailure {
  std::uint64_t rays = 0, hits = 0, open_edges = 0;
  std::uint64_t leaks = 0;         ///< rays from inside a closed mesh that hit nothing
  std::uint64_t parity = 0;        ///< numbers of crossings that are even from inside or odd from outside
  std::uint64_t doubled = 0;       ///< rays from inside a convex mesh with more than one crossing
  std::uint64_t differing = 0;     ///< closest hits whose bits depend on the instruction set or mode
  std::uint64_t inconsistent = 0;  ///< any_hit or all_hits that contradict closest_hit

  std::uint64_t failures() const { return leaks + parity + doubled + differing + inconsistent; }
  void add(const MeshTally& other);
};

/// Rays from points inside and outside, aimed at vertices, at points of edges and at random, through a tree
/// built as `build` says. Hits are compared with those of a tree built by default, too. Rays are numbered
/// from `first`. A function of its arguments alone.
MeshTally verify_mesh(const OracleMesh& mesh, const MeshPlacement& placement, std::uint64_t rays,
                      const std::vector<Isa>& isas, const BuildOptions& build = {}, std::uint64_t first = 0);

}  // namespace oktett
