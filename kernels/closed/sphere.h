#pragma once
/// \file Spheres: the geometric method (the default) and the algebraic one.

#include <cmath>
#include <numbers>

#include "core/elementary.h"
#include "kernels/closed/contract.h"

namespace oktett {

struct Sphere : NumberedShape<Sphere, 4> {
  static constexpr int kRoots = 2;
  using Data = SpheresShape;
  static constexpr bool kNeedsSimilarity = true;

  template <class D>
  struct Lanes {
    Vec3<D> center;
    D radius;
  };
  template <class D, class Number>
  OKTETT_INLINE static Lanes<D> lanes(const Number& number) {
    return {{number(0), number(1), number(2)}, number(3)};
  }
  static std::array<double, 4> numbers(const SphereShape& s) {
    return {s.center.x, s.center.y, s.center.z, s.radius};
  }

  static std::size_t count(const SpheresShape& data) { return data.spheres.size(); }
  static const SphereShape& nth(const SpheresShape& data, std::size_t i) { return data.spheres[i]; }

  static bool is_empty(const SphereShape& s) { return !(s.radius > 0); }
  static SphereShape moved(const SphereShape& s, const Affine& m) {
    return {m.point(s.center), s.radius * m.uniform_scale()};
  }
  static SphereShape shape(const Pool& p, std::size_t i) {
    const auto s = broadcast<double>(p, i);
    return {s.center, s.radius};
  }

  /// Where the line of a ray comes closest to the centre, in multiples of its direction, and the square of
  /// half the chord, as a length; negative where the line passes by.
  template <class D>
  struct Chord {
    D middle, square;
  };

  /// `inverse`: one over the square of the ray's direction. The square is taken from the distance vector
  /// itself, not from a difference of squares, so that small far spheres stay sharp (Haines et al., Ray
  /// Tracing Gems 7).
  template <class D>
  OKTETT_INLINE static Chord<D> chord(const RayLanes<D>& ray, const D& inverse, const Lanes<D>& s) {
    const Vec3<D> m = sub_lanes(s.center, ray.o);
    const D closest = dot_lanes(m, ray.d) * inverse;
    const Vec3<D> miss{m.x - closest * ray.d.x, m.y - closest * ray.d.y, m.z - closest * ray.d.z};
    return {closest, s.radius * s.radius - dot_lanes(miss, miss)};
  }

  /// The geometric method: the middle of the chord, then half of it.
  template <class D>
  OKTETT_INLINE static typename D::M roots(const RayLanes<D>& ray, const Lanes<D>& s, D (&t)[2]) {
    // A product instead of two quotients: compilers find the inverse once for all the spheres of a leaf.
    const D inverse = D(1.0) / dot_lanes(ray.d, ray.d);
    const Chord<D> c = chord(ray, inverse, s);
    const auto meets = D(0.0) <= c.square;
    if (none(meets)) return meets;
    set_roots(c, inverse, t);
    return meets;
  }

  /// A bound on the roots that are on a ray which ends at `tmax`: they are rounded to float before they are
  /// compared with it. `T` is double or lanes of it.
  template <class T>
  OKTETT_INLINE static T last_root(const T& tmax) {
    using std::abs;
    return tmax + (abs(tmax) * T(0x1p-22) + T(0x1p-148));
  }

  /// The same roots, but lanes in which none is on the ray may be left out: most spheres that the line of a
  /// ray in flight meets lie behind it or beyond its end, which shows before the square root. `end` is
  /// last_root() of the ray's end.
  template <class D>
  OKTETT_INLINE static typename D::M roots_in_range(const RayLanes<D>& ray, const D& inverse, const D& end,
                                                    const Lanes<D>& s, D (&t)[2]) {
    const Chord<D> c = chord(ray, inverse, s);
    // How far the middle of the chord lies outside of the ray; negative inside. Half the chord is compared
    // with it by squares, with room for their rounding.
    const D gap = max(ray.tmin - c.middle, c.middle - end);
    const auto outside = (D(0.0) < gap) & (c.square * inverse < gap * gap * D(1 - 0x1p-40));
    const auto maybe = (D(0.0) <= c.square) & ~outside;
    if (none(maybe)) return maybe;
    set_roots(c, inverse, t);
    return maybe;
  }

