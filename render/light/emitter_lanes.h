#pragma once
/// \file Samples of emitters in lanes, see emitter.h. Single points use one lane.

#include "core/elementary.h"
#include "core/lanes.h"
#include "render/light/emitter.h"
#include "render/light/emitter_kinds.h"

namespace oktett {

// ---- What all kinds share.

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

/// One lane, for single points.
using Lane = Simd<double, 1, ScalarIsa>;

/// The sample in a single lane.
std::optional<LightSample> only_sample(const LightSamples<Lane>& s, const Color& radiance);

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

/// Emitters of one kind, one in each lane: members of them in lanes.
template <class D, class Kind>
struct EmitterLanes {
  const void* const* emitter;

  OKTETT_INLINE const Kind& of(int lane) const { return *static_cast<const Kind*>(emitter[lane]); }
  OKTETT_INLINE Vec3<D> operator()(Vec3f Kind::*member) const {
    double x[D::kWidth], y[D::kWidth], z[D::kWidth];
    for (int k = 0; k < D::kWidth; ++k) {
      const Vec3f& v = of(k).*member;
      x[k] = v.x, y[k] = v.y, z[k] = v.z;
    }
    return {D::load(x), D::load(y), D::load(z)};
  }
  OKTETT_INLINE typename D::M operator()(bool Kind::*member) const {
    unsigned flags = 0;
    for (int k = 0; k < D::kWidth; ++k) flags |= (of(k).*member ? 1u : 0u) << k;
    return D::M::from_bits(flags);
  }
  template <class T>
  OKTETT_INLINE D operator()(T Kind::*member) const {
    double x[D::kWidth];
    for (int k = 0; k < D::kWidth; ++k) x[k] = static_cast<double>(of(k).*member);
    return D::load(x);
  }
};

// ---- Spheres, suns, points and spots.

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

// ---- Triangles as seen from points, and directions spread uniformly over them (Arvo 1995, "Stratified
// sampling of spherical triangles").
//
// Departs from the paper in its formulas: solid angle and sub-triangles are computed from half angles, which
// keep their relative accuracy when the triangle is small.

template <class D>
class SphericalTriangle {
 public:
  /// `a`, `b` and `c` are the corners relative to the point.
  OKTETT_INLINE SphericalTriangle(const Vec3<D>& a, const Vec3<D>& b, const Vec3<D>& c)
      : a_(unit_lanes(a)), b_(unit_lanes(b)), c_(unit_lanes(c)) {
    const D la = length_lanes(a), lb = length_lanes(b), lc = length_lanes(c), zero(0.0);
    // The edges do not cancel where the triangle is small and far away.
    const D volume = abs(dot_lanes(a, cross_lanes(sub_lanes(b, a), sub_lanes(c, a))));
    const D half = atan2_lanes(
        volume, la * lb * lc + dot_lanes(a, b) * lc + dot_lanes(b, c) * la + dot_lanes(c, a) * lb);
    half_angle_ = select(volume > zero, half, zero);
  }

  /// In [0, 2 pi]; 0 if the point is in the plane of the triangle or is one of the corners. Computed by the
  /// formula of Van Oosterom and Strackee (1983).
  D solid_angle() const { return D(2.0) * half_angle_; }

  /// Unit vectors; uniform over the triangle if (s, t) is uniform over the unit square. The solid angle must
  /// be > 0.
  OKTETT_INLINE Vec3<D> direction(const D& s, const D& t) const {
    const D zero(0.0), one(1.0), two(2.0);
    // The first number chooses the point d of the arc from a to c for which the triangle a b d has this share
    // of the solid angle. With the angle `corner` at a, tan(arc(ad) / 2) = sin(share / 2) / (tan(arc(ab) / 2)
    // sin(corner - share / 2)).
    const Vec3<D> towards_b = perpendicular(sub_lanes(b_, a_), a_),
                  towards_c = perpendicular(sub_lanes(c_, a_), a_);
    const D cos_corner = dot_lanes(towards_b, towards_c),
            sin_corner = length_lanes(cross_lanes(towards_b, towards_c));
    D sin_share, cos_share;
    sin_cos_of_turn(s * half_angle_ * D(0.5 / std::numbers::pi), sin_share, cos_share);
    const D rest = max(zero, sin_corner * cos_share - cos_corner * sin_share);
    const D opposite = sin_share * length_lanes(a_ + b_), adjacent = length_lanes(sub_lanes(a_, b_)) * rest;
    const D square = opposite * opposite + adjacent * adjacent;
    // The half angle has the tangent opposite / adjacent.
    const D sin_arc = two * opposite * adjacent / square, below_one = two * opposite * opposite / square;
    const Vec3<D> d_minus_a = sub_lanes(towards_c * sin_arc, a_ * below_one);

    // The second number chooses a point of the arc from b to d, uniform in the cosine of its distance from b.
    const Vec3<D> chord = sub_lanes(a_, b_) + d_minus_a;
    const D chord_square = dot_lanes(chord, chord), one_minus_cos = t * chord_square * D(0.5);
    const D sin_angle = sqrt(max(zero, one_minus_cos * (two - one_minus_cos)));
    const Vec3<D> found = unit_lanes(b_ * (one - one_minus_cos) + perpendicular(chord, b_) * sin_angle);
    return select_lanes((square > zero) & (chord_square > zero), found, b_);
  }

 private:
  /// Unit vectors along the parts of `v` that are perpendicular to the unit vectors `axis`.
  static OKTETT_INLINE Vec3<D> perpendicular(const Vec3<D>& v, const Vec3<D>& axis) {
    return unit_lanes(sub_lanes(v, axis * dot_lanes(v, axis)));
  }

