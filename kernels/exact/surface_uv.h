#pragma once
/// \file Texture coordinates as functions in space. Their gradients tell how a point moves on the surface
/// when one coordinate changes.

#include <cmath>
#include <numbers>

#include "core/math.h"
#include "core/surface_interaction.h"
#include "core/vec3.h"

namespace oktett {

/// A function of a point in space: its value there and its gradient.
struct SpaceFunction {
  double value = 0;
  Vec3d gradient;
};

inline SpaceFunction operator+(const SpaceFunction& f, double c) { return {f.value + c, f.gradient}; }
inline SpaceFunction operator-(const SpaceFunction& f, double c) { return {f.value - c, f.gradient}; }
inline SpaceFunction operator*(const SpaceFunction& f, double c) { return {f.value * c, f.gradient * c}; }
inline SpaceFunction operator/(const SpaceFunction& f, double c) {
  return {f.value / c, f.gradient * (1 / c)};
}

/// Texture coordinates at a point of a surface.
struct SurfaceUv {
  SpaceFunction u, v;
};

/// Component `axis` of the point p.
inline SpaceFunction component(const Vec3d& p, int axis) {
  SpaceFunction f{p[axis], {0, 0, 0}};
  f.gradient[axis] = 1;
  return f;
}

/// sqrt(x^2 + y^2).
inline SpaceFunction radius_of(const SpaceFunction& x, const SpaceFunction& y) {
  const double r = std::sqrt(x.value * x.value + y.value * y.value);
  return {r, (x.gradient * x.value + y.gradient * y.value) * (1 / r)};
}

/// The angle of (x, y), from -pi to pi.
inline SpaceFunction angle_of(const SpaceFunction& y, const SpaceFunction& x) {
  const double square = x.value * x.value + y.value * y.value;
  return {portable::atan2(y.value, x.value), (y.gradient * x.value - x.gradient * y.value) * (1 / square)};
}

/// The angle of (x, y) from [-pi, pi], scaled to [0, 1].
inline double turn_of(double y, double x) { return 0.5 + portable::atan2(y, x) * 0.5 / std::numbers::pi; }
inline SpaceFunction turn_of(const SpaceFunction& y, const SpaceFunction& x) {
  return angle_of(y, x) * 0.5 / std::numbers::pi + 0.5;
}
/// Around the z axis from +x towards +y.
inline SpaceFunction turn_around_z(const Vec3d& p) { return turn_of(component(p, 1), component(p, 0)); }
/// Around the y axis from +z towards +x.
inline SpaceFunction turn_around_y(const Vec3d& p) { return turn_of(component(p, 0), component(p, 2)); }

/// Longitude, from +x towards +z, and latitude, from the south pole at -y, as of a point on a sphere about
/// the origin; both scaled to [0, 1].
inline SurfaceUv globe_uv(const Vec3d& p) {
  const SpaceFunction x = component(p, 0), z = component(p, 2);
  return {turn_of(z, x), angle_of(component(p, 1), radius_of(x, z)) / std::numbers::pi + 0.5};
}

/// The position on a face of a box along the two axes after that of the face, in [0, 1], or as it is along an
/// axis without end.
inline SurfaceUv face_uv(int face, const Vec3d& lo, const Vec3d& hi, const Vec3d& p) {
  const auto along = [&](int k) {
    const double extent = hi[k] - lo[k];
    return std::isfinite(extent) ? (component(p, k) - lo[k]) / extent : component(p, k);
  };
  const int axis = (face - 1) / 2;
  return {along((axis + 1) % 3), along((axis + 2) % 3)};
}

/// The coordinates as interactions hold them.
inline Vec2f rounded(const SurfaceUv& uv) {
  return {static_cast<float>(uv.u.value), static_cast<float>(uv.v.value)};
}

/// Sets uv, dp/du and dp/dv, in the space of the gradients, where the surface has the normal `n` of any
/// length. Where only one coordinate changes along the surface, its steepest way; at poles the vectors are
/// zero.
inline void set_uv(SurfaceInteraction& s, const SurfaceUv& uv, const Vec3d& n) {
  s.uv = rounded(uv);
  const Vec3d along_u = cross(uv.v.gradient, n), along_v = cross(n, uv.u.gradient);
  const double det = dot(uv.u.gradient, along_u);
  if (!std::isfinite(det)) return;
  const auto steepest = [&](const Vec3d& gradient) {
    const Vec3d along = gradient - n * (dot(gradient, n) / dot(n, n));
    const double square = dot(along, along);
    return square > 0 ? Vec3f(along / square) : Vec3f{0, 0, 0};
  };
  s.tangent = det != 0 ? Vec3f(along_u / det) : steepest(uv.u.gradient);
  s.bitangent = det != 0 ? Vec3f(along_v / det) : steepest(uv.v.gradient);
}

}  // namespace oktett
