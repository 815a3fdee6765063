/// \file This layer's code by instruction set.

#include "core/isa_select.h"
#include "core/noise_places.h"

namespace oktett {

// Defined for each set in core/isa/noise.cpp.
template <class A>
void noise_code(const Vec3d* places, std::size_t count, double* values);

NoiseAtPlaces noise_at_places(Isa isa) {
  return with_isa(isa, []<class A>() -> NoiseAtPlaces { return &noise_code<A>; });
}

}  // namespace oktett
