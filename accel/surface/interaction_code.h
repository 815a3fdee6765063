#pragma once
/// \file Code for the surfaces of groups of hits, compiled for each instruction set in accel/isa.

#include "accel/accel_data.h"
#include "accel/interaction_block.h"
#include "accel/shape_hits.h"
#include "accel/surface/mesh_surface.h"
#include "core/isa.h"

namespace oktett {

/// `count` hits of one triangle mesh. Lanes work on groups of eight, so the last hit is repeated to the end
/// of its group.
struct MeshHits {
  static constexpr std::size_t kMost = InteractionBlock::kMost;

  std::size_t count = 0;
  MeshFrame frame;
  float corner[3][3][kMost];  ///< [corner][axis], in the mesh's own space
  float normal[3][3][kMost];  ///< normals at the corners, if frame.smooth; see MeshSurface
  float u[kMost], v[kMost];
  std::uint32_t entry[kMost];  ///< index of each hit in `out`
  InteractionBlock* out;       ///< receives the columns of MeshSurface
};

/// A geometry of a structure, and its items: `count` from number `first` on.
struct GeometryItems {
  std::uint32_t geometry, user;
  std::uint32_t first, count;
};

/// Items are read in groups of this many.
inline constexpr std::size_t kItemGroup = 16;

struct InteractionCode {
  /// Sets the names of those of `count` hits that are of the geometry, with the material slot 0, and returns
  /// their bits. `items` are those that were hit, filled up to a group with kNoId.
  std::uint64_t (*name_hits)(const std::uint32_t* items, std::size_t count, const GeometryItems& geometry,
                             InteractionBlock& out);
  /// Hits of one mesh.
  void (*mesh)(const MeshHits&);
  /// Hits of one closed-form kind.
  void (*closed_form)(const Accel&, Kind, ShapeHits&);
  /// Hits of one element of an exact surface; false if the kind has no code for lanes.
  bool (*exact)(Kind, const ExactPoolBase&, ShapeHits&);
};

template <class A>
const InteractionCode& interaction_code();

/// Throws Error if this build holds no code for the set.
const InteractionCode& interaction_code(Isa isa);

}  // namespace oktett
