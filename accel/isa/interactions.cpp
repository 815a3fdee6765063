#include "accel/exact_table.h"
#include "accel/isa/mesh_interactions.h"
#include "accel/isa/shape_interactions.h"
#include "accel/surface/interaction_code.h"

namespace oktett {

template <class A>
bool exact_interactions_code(Kind kind, const ExactPoolBase& pool, ShapeHits& hits) {
  return exact_code<A>(kind).interactions(pool, hits);
}

template <class A>
const InteractionCode& interaction_code() {
  static constexpr InteractionCode code = {mesh_surfaces_code<A>, closed_surfaces_code<A>,
                                           exact_interactions_code<A>};
  return code;
}

template const InteractionCode& interaction_code<OKTETT_ISA>();

}  // namespace oktett
