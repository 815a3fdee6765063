#include "kernels/exact/implicit.h"

#include <algorithm>
#include <cmath>

namespace oktett {

void Implicit::add(Pool& pool, const ImplicitShape& s, const ExactPlace& place) {
  const Vec3d half = (s.hi - s.lo) * 0.5;
  if (!(half.x > 0 && half.y > 0 && half.z > 0) || !s.function.varies) return;
  for (int k = 0; k < 3; ++k)
    if (!(std::isfinite(s.lo[k]) && std::isfinite(s.hi[k]))) return;
  int shift = 0;
  std::frexp(std::max({half.x, half.y, half.z}), &shift);
  const double size = std::ldexp(1.0, shift), per_size = std::ldexp(1.0, -shift);
  const ImplicitElement e{s.function, size, s.open, s.lo * per_size, s.hi * per_size};
  add_element(pool, e, place.to_world * Affine::scaling({size, size, size}), place);
  add_cell(pool, e.lo, e.hi);
}

}  // namespace oktett
