#pragma once
/// \file Samples of triangles, parallelograms and disks in lanes, see emitter.h.

#include "render/light/emitter_lanes.h"
#include "render/light/spherical_rectangle.h"
#include "render/light/spherical_triangle.h"

namespace oktett {

/// Lanes in which an emitter lights points at this height over the front of its plane.
template <class D>
OKTETT_INLINE typename D::M lights_side(const D& height, const typename D::M& both_sides) {
  const D zero(0.0);
  return (height > zero) | (both_sides & (height < zero));
}

/// The density, per solid angle, of points that are uniform over an area, at the end of `to`. `normal` is as
/// long as the area is large.
template <class D>
OKTETT_INLINE D area_density(const Vec3<D>& to, const Vec3<D>& normal) {
  const D square = dot_lanes(to, to);
  return square * sqrt(square) / abs(dot_lanes(to, normal));
}

/// The sample at the end of `to`, where the emitter lights the point.
template <class D>
OKTETT_INLINE LightSamples<D> lit_samples(const typename D::M& lit, const Vec3<D>& to, const D& pdf,
                                          const D& u, const D& v) {
  LightSamples<D> samples = samples_at(to, pdf, u, v);
  samples.found = samples.found & mask_cast<float>(lit);
  return samples;
}

/// Two edges that leave a corner, in each lane, the corner relative to a point.
template <class D>
struct CornerViews {
  Vec3<D> corner, edge_u, edge_v, normal;
  typename D::M lit;

  OKTETT_INLINE CornerViews(const Vec3<D>& at, const Vec3<D>& u, const Vec3<D>& v,
                            const typename D::M& both_sides)
      : corner(at),
        edge_u(u),
        edge_v(v),
        normal(cross_lanes(u, v)),
        lit(lights_side(-dot_lanes(normal, corner), both_sides)) {}

  OKTETT_INLINE Vec3<D> place(const D& u, const D& v) const { return corner + edge_u * u + edge_v * v; }
};

/// A triangle in each lane.
template <class D>
struct TriangleViews : CornerViews<D> {
  SphericalTriangle<D> seen;
  typename D::M by_angle;  ///< the solid angle is large enough

  OKTETT_INLINE TriangleViews(const Vec3<D>& at, const Vec3<D>& u, const Vec3<D>& v,
                              const typename D::M& both_sides)
      : CornerViews<D>(at, u, v, both_sides),
        seen(at, at + u, at + v),
        by_angle(seen.solid_angle() >= D(kLeastSolidAngle)) {}

  /// Of the direction of `to`, a vector to the triangle; 0 where it does not light the point.
  OKTETT_INLINE D pdf(const Vec3<D>& to) const { return select(this->lit, density(to), D(0.0)); }

  OKTETT_INLINE LightSamples<D> sample(const D& s, const D& t) const {
    const D zero(0.0), one(1.0);
    // Where the direction meets the plane, as weights of the second and third corner; or a place that is
    // uniform over the area.
    const Vec3<D> direction = seen.direction(s, t);
    const D volume = dot_lanes(this->normal, direction), root = sqrt(s);
    D u = within(dot_lanes(cross_lanes(this->edge_v, this->corner), direction) / volume, zero, one);
    D v = within(dot_lanes(cross_lanes(this->corner, this->edge_u), direction) / volume, zero, one - u);
    u = select(by_angle, u, root * (one - t)), v = select(by_angle, v, root * t);
    const Vec3<D> to = this->place(u, v);
    return lit_samples(this->lit, to, density(to), u, v);
  }

 private:
  OKTETT_INLINE D density(const Vec3<D>& to) const {
    return select(by_angle, D(1.0) / seen.solid_angle(), area_density(to, this->normal * D(0.5)));
  }
};

/// A parallelogram in each lane.
template <class D>
struct RectangleViews : CornerViews<D> {
  D length_u, length_v;
  D along_u, along_v;  ///< places of the corner in the plane, from the place below the point
  SphericalRectangle<D> seen;
  typename D::M by_angle;  ///< the edges are perpendicular, and the solid angle is large enough

