#include "render/bsdf/metals.h"

#include "render/bsdf/optics.h"

namespace oktett {

Color head_on_color(const Conductor& metal) {
  Color color;
  for (int k = 0; k < 3; ++k)
    color[k] = static_cast<float>(conductor_fresnel(1, double{metal.eta[k]}, double{metal.k[k]}));
  return color;
}

}  // namespace oktett
