#include "render/isa/light_code.h"

namespace oktett {

template <class A>
LightCode light_code() {
  return {choose_lights_code<A>,
          {map_values_code<A>},
          map_samples_code<A>,
          flat_samples_code<A, TriangleEmitter>,
          flat_samples_code<A, RectangleEmitter>,
          flat_samples_code<A, DiskEmitter>,
          sphere_samples_code<A>,
          point_samples_code<A>,
          sun_directions_code<A>};
}

template LightCode light_code<OKTETT_ISA>();

}  // namespace oktett
