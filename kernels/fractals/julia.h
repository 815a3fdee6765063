#pragma once
/// \file Filled Julia sets of q^2 + c or q^3 + c after a number of iterations, in the quaternions (A. Norton:
/// Generation and Display of Geometric Fractals in 3-D, 1982) or hypercomplex numbers, solved by enclosures
/// along the ray (kernels/exact/piece_march.h).
///
/// With z_0 = q and z_k+1 = z_k^p + c, the surface is where |z_n| = R, which is (1 + sqrt(1 + 4 |c|)) / 2 or
/// more; what is farther out never comes back. Along a piece of the ray, h from its middle with |h| <= d,
/// each iterate is enclosed as z + w h + e with |e| <= eps, and its derivative as w + f with |f| <= phi (a
/// Taylor model of degree 1: K. Makino, M. Berz 2003). With |ab| <= K |a| |b| and r = |w| d + eps
///   eps' = K (2 |z| eps + r^2),   phi' = 2 K (|z| phi + r (|w| + phi))
/// for squares, and for cubes, with two products each,
///   eps' = K^2 (3 |z|^2 eps + 3 |z| r^2 + r^3),   phi' = 3 K^2 (|z|^2 phi + (2 |z| r + r^2) (|w| + phi)),
/// to which the roundings of z and w are added. K is 1 for quaternions. Hypercomplex numbers are pairs of
/// complex ones u and v, multiplied one by one, with |q|^2 = (|u|^2 + |v|^2) / 2: there K is the root of 2,
/// and |q^p| >= |q|^p, so that R is the same. A piece of which all has |z_k| > R for some k is outside. So no
/// estimate of a distance is trusted, and no step is made that is not proved.

#include "kernels/exact/line_columns.h"
#include "kernels/exact/piece_march.h"
#include "kernels/fractals/julia_data.h"

namespace oktett {

/// What describes a set, in numbers of T, and bounds on what their rounding does. With |w| half <= r the
/// roundings of an iteration are below u (|z|^2 + |c| + |z| r) for squares and u (|z|^3 + |c| + |z|^2 r) for
/// cubes. They are taken where z is: R may be far greater, and floats would tell nothing.
template <class T>
struct JuliaNumbers {
  T c[4], slice;
  T limit;       ///< R^2
  T outside;     ///< what is farther out has left R, whatever its square is rounded to
  T round;       ///< u
  T product;     ///< K or K^2, rounded up
  T c_rounding;  ///< u |c|
};

struct JuliaElement {
  double c[4];
  double slice;
  double radius;  ///< R
  int iterations;
  int power;
  bool hypercomplex;
  double size;  ///< of the box about all
  JuliaNumbers<double> in_doubles;
  JuliaNumbers<float> in_floats;

  template <class T>
  const JuliaNumbers<T>& numbers() const {
    if constexpr (std::is_same_v<T, float>)
      return in_floats;
    else
      return in_doubles;
  }
  /// |ab| <= product() |a| |b|.
  double product() const { return hypercomplex ? 1.4142135623730952 : 1.0; }
};

/// A number r + i i + j j + k k.
template <class D>
struct JuliaNumber {
  D r, i, j, k;

