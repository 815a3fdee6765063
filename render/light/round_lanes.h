#pragma once
/// \file Samples of spheres, suns, points and spots in lanes, see emitter.h.

#include "render/light/emitter_lanes.h"

namespace oktett {

/// 1 - cosine of the half angle of the cone that a sphere fills, by the square of the sine.
template <class D>
OKTETT_INLINE D cap_height_lanes(const D& sine_square) {
  return sine_square / (D(1.0) + sqrt(D(1.0) - sine_square));
}

/// Spheres as seen from points outside: `to_center` goes from the point.
template <class D>
OKTETT_INLINE LightSamples<D> sample_spheres(const Vec3<D>& to_center, const D& radius, const D& s,
                                             const D& t) {
  const D square = dot_lanes(to_center, to_center), r_square = radius * radius;
  const D height = cap_height_lanes(r_square / square), depth = s * height, center_distance = sqrt(square);
  const Vec3<D> axis{to_center.x / center_distance, to_center.y / center_distance,
                     to_center.z / center_distance};
  const Vec3<D> direction = around_lanes(axis, depth, t);
  const D near_square = r_square - square * depth * (D(2.0) - depth);
  const D distance = center_distance * (D(1.0) - depth) - sqrt(max(D(0.0), near_square));
  return samples_at(direction * distance, D(1.0) / (D(2 * std::numbers::pi) * height), D(0.0), D(0.0));
}

/// Points and spots in lanes.
template <class D>
struct PointSamples {
  LightSamples<D> at;                 ///< of density 1
  typename LightSamples<D>::F scale;  ///< the irradiance on what faces the light, over the intensity
};

/// `to` goes from the point that is lit to the light; the rest is as in LightCone.
template <class D>
OKTETT_INLINE PointSamples<D> sample_points(const Vec3<D>& to, const Vec3<D>& axis, const D& cos_inner,
                                            const D& cos_outer, const typename D::M& falls_off) {
  const D zero(0.0), one(1.0), square = dot_lanes(to, to), cosine = -dot_lanes(axis, to) / sqrt(square);
  const D t = select(cosine >= cos_inner, one, (cosine - cos_outer) / (cos_inner - cos_outer));
  const D in_cone = t * t * (D(3.0) - D(2.0) * t);
  PointSamples<D> points{samples_at(to, one, zero, zero), to_float(in_cone / select(falls_off, square, one))};
  points.at.found = points.at.found & mask_cast<float>(cosine > cos_outer);
  return points;
}

}  // namespace oktett