  /// Both ends of a chord, in order.
  template <class D>
  OKTETT_INLINE static void set_roots(const Chord<D>& c, const D& inverse, D (&t)[2]) {
    const D half = sqrt(c.square * inverse);
    t[0] = c.middle - half, t[1] = c.middle + half;
  }

  /// The algebraic method: |o + t d - c|^2 = r^2 solved as a quadratic, with the root of lesser magnitude
  /// from the product of the roots (no cancellation). Same contract as `roots`; kept for comparison.
  template <class D>
  OKTETT_INLINE static typename D::M roots_algebraic(const RayLanes<D>& ray, const Lanes<D>& s, D (&t)[2]) {
    const Vec3<D> m = sub_lanes(s.center, ray.o);
    const D a = dot_lanes(ray.d, ray.d);
    const D b = dot_lanes(m, ray.d);
    const D c = dot_lanes(m, m) - s.radius * s.radius;
    const D discriminant = b * b - a * c;
    const auto meets = D(0.0) <= discriminant;
    if (none(meets)) return meets;
    const D root = sqrt(discriminant);
    const D q = select(b < D(0.0), b - root, b + root);
    const D t0 = q / a, t1 = select(q == D(0.0), t0, c / q);
    t[0] = min(t0, t1);
    t[1] = max(t0, t1);
    return meets;
  }

  static Box bounds(const SphereShape& s) {
    if (!(s.radius > 0) || !is_finite(s.center)) return {};
    // `roots` finds hits a few roundings outside of the sphere, too.
    const double r = s.radius + 0x1p-45 * (s.radius + max_component(abs(s.center)));
    return {round_down(s.center - Vec3d{r, r, r}), round_up(s.center + Vec3d{r, r, r})};
  }
  static Box bounds(const Pool& p, std::size_t i) { return bounds(shape(p, i)); }

  static bool inside(const Pool& p, std::size_t i, const Vec3d& q) {
    const auto [center, radius] = broadcast<double>(p, i);
    const Vec3d m = q - center;
    return dot(m, m) < radius * radius;
  }

  /// To the centre the point along +z is nearest.
  static SurfaceNearest closest(const SphereShape& s, const Affine& to_world, const Vec3d& p) {
    const Vec3d center = to_world.point(s.center);
    const double radius = s.radius * to_world.uniform_scale(), away = length(p - center);
    const Vec3d n = away > 0 ? (p - center) / away : Vec3d{0, 0, 1};
    return {(away - radius) * (away - radius), center + n * radius, n};
  }

  /// Moving the point onto the sphere removes the error along the normal.
  template <class D, class Fetch>
  OKTETT_INLINE static SurfacePoints<D> surface(const Pool& p, const Fetch& fetch, const HitPoints<D>& hit) {
    const auto s = lanes<D>([&](int k) { return fetch(p.number[k]); });
    const Vec3<D> n = unit_lanes(sub_lanes(hit.point(), s.center));
    return {add_lanes(s.center, scale_lanes(n, s.radius)), D(0x1p-48) * (length_lanes(s.center) + s.radius),
            n};
  }

  /// Longitude from +x towards +z and latitude from the south pole, both scaled to [0, 1], where the normal
  /// is `n`.
  template <class D>
  OKTETT_INLINE static void uv_lanes(const Vec3<D>& n, D& u, D& v) {
    const D one(1.0), half(0.5), pi(std::numbers::pi);
    u = half + atan2_lanes(n.z, n.x) * half / pi;
    v = half + asin_lanes(within(n.y, -one, one)) / pi;
  }
  static void uv(const Pool& p, std::size_t i, const Vec3d& hit, const Vec3d&, SurfaceInteraction& s) {
    using D = Simd<double, 1, ScalarIsa>;
    const auto [center, radius] = broadcast<double>(p, i);
    const Vec3d n = normalize(hit - center);
    D u, v;
    uv_lanes(oktett::broadcast<D>(n), u, v);
    s.uv = {static_cast<float>(only_lane(u)), static_cast<float>(only_lane(v))};
    s.tangent = Vec3f(Vec3d{-n.z, 0, n.x} * (2 * std::numbers::pi * radius));
    const double across = std::sqrt(n.x * n.x + n.z * n.z), turn = std::numbers::pi * radius;
    if (across > 0) s.bitangent = Vec3f(Vec3d{-n.y * n.x / across, across, -n.y * n.z / across} * turn);
  }
};

}  // namespace oktett