  Vec3<D> a_, b_, c_;  ///< unit vectors to the corners
  D half_angle_;
};

// ---- Rectangles as seen from points, and places on them whose directions are spread uniformly (Urena,
// Fajardo, King 2013, "An area-preserving parametrization for spherical rectangles").
//
// Departs from the paper in its formulas: angles between edges are differences of elevations, whose sines and
// cosines need no elementary functions.

/// The rectangle [x0, x1] x [y0, y1] in a plane at distance `z` > 0 from the origin.
template <class D>
class SphericalRectangle {
 public:
  OKTETT_INLINE SphericalRectangle(const D& x0, const D& x1, const D& y0, const D& y1, const D& z)
      : x0_(x0), x1_(x1), y0_(y0), y1_(y1), z_(z), first_(angle_up_to(x0)) {
    solid_angle_ = angle_up_to(x1) - first_;
  }

  /// In (0, 2 pi). The absolute error is about 1e-15.
  const D& solid_angle() const { return solid_angle_; }

  /// Coordinates in the plane for the point (s, t) of the unit square; the directions from the origin are
  /// uniform if the point is uniform.
  OKTETT_INLINE void place(const D& s, const D& t, D& x, D& y) const {
    const D zero(0.0), one(1.0);
    // With the elevations e0 and e1 of the edges y0 and y1, and with c = x / sqrt(x^2 + z^2), the angle up to
    // x is asin(c sin e1) - asin(c sin e0). This is that equation solved for x / z, in a form that keeps its
    // accuracy close to the plane.
    const HalfElevation low(y0_, z_), high(y1_, z_);
    const D sin_difference = high.sine * low.cosine - high.cosine * low.sine;
    const D cos_difference = high.cosine * low.cosine + high.sine * low.sine;
    const D sin_sum = high.sine * low.cosine + high.cosine * low.sine;
    const D cos_sum = high.cosine * low.cosine - high.sine * low.sine;
    const D angle = first_ + s * solid_angle_;
    D sine, cosine;  // of half the angle
    sin_cos_of_turn(abs(angle) * D(0.25 / std::numbers::pi), sine, cosine);
    sine = select(angle < zero, -sine, sine);
    const D square = D(4.0) * (sin_difference * cosine + cos_difference * sine) *
                     (sin_difference * cosine - cos_difference * sine) * (cosine * cos_sum - sine * sin_sum) *
                     (cosine * cos_sum + sine * sin_sum);
    const D whole_sine = D(2.0) * sine * cosine;
    const D far = select(whole_sine < zero, D(-1e300), D(1e300));
    const D tangent = select(square > zero, whole_sine / sqrt(square), far);
    x = within(z_ * tangent, x0_, x1_);

    // In the strip at x the solid angle is uniform in the sine of the elevation.
    const D distance_square = x * x + z_ * z_;
    const D h0 = y0_ / sqrt(distance_square + y0_ * y0_), h1 = y1_ / sqrt(distance_square + y1_ * y1_);
    const D h = h0 + t * (h1 - h0), cosine_square = (one - h) * (one + h);
    const D beyond = select(h < zero, D(-1e300), D(1e300));
    y = within(select(cosine_square > zero, h * sqrt(distance_square / cosine_square), beyond), y0_, y1_);
  }

 private:
  /// Sine and cosine of half the angle whose tangent is y / z.
  struct HalfElevation {
    OKTETT_INLINE HalfElevation(const D& y, const D& z) {
      const D along = z + sqrt(y * y + z * z), scale = D(1.0) / sqrt(along * along + y * y);
      sine = y * scale, cosine = along * scale;
    }
    D sine, cosine;
  };

  /// The solid angle between x = 0 and `x`, negative for x < 0: the difference of two angles below pi / 2,
  /// as the angle between two complex numbers.
  OKTETT_INLINE D angle_up_to(const D& x) const {
    const D low = z_ * sqrt(x * x + y0_ * y0_ + z_ * z_), high = z_ * sqrt(x * x + y1_ * y1_ + z_ * z_);
    // (high + i x y1) times the conjugate of (low + i x y0).
    return atan2_lanes(x * (y1_ * low - y0_ * high), high * low + x * x * y0_ * y1_);
  }

  D x0_, x1_, y0_, y1_, z_;
  D first_, solid_angle_;
};

// ---- Triangles, parallelograms and disks.

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

/// Flat emitters as seen from points.
template <class D>
OKTETT_INLINE TriangleViews<D> view(const EmitterLanes<D, TriangleEmitter>& e, const Vec3<D>& from) {
  const Vec3<D> a = e(&TriangleEmitter::a);
  return {sub_lanes(a, from), sub_lanes(e(&TriangleEmitter::b), a), sub_lanes(e(&TriangleEmitter::c), a),
          e(&TriangleEmitter::both_sides)};
}
template <class D>
OKTETT_INLINE RectangleViews<D> view(const EmitterLanes<D, RectangleEmitter>& e, const Vec3<D>& from) {
  return {sub_lanes(e(&RectangleEmitter::corner), from), e(&RectangleEmitter::edge_u),
          e(&RectangleEmitter::edge_v), e(&RectangleEmitter::both_sides)};
}
template <class D>
OKTETT_INLINE DiskViews<D> view(const EmitterLanes<D, DiskEmitter>& e, const Vec3<D>& from) {
  return {sub_lanes(e(&DiskEmitter::center), from), e(&DiskEmitter::normal), e(&DiskEmitter::radius),
          e(&DiskEmitter::both_sides)};
}

}  // namespace oktett
