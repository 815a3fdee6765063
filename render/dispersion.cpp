#include "render/dispersion.h"

#include <algorithm>

namespace oktett {

float dispersed_ior(float ior, float dispersion, int channel) {
  // The lines F, d and C, of which the Abbe number is made, and the channels; in nanometres.
  constexpr double kBlueLine = 486.13, kMiddleLine = 587.56, kRedLine = 656.27;
  constexpr double kChannels[] = {630, 532, 467};
  constexpr auto inverse_square = [](double x) { return 1 / (x * x); };
  const double spread = (double{ior} - 1) * double{dispersion} / 20;
  const double n = double{ior} + spread * (inverse_square(kChannels[channel]) - inverse_square(kMiddleLine)) /
                                     (inverse_square(kBlueLine) - inverse_square(kRedLine));
  return static_cast<float>(ior > 1 ? std::clamp(n, 1.0, kMostIor) : std::clamp(n, 1 / kMostIor, 1.0));
}

Color disperse(ShadingPoint& p, const Color& carried, float u) {
  const float sum = carried.x + carried.y + carried.z;
  if (!(sum > 0)) return {1, 1, 1};
  int chosen = 0;
  float before = 0;
  for (int k = 0; k < 3; ++k) {
    if (!(carried[k] > 0)) continue;
    chosen = k;
    before += carried[k];
    if (u * sum < before) break;
  }
  set_index_of_refraction(p, dispersed_ior(p.principled->ior, p.principled->dispersion, chosen));
  Color factor{0, 0, 0};
  factor[chosen] = sum / carried[chosen];
  return factor;
}

}  // namespace oktett