  OKTETT_INLINE D norm2() const { return (r * r + i * i) + (j * j + k * k); }
  /// Twice the part along w.
  OKTETT_INLINE D twice_along(const JuliaNumber& w) const {
    return D(2.0) * ((r * w.r + i * w.i) + (j * w.j + k * w.k));
  }
  /// The product in the hypercomplex numbers.
  OKTETT_INLINE JuliaNumber hyper(const JuliaNumber& w) const {
    return {(r * w.r - i * w.i) - (j * w.j - k * w.k), (r * w.i + i * w.r) - (j * w.k + k * w.j),
            (r * w.j + j * w.r) - (k * w.i + i * w.k), (r * w.k + k * w.r) + (i * w.j + j * w.i)};
  }
  OKTETT_INLINE JuliaNumber times(const D& x) const { return {r * x, i * x, j * x, k * x}; }
  /// The derivative of the image where that of the number is w.
  OKTETT_INLINE JuliaNumber next_slope(const JuliaElement& e, const JuliaNumber& w) const {
    const D two(2.0), three(3.0);
    if (e.hypercomplex) return e.power == 2 ? hyper(w).times(two) : hyper(*this).hyper(w).times(three);
    if (e.power == 2) {
      const D r2 = two * r, by = two * w.r;
      return {two * ((r * w.r - i * w.i) - (j * w.j + k * w.k)), r2 * w.i + by * i, r2 * w.j + by * j,
              r2 * w.k + by * k};
    }
    const D s = (i * i + j * j) + k * k, turn = two * ((i * w.i + j * w.j) + k * w.k), rr = three * (r * r);
    const D m = rr - s, by = D(6.0) * (r * w.r) - turn;
    return {(rr - three * s) * w.r - three * (r * turn), by * i + m * w.i, by * j + m * w.j,
            by * k + m * w.k};
  }
  /// The image.
  template <class T>
  OKTETT_INLINE JuliaNumber next(const JuliaElement& e, const T (&c)[4]) const {
    const D two(2.0), three(3.0);
    JuliaNumber q;
    if (e.hypercomplex) {
      q = hyper(*this);
      if (e.power == 3) q = q.hyper(*this);
    } else if (e.power == 2) {
      const D r2 = two * r;
      q = {(r * r - i * i) - (j * j + k * k), r2 * i, r2 * j, r2 * k};
    } else {
      const D s = (i * i + j * j) + k * k, m = three * (r * r) - s;
      q = {r * (r * r - three * s), m * i, m * j, m * k};
    }
    return {q.r + D(c[0]), q.i + D(c[1]), q.j + D(c[2]), q.k + D(c[3])};
  }
  template <class M>
  OKTETT_INLINE void set(const M& where, const JuliaNumber& q) {
    r = select(where, q.r, r), i = select(where, q.i, i), j = select(where, q.j, j),
    k = select(where, q.k, k);
  }
};

/// |z_n|^2 - R^2 along a ray, in lanes of D.
template <class D>
class JuliaField {
 public:
  using T = typename D::Element;

  OKTETT_INLINE JuliaField(const JuliaElement& e, const Vec3d& o, const Vec3d& d)
      : e_(e),
        n_(e.numbers<T>()),
        o_{D(static_cast<T>(o.x)), D(static_cast<T>(o.y)), D(static_cast<T>(o.z))},
        d_{D(static_cast<T>(d.x)), D(static_cast<T>(d.y)), D(static_cast<T>(d.z))},
        far_(root_above((o_.x * o_.x + o_.y * o_.y) + o_.z * o_.z)) {}

  /// Enclosures of value and derivative on |h| <= half about o + m d. Where the point surely escapes, what
  /// is told of it is positive and no more than the value.
  OKTETT_INLINE Dual<Interval<D>> about(const D& m, const D& half) const {
    const D two(2), three(3), u(n_.round), limit(n_.limit), product(n_.product), least(n_.c_rounding);
    Number z = place(m), w{d_.x, d_.y, d_.z, D(0)};
    // What rounding makes of the direction.
    D slope = root_above(w.norm2()), phi = u * slope, eps = first_error(z) + phi * half, r(0);
    Escape escape(n_);
    for (int n = 0;; ++n) {
      const D zz = z.norm2(), length = root_above(zz);
      slope = root_above(w.norm2()), r = slope * half + eps;
      // What has escaped goes on as anything: to hold it where it was would make each step wait. Where eps or
      // phi become too great they stay so.
      escape.look(zz, r);
      if (n == e_.iterations || escape.all()) break;
      const D all = slope + phi, rounded = phi + u * slope;
      if (e_.power == 2) {
        eps = product * (two * length * eps + r * (r + u * length)) + (u * zz + least);
        phi = two * product * (length * rounded + r * all);
      } else {
        const D cubic = (three * length + r) * r + u * zz;
        eps = product * (three * zz * eps + cubic * r) + (u * length * zz + least);
        phi = three * product * (zz * rounded + (two * length + r) * r * all);
      }
      w = z.next_slope(e_, w), z = z.next(e_, n_.c);
    }
    const D zz = z.norm2(), length = root_above(zz), by_h = z.twice_along(w);
    const D off = abs(by_h) * half + two * length * eps + u * (zz + limit) + u * length * slope * half;
    const D turn = two * (slope * r + (length + r) * phi) + u * length * slope;
    const D value = zz - limit, huge(kHuge * kHuge);
    const auto told = ~escape.escaped() & (r + phi < D(kHuge));
    const Interval<D> f = escape.enclosure(told, value - off, value + off + r * r);
    return {f, {select(told, by_h - turn, -huge), select(told, by_h + turn, huge)}};
  }

  /// Those of a piece.
  OKTETT_INLINE Dual<Interval<D>> over(const Interval<D>& s) const {
    const D m = s.lo + (s.hi - s.lo) * D(T(0.5));
    return about(m, max(s.hi - m, m - s.lo) * D(kAboveOne));
  }

