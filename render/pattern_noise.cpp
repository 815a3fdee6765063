#include "render/pattern_noise.h"

#include "core/noise_places.h"

namespace oktett {

void vector_noise_places(const Vec3d& p, Vec3d (&places)[3]) {
  // Far from each other, and beside the lattice by different parts.
  places[0] = p + Vec3d{0.37, 0.71, 0.23}, places[1] = p + Vec3d{57.61, 13.19, 91.43};
  places[2] = p + Vec3d{-31.29, 77.53, -43.83};
}

void noise_at(const Vec3d* places, std::size_t count, NoiseGenerator generator, double* values) {
  if (generator != NoiseGenerator::own) {
    for (std::size_t i = 0; i < count; ++i) values[i] = 2 * povray_noise(places[i], generator) - 1;
    return;
  }
  static const NoiseAtPlaces code = noise_at_places(default_isa());
  code(places, count, values);
}

}  // namespace oktett
