#include "render/light/aimed_profile.h"

#include <algorithm>
#include <utility>

#include "core/math.h"

namespace oktett {

float AimedProfile::operator()(const Vec3d& direction) const {
  if (profile == nullptr) return 1;
  const double x = dot(direction, zero), y = dot(direction, cross(zero, down)), z = dot(direction, down);
  double horizontal = portable::atan2(y, x) / kDegree;
  if (horizontal < 0) horizontal += 360;
  const double vertical = portable::atan2(std::sqrt(x * x + y * y), z) / kDegree;
  return static_cast<float>(profile_value(*profile, vertical, horizontal));
}

AimedProfile aim(std::shared_ptr<const LightProfile> profile, const Vec3d& down, double rotation) {
  AimedProfile aimed{std::move(profile), normalize(down), {}};
  const double angle = rotation * kDegree;
  const Vec3d zero{portable::cos(angle), 0, -portable::sin(angle)};
  // The rotation that takes -y to `down` (Rodrigues). If that is +y, half a turn about x.
  const Vec3d axis = cross(Vec3d{0, -1, 0}, aimed.down);
  const double cosine = -aimed.down.y;
  if (cosine < -1 + 1e-12) {
    aimed.zero = {zero.x, 0, -zero.z};
    return aimed;
  }
  const Vec3d once = cross(axis, zero);
  aimed.zero = normalize(zero + once + cross(axis, once) * (1 / (1 + cosine)));
  return aimed;
}

}  // namespace oktett
