#pragma once
/// \file Surface interactions of many hits, as they are compiled for each instruction set in accel/isa.

#include "accel/accel_data.h"
#include "accel/shape_hits.h"
#include "accel/surface/mesh_interactions.h"
#include "core/isa_select.h"

namespace oktett {

struct InteractionCode {
  void (*mesh)(MeshInteractions&);
  /// Spheres, planes, or one box.
  void (*closed_form)(const Accel&, Kind, ShapeHits&);
  /// One element of an exact surface; false if the kind has no code for lanes.
  bool (*exact)(const Accel&, Kind, ShapeHits&);
};

template <class A>
const InteractionCode& interaction_code();

inline const InteractionCode& interaction_code(Isa isa) {
  return with_isa(isa, []<class A>() -> const InteractionCode& { return interaction_code<A>(); });
}

}  // namespace oktett
