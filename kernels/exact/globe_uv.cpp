#include "kernels/exact/globe_uv.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/math.h"

namespace oktett {

void set_globe_uv(const Vec3d& p, SurfaceInteraction& s) {
  const double l = length(p), sine = l > 0 ? std::clamp(p.y / l, -1.0, 1.0) : 0;
  s.uv = {static_cast<float>(0.5 + portable::atan2(p.z, p.x) * 0.5 / std::numbers::pi),
          static_cast<float>(0.5 + portable::asin(sine) / std::numbers::pi)};
  s.tangent = Vec3f(Vec3d{-p.z, 0, p.x} * (2 * std::numbers::pi));
}

}  // namespace oktett
