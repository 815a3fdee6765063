#pragma once
/// \file Texture coordinates of round things: angles as parts of a whole turn.

#include <cmath>
#include <numbers>

#include "core/math.h"
#include "core/surface_interaction.h"
#include "core/vec3.h"

namespace oktett {

/// The angle of the point (x, y) from [-pi, pi], scaled to [0, 1].
inline double turn_of(double y, double x) { return 0.5 + portable::atan2(y, x) * 0.5 / std::numbers::pi; }

inline void set_uv(SurfaceInteraction& s, double u, double v) {
  s.uv = {static_cast<float>(u), static_cast<float>(v)};
}

/// u around the z axis from +x towards +y, and the tangent along it.
inline void set_uv_around_z(SurfaceInteraction& s, const Vec3d& p, double v) {
  set_uv(s, turn_of(p.y, p.x), v);
  s.tangent = Vec3f(Vec3d{-p.y, p.x, 0} * (2 * std::numbers::pi));
}
/// u around the y axis from +z towards +x, and the tangent along it.
inline void set_uv_around_y(SurfaceInteraction& s, const Vec3d& p, double v) {
  set_uv(s, turn_of(p.x, p.z), v);
  s.tangent = Vec3f(Vec3d{p.z, 0, -p.x} * (2 * std::numbers::pi));
}
/// Longitude and latitude of p as of a point on a sphere about the origin, and the tangent along the
/// longitude.
inline void set_globe_uv(SurfaceInteraction& s, const Vec3d& p) {
  const double l = length(p), sine = l > 0 ? p.y / l : 0;
  set_uv(s, turn_of(p.z, p.x), 0.5 + portable::asin(sine < -1 ? -1 : sine > 1 ? 1 : sine) / std::numbers::pi);
  s.tangent = Vec3f(Vec3d{-p.z, 0, p.x} * (2 * std::numbers::pi));
}
/// The position on a face of a box along the two axes after that of the face, in [0, 1], or as it is along an
/// axis without end.
inline void set_face_uv(SurfaceInteraction& s, int face, const Vec3d& lo, const Vec3d& hi, const Vec3d& p) {
  const int u = ((face - 1) / 2 + 1) % 3, v = ((face - 1) / 2 + 2) % 3;
  const auto is_finite = [&](int k) { return std::isfinite(hi[k] - lo[k]); };
  const auto at = [&](int k) { return is_finite(k) ? (p[k] - lo[k]) / (hi[k] - lo[k]) : p[k]; };
  set_uv(s, at(u), at(v));
  Vec3d tangent;
  tangent[u] = is_finite(u) ? hi[u] - lo[u] : 1;
  s.tangent = Vec3f(tangent);
}

}  // namespace oktett
