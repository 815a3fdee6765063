#include "render/light/rectangle_pair.h"

#include <algorithm>

namespace oktett {

/// Whether the edges are perpendicular, and the fourth corner is off by `rest` no more than a millionth of
/// them. The comparisons are false for NaN.
static bool is_rectangle(const Vec3d& u, const Vec3d& v, const Vec3d& rest) {
  const double skew = dot(u, v), size = std::min(length(u), length(v));
  return length(rest) < 1e-6 * size && skew * skew <= 1e-12 * dot(u, u) * dot(v, v);
}

std::optional<RectangleEmitter> rectangle_of(const TriangleEmitter& a, const TriangleEmitter& b) {
  if (!(a.radiance == b.radiance) || a.both_sides != b.both_sides) return std::nullopt;
  const Vec3f first[3] = {a.a, a.b, a.c}, second[3] = {b.a, b.b, b.c};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const Vec3f corner = first[i], next = first[(i + 1) % 3], last = first[(i + 2) % 3];
      const Vec3f after = second[(j + 1) % 3], before = second[(j + 2) % 3];
      const bool same_front = after == last && before == next;
      const bool turned = a.both_sides && after == next && before == last;
      if (!same_front && !turned) continue;
      const Vec3f u = next - corner, v = last - corner;
      const Vec3d rest = Vec3d(corner) + Vec3d(second[j]) - Vec3d(next) - Vec3d(last);
      if (is_rectangle(Vec3d(u), Vec3d(v), rest))
        return RectangleEmitter{corner, u, v, a.radiance, a.both_sides};
    }
  return std::nullopt;
}

}  // namespace oktett
