#pragma once
/// \file Code for the surfaces of groups of hits, compiled for each instruction set in accel/isa.

#include "accel/accel_data.h"
#include "accel/shape_hits.h"
#include "accel/surface/mesh_hits.h"
#include "core/isa.h"

namespace oktett {

struct InteractionCode {
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