  /// The value of about(s, 0), without the derivative and what it takes.
  OKTETT_INLINE Interval<D> at(const D& s) const {
    const D two(2), three(3), u(n_.round), limit(n_.limit), product(n_.product), least(n_.c_rounding);
    Number z = place(s);
    D zz = z.norm2(), length = root_above(zz), eps = first_error(z);
    Escape escape(n_);
    for (int n = 0;; ++n) {
      escape.look(zz, eps);
      if (n == e_.iterations || escape.all()) break;
      if (e_.power == 2)
        eps = product * ((two * length + eps) * eps) + (u * zz + least);
      else
        eps = product * ((three * zz + (three * length + eps) * eps) * eps) + (u * length * zz + least);
      z = z.next(e_, n_.c);
      zz = z.norm2(), length = root_above(zz);
    }
    const D value = zz - limit, off = two * length * eps + u * (zz + limit);
    return escape.enclosure(~escape.escaped() & (eps < D(kHuge)), value - off, value + off + eps * eps);
  }

  /// A little more than 1.
  static constexpr T kAboveOne = std::is_same_v<T, float> ? 1 + 0x1p-22 : 1 + 0x1p-50;

 private:
  static constexpr T kHuge = std::is_same_v<T, float> ? 0x1p30 : 1e40;

  using Number = JuliaNumber<D>;

  /// A little more than the root: roots of floats take a third of the time of those of doubles.
  static OKTETT_INLINE D root_above(const D& square) {
    const D above(T(1 + 0x1p-22)), tiny(T(0x1p-62));
    if constexpr (std::is_same_v<T, float>)
      return sqrt(square) * above + tiny;
    else
      return to_double(sqrt(to_float(square))) * above + tiny;
  }

  OKTETT_INLINE Number place(const D& s) const {
    return {o_.x + s * d_.x, o_.y + s * d_.y, o_.z + s * d_.z, D(n_.slice)};
  }
  /// What rounding makes of the place itself, and of the numbers that it is made of.
  OKTETT_INLINE D first_error(const Number& z) const { return D(n_.round) * (far_ + root_above(z.norm2())); }

  /// Which points surely leave the radius R, and by how much at least where they first do.
  struct Escape {
    D by, radius;  ///< `by` is positive where they do
    explicit OKTETT_INLINE Escape(const JuliaNumbers<T>& n) : by(0), radius(n.outside) {}
    /// An iterate is within r of one of the square zz.
    OKTETT_INLINE void look(const D& zz, const D& r) {
      const D out = radius + r;
      by = select(escaped(), by, zz - out * out * D(kAboveOne));
    }
    OKTETT_INLINE typename D::M escaped() const { return D(0) < by; }
    OKTETT_INLINE bool all() const { return none(~escaped()); }
    /// [low, high] where that is told, else what is known of what has escaped, or nothing.
    OKTETT_INLINE Interval<D> enclosure(const typename D::M& told, const D& low, const D& high) const {
      const D huge(kHuge * kHuge), outside = min(by, huge);
      return {select(told, low, select(escaped(), outside, -huge)),
              select(told, high, select(escaped(), outside, huge))};
    }
  };

  const JuliaElement& e_;
  const JuliaNumbers<T>& n_;
  Vec3<D> o_, d_;
  D far_;  ///< at least |o|
};

/// The same in doubles at places that are not negative, and roughly in floats: half of the registers, and
/// roots without conversions. The scalar set asks lane by lane, as its registers hold one.
template <class D>
class JuliaRayField {
 public:
  using F = Simd<float, D::kWidth, typename D::Isa>;

  OKTETT_INLINE JuliaRayField(const JuliaElement& e, const Vec3d& o, const Vec3d& d)
      : field_(e, o, d), rough_(e, o, d) {}

  OKTETT_INLINE Dual<Interval<D>> over(const Interval<D>& s) const {
    if constexpr (kTogether) {
      return field_.over(s);
    } else {
      Dual<Interval<D>> all;
      for (int i = 0; i < D::kWidth; ++i) {
        const auto f = field_.over({lane(s.lo, i), lane(s.hi, i)});
        put(f.v, all.v, i), put(f.d, all.d, i);
      }
      return all;
    }
  }
  OKTETT_INLINE Interval<D> at(const D& s) const { return at_each(field_, s); }
  OKTETT_INLINE Dual<Interval<F>> over_roughly(const double* ends) const {
    constexpr int n = D::kWidth;
    double middle[n];
    for (int i = 0; i < n; ++i) middle[i] = ends[i] + (ends[i + 1] - ends[i]) * 0.5;
    // Also what is lost where the middles become floats.
    const auto half =
        static_cast<float>((ends[n] - ends[0]) * ((1 + 0x1p-20) / (2 * n)) + (ends[0] + ends[n]) * 0x1p-23);
    const F m = to_float(D::load(middle));
    if constexpr (kTogether) {
      return rough_.about(m, F(half));
    } else {
      Dual<Interval<F>> all;
      for (int i = 0; i < n; ++i) {
        const auto f = rough_.about(lane(m, i), half);
        put(f.v, all.v, i), put(f.d, all.d, i);
      }
      return all;
    }
  }
  OKTETT_INLINE Interval<F> at_roughly(const double* places) const {
    return at_each(rough_, to_float(D::load(places)));
  }

