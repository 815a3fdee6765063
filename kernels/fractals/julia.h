#pragma once
/// \file Filled Julia sets of q^2 + c or q^3 + c after a number of iterations, in the quaternions (A. Norton:
/// Generation and Display of Geometric Fractals in 3-D, 1982) or hypercomplex numbers, solved by enclosures
/// along the ray (kernels/exact/march.h).
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
///
/// The same bounds over balls divide the space into cells, of which those surely outside or inside are left
/// out.

#include "kernels/exact/cell_tree.h"
#include "kernels/exact/march.h"
#include "kernels/fractals/julia_data.h"

namespace oktett {

struct JuliaElement {
  double c[4];
  double slice;
  double radius;  ///< R
  int iterations;
  int power;
  bool hypercomplex;
  double size;  ///< of the box about all cells

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
    if (e.power == 2)
      return {two * ((r * w.r - i * w.i) - (j * w.j + k * w.k)), two * (r * w.i + w.r * i),
              two * (r * w.j + w.r * j), two * (r * w.k + w.r * k)};
    const D s = (i * i + j * j) + k * k, turn = two * ((i * w.i + j * w.j) + k * w.k), rr = three * (r * r);
    const D m = rr - s, by = D(6.0) * (r * w.r) - turn;
    return {(rr - three * s) * w.r - three * (r * turn), by * i + m * w.i, by * j + m * w.j,
            by * k + m * w.k};
  }
  /// The image.
  OKTETT_INLINE JuliaNumber next(const JuliaElement& e) const {
    const D two(2.0), three(3.0);
    JuliaNumber q;
    if (e.hypercomplex) {
      q = hyper(*this);
      if (e.power == 3) q = q.hyper(*this);
    } else if (e.power == 2) {
      q = {(r * r - i * i) - (j * j + k * k), two * (r * i), two * (r * j), two * (r * k)};
    } else {
      const D s = (i * i + j * j) + k * k, m = three * (r * r) - s;
      q = {r * (r * r - three * s), m * i, m * j, m * k};
    }
    return {q.r + D(e.c[0]), q.i + D(e.c[1]), q.j + D(e.c[2]), q.k + D(e.c[3])};
  }
  template <class M>
  OKTETT_INLINE void set(const M& where, const JuliaNumber& q) {
    r = select(where, q.r, r), i = select(where, q.i, i), j = select(where, q.j, j),
    k = select(where, q.k, k);
  }
};

/// |z_n|^2 - R^2 along rays.
template <class D>
struct JuliaField {
  const JuliaElement& e;
  Vec3<D> o, d;

  /// Roundings are below this, relative; one iteration makes fewer than eight, of cubes fewer than 32.
  static constexpr double kRound = 0x1p-49, kRoundOfCubes = 0x1p-47;
  static constexpr double kHuge = 1e40;
  static constexpr bool kCentred = true;

  using Number = JuliaNumber<D>;

  /// A little more than the root: roots of floats take a third of the time of those of doubles.
  static OKTETT_INLINE D root_above(const D& square) {
    return to_double(sqrt(to_float(square))) * D(1 + 0x1p-22) + D(0x1p-62);
  }
  double sum_of_c() const {
    return std::abs(e.c[0]) + std::abs(e.c[1]) + std::abs(e.c[2]) + std::abs(e.c[3]);
  }

  /// Enclosures of value and derivative on |h| <= half about o + m d. Where the point surely escapes, what
  /// is told of it is positive and no more than the value.
  OKTETT_INLINE Dual<Interval<D>> about(const D& m, const D& half) const {
    const D zero(0.0), two(2.0), three(3.0), u(e.power == 2 ? kRound : kRoundOfCubes), product(e.product()),
        radius(e.radius * (1 + 0x1p-40)), limit(e.radius * e.radius);
    Number z{o.x + m * d.x, o.y + m * d.y, o.z + m * d.z, D(e.slice)}, w{d.x, d.y, d.z, zero};
    const D far = root_above((o.x * o.x + o.y * o.y) + o.z * o.z);
    D eps = u * (far + root_above(z.norm2())), phi = zero, escaped_by = zero;
    auto escaped = m == m;
    escaped = escaped & ~escaped;
    auto lost = escaped;
    const D cc(sum_of_c());
    for (int n = 0; n <= e.iterations; ++n) {
      const D zz = z.norm2(), length = root_above(zz), slope = root_above(w.norm2());
      const D r = slope * half + eps, out = radius + r;
      const auto leaves = ~escaped & ~lost & (zz > out * out);
      escaped_by = select(leaves, zz - limit, escaped_by), escaped = escaped | leaves;
      lost = lost | ~(length + r + slope + phi < D(kHuge));
      const auto stays = ~(escaped | lost);
      if (n == e.iterations || none(stays)) break;
      const D all = slope + phi;
      // What has escaped or is lost goes on as anything: to hold it where it was would make each step wait.
      if (e.power == 2) {
        eps = product * (two * length * eps + r * r) + u * (zz + cc + length * slope * half);
        phi = product * (two * (length * phi + r * all)) + u * length * slope;
      } else {
        const D squared = product * product;
        const D off = three * zz * eps + (three * length + r) * (r * r);
        const D turn = three * (zz * phi + (two * length + r) * r * all);
        eps = squared * off + u * (zz * length + cc + zz * slope * half);
        phi = squared * turn + u * zz * slope;
      }
      w = z.next_slope(e, w), z = z.next(e);
    }
    const D zz = z.norm2(), length = root_above(zz), slope = root_above(w.norm2()), r = slope * half + eps;
    const D by_h = z.twice_along(w);
    const D off = abs(by_h) * half + two * length * eps + u * (zz + limit) + u * length * slope * half;
    const D turn = two * (slope * r + (length + r) * phi) + u * length * slope;
    const D value = zz - limit, huge(kHuge * kHuge);
    const auto told = ~(escaped | lost);
    const D low = select(told, value - off, select(escaped, escaped_by * D(1 - 0x1p-40), -huge));
    const D high = select(told, value + off + r * r, select(escaped, max(escaped_by, low), huge));
    return {{low, high}, {select(told, by_h - turn, -huge), select(told, by_h + turn, huge)}};
  }

