#include "render/pattern_noise.h"

#include <algorithm>

namespace oktett {

Vec3d vector_noise(const Vec3d& p) {
  // Far from each other, and beside the lattice by different parts.
  return {gradient_noise(p + Vec3d{0.37, 0.71, 0.23}), gradient_noise(p + Vec3d{57.61, 13.19, 91.43}),
          gradient_noise(p + Vec3d{-31.29, 77.53, -43.83})};
}

double steep_noise(const Vec3d& p) { return std::clamp(0.5 + gradient_noise(p), 0.0, 1.0); }

}  // namespace oktett