 private:
  using A = typename D::Isa;
  static constexpr bool kTogether = D::kLanesPerPart > 1;
  template <class S>
  using Asked = std::conditional_t<kTogether, S, Simd<typename S::Element, 1, A>>;

  template <class Field, class S>
  static OKTETT_INLINE Interval<S> at_each(const Field& field, const S& s) {
    if constexpr (kTogether) {
      return field.at(s);
    } else {
      Interval<S> all;
      for (int i = 0; i < S::kWidth; ++i) put(field.at(lane(s, i)), all, i);
      return all;
    }
  }
  template <class S>
  static OKTETT_INLINE Asked<S> lane(const S& s, int i) {
    Asked<S> one;
    one.part[0] = s.part[i];
    return one;
  }
  template <class One, class S>
  static OKTETT_INLINE void put(const Interval<One>& one, Interval<S>& all, int i) {
    all.lo.part[i] = one.lo.part[0], all.hi.part[i] = one.hi.part[0];
  }

  JuliaField<Asked<D>> field_;
  JuliaField<Asked<F>> rough_;
};

/// Whether a Julia set has no points, as far as balls of a 64th of its bounds tell.
bool is_empty(const JuliaShape& shape);

struct Julia {
  using Data = JuliaShape;
  using Pool = ExactPool<JuliaElement>;
  static constexpr int kMaxCrossings = 16;
  static constexpr bool kOneCell = true;

  static void add(Pool& pool, const JuliaShape& shape, const ExactPlace& place);

  template <int K, class D>
  static void crossings(const Pool& pool, const ExactCell& cell, const Line<D>& line,
                        const LineRange<D>& range, const typename D::M& active, Crossings<K, D>& out) {
    using A = typename D::Isa;
    using Field = JuliaRayField<Simd<double, 8, A>>;
    const JuliaElement& e = pool.elements[cell.element];
    const LineColumns<D> rays(line, range);
    CrossingColumns<K, D> lists;
    for (unsigned rest = bits(active); rest != 0; rest &= rest - 1) {
      const int lane = __builtin_ctz(rest);
      const double a = rays.a(lane), length = rays.b(lane) - a;
      const Vec3d d = rays.d(lane);
      const Field field(e, rays.o(lane) + d * a, d);
      const double size = std::max(length, e.size / std::sqrt(dot(d, d)));
      const interval::PieceMarch<K, Field, Simd<double, 8, A>> march(field, 0, length, length, size);
      int k = 0;
      march.each(size * 0x1p-42, [&](double x, double before) {
        lists.t[k][lane] = a + x, lists.turn[k][lane] = -before, ++k;
      });
      const double up_to = march.up_to();
      if (up_to < roots::kNoRoot) lists.up_to[lane] = a + up_to;
    }
    lists.load(out);
  }

  /// |z_n|^2 - R^2 and its gradient; farther out, those of the iterate that leaves.
  template <class D>
  OKTETT_INLINE static void slope(const Pool& pool, std::size_t i, const D&, const Vec3<D>& p, D& value,
                                  Vec3<D>& gradient) {
    const JuliaElement& e = pool.elements[i];
    const D zero(0.0), one(1.0);
    using Q = JuliaNumber<D>;
    Q z{p.x, p.y, p.z, D(e.slice)},
        w[3] = {{one, zero, zero, zero}, {zero, one, zero, zero}, {zero, zero, one, zero}};
    for (int n = 0; n < e.iterations; ++n) {
      const auto stays = z.norm2() < D(0x1p20);
      if (none(stays)) break;
      for (Q& v : w) v.set(stays, z.next_slope(e, v));
      z.set(stays, z.next(e, e.c));
    }
    value = z.norm2() - D(e.radius * e.radius);
    gradient = {z.twice_along(w[0]), z.twice_along(w[1]), z.twice_along(w[2])};
  }
};

}  // namespace oktett