  OKTETT_INLINE RectangleViews(const Vec3<D>& at, const Vec3<D>& u, const Vec3<D>& v,
                               const typename D::M& both_sides)
      : CornerViews<D>(at, u, v, both_sides),
        length_u(length_lanes(u)),
        length_v(length_lanes(v)),
        along_u(dot_lanes(at, u) / length_u),
        along_v(dot_lanes(at, v) / length_v),
        seen(along_u, along_u + length_u, along_v, along_v + length_v,
             abs(dot_lanes(this->normal, at)) / length_lanes(this->normal)) {
    const D skew = dot_lanes(u, v);
    by_angle = (skew * skew <= D(1e-12) * dot_lanes(u, u) * dot_lanes(v, v)) &
               (seen.solid_angle() >= D(kLeastSolidAngle));
  }

  /// Of the direction of `to`, a vector to the parallelogram; 0 where it does not light the point.
  OKTETT_INLINE D pdf(const Vec3<D>& to) const { return select(this->lit, density(to), D(0.0)); }

  OKTETT_INLINE LightSamples<D> sample(const D& s, const D& t) const {
    const D zero(0.0), one(1.0);
    D x, y;
    seen.place(s, t, x, y);
    const D u = select(by_angle, within((x - along_u) / length_u, zero, one), s);
    const D v = select(by_angle, within((y - along_v) / length_v, zero, one), t);
    const Vec3<D> to = this->place(u, v);
    return lit_samples(this->lit, to, density(to), u, v);
  }

 private:
  OKTETT_INLINE D density(const Vec3<D>& to) const {
    const D pdf = D(1.0) / seen.solid_angle();
    return any(~by_angle) ? select(by_angle, pdf, area_density(to, this->normal)) : pdf;
  }
};

/// A disk in each lane, its center relative to a point.
template <class D>
struct DiskViews {
  Vec3<D> center, normal;  ///< unit normals
  D radius, height;        ///< of the point over the front
  /// 1 - cosine of half the angle of the circle around the place below the point that fits into the disk; 0
  /// if the circle is smaller than its distance.
  D cap;
  typename D::M lit;

  OKTETT_INLINE DiskViews(const Vec3<D>& to_center, const Vec3<D>& front, const D& r,
                          const typename D::M& both_sides)
      : center(to_center),
        normal(unit_lanes(front)),
        radius(r),
        height(-dot_lanes(normal, center)),
        lit(lights_side(height, both_sides)) {
    const D above = abs(height), inner = radius - length_lanes(center + normal * height);
    cap = select(inner > above, D(1.0) - above / sqrt(above * above + inner * inner), D(0.0));
  }

  /// Of the direction of `to`, a vector to the disk; 0 where it does not light the point.
  OKTETT_INLINE D pdf(const Vec3<D>& to) const { return select(lit, density(to), D(0.0)); }

  OKTETT_INLINE LightSamples<D> sample(const D& s, const D& t) const {
    const D zero(0.0), one(1.0), two(2.0);
    const auto has_cap = cap > zero, near = has_cap & (s < D(0.5));
    const Vec3<D> down = select_lanes(height > zero, Vec3<D>{-normal.x, -normal.y, -normal.z}, normal);
    const D depth = two * s * cap;
    const Vec3<D> through_cap = around_lanes(down, depth, t) * (abs(height) / (one - depth));
    Vec3<D> tangent, bitangent;
    basis_lanes(normal, tangent, bitangent);
    D sine, cosine;
    sin_cos_of_turn(t, sine, cosine);
    const D out = radius * sqrt(max(zero, select(has_cap, two * s - one, s)));
    const Vec3<D> over_area = center + tangent * (out * cosine) + bitangent * (out * sine);
    const Vec3<D> to = select_lanes(near, through_cap, over_area);
    return lit_samples(lit, to, density(to), zero, zero);
  }

 private:
  OKTETT_INLINE D density(const Vec3<D>& to) const {
    const D by_area = area_density(to, normal * (D(std::numbers::pi) * radius * radius));
    const auto in_cap = abs(dot_lanes(normal, to)) >= (D(1.0) - cap) * length_lanes(to);
    const D by_cap = select(in_cap, D(0.25 / std::numbers::pi) / cap, D(0.0));
    return select(cap > D(0.0), D(0.5) * by_area + by_cap, by_area);
  }
};

}  // namespace oktett
