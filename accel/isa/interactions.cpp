#include "accel/exact.h"
#include "accel/isa/mesh_interactions.h"
#include "accel/isa/shape_interactions.h"
#include "accel/surface/interaction_code.h"

namespace oktett {

template <class A>
const InteractionCode& interaction_code() {
  static constexpr InteractionCode code = {mesh_surfaces_code<A>, closed_surfaces_code<A>,
                                           ExactCode<A>::surfaces};
  return code;
}

template const InteractionCode& interaction_code<OKTETT_ISA>();

}  // namespace oktett