  OKTETT_INLINE Dual<Interval<D>> over(const Interval<D>& s) const {
    const D m = s.lo + (s.hi - s.lo) * D(0.5);
    return about(m, max(s.hi - m, m - s.lo) * D(1 + 0x1p-50));
  }
  /// The value of about(s, 0), without the derivative and what it takes.
  OKTETT_INLINE Interval<D> at(const D& s) const {
    const D zero(0.0), two(2.0), three(3.0), u(e.power == 2 ? kRound : kRoundOfCubes), product(e.product()),
        radius(e.radius * (1 + 0x1p-40)), limit(e.radius * e.radius);
    Number z{o.x + s * d.x, o.y + s * d.y, o.z + s * d.z, D(e.slice)};
    const D far = root_above((o.x * o.x + o.y * o.y) + o.z * o.z), cc(sum_of_c());
    D zz = z.norm2(), length = root_above(zz), eps = u * (far + length), escaped_by = zero;
    auto escaped = s == s;
    escaped = escaped & ~escaped;
    auto lost = escaped;
    for (int n = 0;; ++n) {
      const D out = radius + eps;
      const auto leaves = ~escaped & ~lost & (zz > out * out);
      escaped_by = select(leaves, zz - limit, escaped_by), escaped = escaped | leaves;
      lost = lost | ~(length + eps < D(kHuge));
      const auto stays = ~(escaped | lost);
      if (n == e.iterations || none(stays)) break;
      eps = e.power == 2 ? product * (two * length * eps + eps * eps) + u * (zz + cc)
                         : product * product * (three * zz * eps + (three * length + eps) * (eps * eps)) +
                               u * (zz * length + cc);
      z = z.next(e);
      zz = z.norm2(), length = root_above(zz);
    }
    const D value = zz - limit, off = two * length * eps + u * (zz + limit), huge(kHuge * kHuge);
    const auto told = ~(escaped | lost);
    const D low = select(told, value - off, select(escaped, escaped_by * D(1 - 0x1p-40), -huge));
    return {low, select(told, value + off + eps * eps, select(escaped, max(escaped_by, low), huge))};
  }
};

struct JuliaPool : ExactPool<JuliaElement> {
  CellTree tree;
  std::size_t bytes() const { return ExactPool::bytes() + tree.bytes(); }
};

/// Whether a Julia set has no points, as far as balls of a 64th of its bounds tell.
bool is_empty(const JuliaShape& shape);

struct Julia {
  using Data = JuliaShape;
  using Pool = JuliaPool;
  static constexpr int kMaxCrossings = 16;
  /// Rays that were mirrored or bent are rarely in one cell, and square roots of many lanes take long.
  static constexpr bool kLoneLanes = true;

  static void add(Pool& pool, const JuliaShape& shape, const ExactPlace& place);

  template <int K, class D>
  static void crossings(const Pool& pool, const ExactCell& cell, const Line<D>& line,
                        const LineRange<D>& range, const typename D::M& active, Crossings<K, D>& out) {
    const JuliaElement& e = pool.elements[cell.element];
    const D zero(0.0), length = range.b - range.a;
    const D whole = D(e.size) / sqrt(dot_lanes(line.d, line.d));
    const auto place = [&](const D& o, const D& d) { return o + range.a * d; };
    const JuliaField<D> field{
        e, {place(line.o.x, line.d.x), place(line.o.y, line.d.y), place(line.o.z, line.d.z)}, line.d};
    interval::march<K>(field, zero, length, length, max(length, whole), active, interval::Jumps::list, out);
    place_crossings(out, [&](const D& s) { return range.a + s; });
    for (D& part : out.part) part = D(0.0);
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
      z.set(stays, z.next(e));
    }
    value = z.norm2() - D(e.radius * e.radius);
    gradient = {z.twice_along(w[0]), z.twice_along(w[1]), z.twice_along(w[2])};
  }
};

}  // namespace oktett
