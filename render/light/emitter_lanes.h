#pragma once
/// \file Samples of emitters in lanes, see emitter.h. Single points use them with one lane.

#include "render/light/emitter.h"
#include "render/light/emitter_kinds.h"
#include "render/light/spherical_rectangle.h"

namespace oktett {

/// LightSample in lanes, without what is known of the emitter.
template <class D>
struct LightSamples {
  using F = Simd<float, D::kWidth, typename D::Isa>;
  Vec3<F> direction;
  F distance, pdf;
  D u, v;
  typename F::M found;  ///< the other lanes hold no defined values
};

/// sample_at of emitter_kinds.h in lanes; the light must be finite.
template <class D>
OKTETT_INLINE LightSamples<D> samples_at(const Vec3<D>& to, const D& pdf, const D& u, const D& v) {
  using F = typename LightSamples<D>::F;
  const D size = length_lanes(to);
  const F most(3.4e38f), zero(0.0f);
  LightSamples<D> s;
  s.direction = to_float(Vec3<D>{to.x / size, to.y / size, to.z / size});
  s.distance = to_float(size), s.pdf = to_float(pdf), s.u = u, s.v = v;
  s.found = (zero < s.distance) & (s.distance < most) & (zero < s.pdf) & (s.pdf < most);
  return s;
}

/// The sample in a single lane.
std::optional<LightSample> only_sample(const LightSamples<Simd<double, 1, ScalarIsa>>& s,
                                       const Color& radiance);

/// The unit vectors at angles from the unit vectors `axis` whose cosines are 1 - `one_minus_cos`. `turn` in
/// [0, 1) goes once around.
template <class D>
OKTETT_INLINE Vec3<D> around_lanes(const Vec3<D>& axis, const D& one_minus_cos, const D& turn) {
  Vec3<D> tangent, bitangent;
  basis_lanes(axis, tangent, bitangent);
  const D size = sqrt(max(D(0.0), one_minus_cos * (D(2.0) - one_minus_cos)));
  D sine, cosine;
  sin_cos_of_turn(turn, sine, cosine);
  return tangent * (size * cosine) + bitangent * (size * sine) + axis * (D(1.0) - one_minus_cos);
}

/// A parallelogram in each lane, relative to a point.
template <class D>
struct RectangleViews {
  Vec3<D> corner, edge_u, edge_v;
  typename D::M both_sides;

  /// Corner and edges in double, the corner relative to the point.
  OKTETT_INLINE LightSamples<D> sample(const D& s, const D& t) const {
    const D zero(0.0), uu = dot_lanes(edge_u, edge_u), vv = dot_lanes(edge_v, edge_v);
    const D length_u = sqrt(uu), length_v = sqrt(vv), skew = dot_lanes(edge_u, edge_v);
    const Vec3<D> normal = cross_lanes(edge_u, edge_v);
    const D height = -dot_lanes(normal, corner);
    const auto lights = (height > zero) | (both_sides & (height < zero));
    const D along_u = dot_lanes(corner, edge_u) / length_u, along_v = dot_lanes(corner, edge_v) / length_v;
    const SphericalRectangle<D> spherical(along_u, along_u + length_u, along_v, along_v + length_v,
                                          abs(height) / length_lanes(normal));
    const auto by_angle =
        (skew * skew <= D(1e-12) * uu * vv) & (spherical.solid_angle() >= D(kLeastSolidAngle));
    D x, y;
    spherical.place(s, t, x, y);
    const D u = select(by_angle, within((x - along_u) / length_u, zero, D(1.0)), s);
    const D v = select(by_angle, within((y - along_v) / length_v, zero, D(1.0)), t);
    const Vec3<D> to = corner + edge_u * u + edge_v * v;
    D pdf = D(1.0) / spherical.solid_angle();
    if (any(~by_angle)) {
      const D square = dot_lanes(to, to);
      pdf = select(by_angle, pdf, square * sqrt(square) / abs(dot_lanes(to, normal)));
    }
    LightSamples<D> found = samples_at(to, pdf, u, v);
    found.found = found.found & mask_cast<float>(lights);
    return found;
  }
};

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

}  // namespace oktett
