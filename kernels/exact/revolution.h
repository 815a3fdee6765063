#pragma once
/// \file Surfaces of revolution about the y axis (Melcher): x^2 + z^2 - f(y)^2 = 0.
///
/// Each piece of the profile has a cell of its own, a slab of height, and its own polynomial. What keeps the
/// pieces together is that at each height where two of them meet, it is decided once whether the ray is
/// inside there, by numbers that both have in common; the crossings in between are then made to agree.

#include <optional>

#include "kernels/exact/ray_polynomial.h"
#include "kernels/exact/revolution_data.h"
#include "kernels/exact/round_profile.h"
#include "kernels/exact/segment.h"

namespace oktett {

struct RevolutionElement {
  /// The lower or upper end of a piece.
  struct End {
    double height;
    double here2, beyond2;  ///< squared radius on this side and beyond
    bool listed;            ///< this piece lists crossings with the plane between the two radii
    int part;               ///< of the plane facing down; one more faces up
  };
  struct Piece {
    End ends[2];
    double c[4];              ///< of the radius, or its square, in powers of v, -1 <= v <= 1
    double middle, per_half;  ///< v = (y - middle) per_half
    double greatest2;         ///< bound on the squared radius, a little more than that
  };
  std::vector<Piece> pieces;
  int degree;    ///< of c
  bool squared;  ///< whether c gives the squared radius
  bool closed;   ///< by disks, or as it begins and ends on the axis
};

/// Parts: 0 the surface; 1 + 2 k and 2 + 2 k the planes at height k facing down and up.
struct Revolution {
  using Data = RevolutionShape;
  using Pool = ExactPool<RevolutionElement>;
  static constexpr int kMaxCrossings = 9;

  static void add(Pool& pool, const RevolutionShape& shape, const ExactPlace& place);

  template <int K, class D>
  static void crossings(const Pool& pool, const ExactCell& cell, const Line<D>& line,
                        const LineRange<D>& range, const typename D::M& active, Crossings<K, D>& out) {
    const RevolutionElement& e = pool.elements[cell.element];
    const RevolutionElement::Piece& piece = e.pieces[cell.begin];
    // The part inside of the cylinder around the piece. A ray along the axis is not cut.
    const D dd = line.d.x * line.d.x + line.d.z * line.d.z;
    const D nearest = -((line.o.x * line.d.x + line.o.z * line.d.z) / dd);
    const D x = line.o.x + nearest * line.d.x, z = line.o.z + nearest * line.d.z;
    const D room = D(piece.greatest2) - (x * x + z * z), reach = sqrt(max(room, D(0.0)) / dd);
    const auto slants = dd > D(0x1p-100) * (line.d.y * line.d.y);
    LineRange<D> part = range;
    part.a = select(slants, max(range.a, nearest - reach), range.a);
    part.b = select(slants, min(range.b, nearest + reach), range.b);
    const auto there = active & (~slants | (room >= D(0.0))) & (part.a <= part.b);
    out.clear();
    if (none(there)) return;
    const RaySegment<D> segment(line, part);
    D c[7];
    const int degree = substitute(e, piece, segment, c);
    // Inside at the beginning and the end: surely not where the ray enters the cylinder or leaves it.
    const Plane<D> enter = at_plane(piece, line, range.enter_face, there & (part.a == range.a));
    const Plane<D> exit = at_plane(piece, line, range.exit_face, there & (part.b == range.b));
    const auto begins = there & (range.enter_face == D(0.0)) & (part.a == range.a);
    constexpr int R = K == 1 ? 1 : 6;
    D s[R], turn[R];
    sign_changes<R>(c, degree, roots::Method::automatic, there, s, turn);
    const auto crosses = s[0] < D(roots::kNoRoot);
    // Where the ray begins here, it is what it must be for the first crossing, or as at the end.
    const auto inside_first = (crosses & (turn[0] > D(0.0))) | (~crosses & exit.here);
    auto inside = (begins & inside_first) | (~begins & enter.here);
    CrossingList<K, D> list(out);
    const auto lists = [&](const Plane<D>& plane) { return there & plane.listed & plane.differs; };
    list.push(lists(enter), range.a, select(enter.here, D(-1.0), D(1.0)), enter.part);
    if constexpr (K == 1) {
      const auto odd = there & crosses & differ(turn[0] > D(0.0), inside);
      if (OKTETT_UNLIKELY(any(odd))) {
        D all[2], turns[2];
        sign_changes<2>(c, degree, roots::Method::automatic, odd, all, turns);
        s[0] = select(odd, all[1], s[0]);
        turn[0] = select(odd, turns[1], turn[0]);
      }
    }
    const auto none_left = ~(s[0] < D(roots::kNoRoot));
    for (int k = 0; k < R; ++k) {
      const auto changes = there & (s[k] < D(roots::kNoRoot)) & ~differ(turn[k] > D(0.0), inside);
      list.push(changes, segment.to_t(s[k]), turn[k], D(0.0));
      inside = (changes & (turn[k] < D(0.0))) | (~changes & inside);
    }
    // A crossing so near to one of the ends that it was not found.
    auto lost = there & differ(inside, exit.here);
    if (K == 1) lost = lost & none_left;
    const auto at_a = ~crosses & ~differ(common_sign(c, degree) < D(0.0), exit.here);
    list.push(lost, select(at_a, part.a, part.b), select(exit.here, D(-1.0), D(1.0)), D(0.0));
    list.push(lists(exit), range.b, select(exit.here, D(1.0), D(-1.0)), exit.part);
    list.finish(D(roots::kNoRoot));
  }

  /// Classifies x^2 + z^2 - f(y)^2 of the cell's piece. Its Bernstein coefficients are made of products of
  /// those of x, z and f.
  template <class F>
  OKTETT_INLINE static SegmentVerdict<F> classify(const Pool& pool, const ExactCell& cell,
                                                  const Segment<F>& s, F& at) {
    const RevolutionElement& e = pool.elements[cell.element];
    const RevolutionElement::Piece& piece = e.pieces[cell.begin];
    // Bounds on the polynomial of the piece and on its slope, also a little beyond |v| = 1.
    double size = 0, rise = 0;
    for (int k = 0; k <= e.degree; ++k)
      size += 1.25 * std::fabs(piece.c[k]), rise += 1.25 * k * std::fabs(piece.c[k]);
    const double v_error = piece.per_half * (s.error + 0x1p-20);
    if (!(v_error < 0.03)) {
      at = F(0.5f);
      const auto nothing = F::M::from_bits(0);
      return {nothing, nothing, nothing};
    }
    const double reach = std::sqrt(piece.greatest2) + 0.25;
    const F margin(static_cast<float>(5 * reach * s.error +
                                      0x1p-18 * (reach * reach + size * (e.squared ? 1 : size)) +
                                      rise * v_error * (e.squared ? 1 : 2.1 * size)));
    const F middle(static_cast<float>(piece.middle)), per_half(static_cast<float>(piece.per_half));
    const F v = (s.a.y - middle) * per_half, w = (s.b.y - middle) * per_half;
    const F q[3] = {fast_fma(s.a.x, s.a.x, s.a.z * s.a.z), fast_fma(s.a.x, s.b.x, s.a.z * s.b.z),
                    fast_fma(s.b.x, s.b.x, s.b.z * s.b.z)};
    SegmentVerdict<F> verdict;
    typename F::M inside_all;
    const auto finish = [&]<int M>(const F(&c)[M]) {
      verdict = classify_polynomial(c, margin, at);
      F most = c[0];
      for (int k = 1; k < M; ++k) most = max(most, c[k]);
      inside_all = most < -margin;
      // A line that is inside from the beginning may have entered in another cell.
      verdict.inside = verdict.inside & (margin < c[0]);
    };
    F f[4];
    blossoms(piece, e.degree, v, w, f);
    if (e.squared) {
      const F third(1 / 3.0f), twice = q[1] + q[1];
      const F c[4] = {q[0] - f[0], fast_fms(q[0] + twice, third, f[1]), fast_fms(twice + q[2], third, f[2]),
                      q[2] - f[3]};
      finish(c);
    } else if (e.degree == 1) {
      const F c[3] = {q[0] - f[0] * f[0], q[1] - f[0] * f[1], q[2] - f[1] * f[1]};
      finish(c);
    } else {
      const F a(0.4f), b(0.6f), tenth(0.1f), fifth(0.2f);
      const F c[7] = {q[0] - f[0] * f[0],
                      F(2 / 3.0f) * q[0] + F(1 / 3.0f) * q[1] - f[0] * f[1],
                      a * q[0] + F(8 / 15.0f) * q[1] + F(1 / 15.0f) * q[2] -
                          (fifth * F(2.0f) * f[0] * f[2] + b * f[1] * f[1]),
                      fifth * (q[0] + q[2]) + b * q[1] - (tenth * f[0] * f[3] + F(0.9f) * f[1] * f[2]),
                      a * q[2] + F(8 / 15.0f) * q[1] + F(1 / 15.0f) * q[0] -
                          (fifth * F(2.0f) * f[1] * f[3] + b * f[2] * f[2]),
                      F(2 / 3.0f) * q[2] + F(1 / 3.0f) * q[1] - f[2] * f[3],
                      q[2] - f[3] * f[3]};
      finish(c);
    }
    if (!(2 * reach + rise * piece.per_half * (e.squared ? 1 : 2 * size) < 64))
      verdict.falls = F::M::from_bits(0);
    // A line that is inside from end to end crosses only planes, and this piece lists none.
    if (!piece.ends[0].listed && !piece.ends[1].listed) verdict.misses = verdict.misses | inside_all;
    return verdict;
  }

  template <class D>
  OKTETT_INLINE static D value(const Pool& pool, const ExactCell& cell, const Vec3<D>& p) {
    const RevolutionElement& e = pool.elements[cell.element];
    const RevolutionElement::Piece& piece = e.pieces[cell.begin];
    const D v = (p.y - D(piece.middle)) * D(piece.per_half);
    D f = D(piece.c[e.degree]);
    for (int n = e.degree; n > 0; --n) f = f * v + D(piece.c[n - 1]);
    return (p.x * p.x + p.z * p.z) - (e.squared ? f : f * f);
  }

  template <class D>
  OKTETT_INLINE static void slope(const Pool& pool, std::size_t i, const D& part, const Vec3<D>& p, D& value,
                                  Vec3<D>& gradient) {
    const RevolutionElement& e = pool.elements[i];
    constexpr int W = D::kWidth;
    double heights[W], parts[W], c[4][W], middle[W], per_half[W], height[W];
    p.y.store(heights), part.store(parts);
    const std::size_t count = e.pieces.size();
    for (int k = 0; k < W; ++k) {
      std::size_t at = 0;
      while (at + 1 < count && heights[k] > e.pieces[at].ends[1].height) ++at;
      const RevolutionElement::Piece& piece = e.pieces[at];
      for (int n = 0; n < 4; ++n) c[n][k] = piece.c[n];
      middle[k] = piece.middle, per_half[k] = piece.per_half;
      const std::size_t plane = parts[k] > 0 ? (static_cast<std::size_t>(parts[k]) - 1) / 2 : 0;
      height[k] = plane < count ? e.pieces[plane].ends[0].height : e.pieces[count - 1].ends[1].height;
    }
    const D scale = D::load(per_half), v = (p.y - D::load(middle)) * scale;
    D f = D::load(c[e.degree]), rise(0.0);
    for (int n = e.degree; n > 0; --n) rise = rise * v + f, f = f * v + D::load(c[n - 1]);
    rise = rise * scale;
    const D inside = e.squared ? f : f * f;
    value = (p.x * p.x + p.z * p.z) - inside;
    gradient = {D(2.0) * p.x, e.squared ? -rise : D(-2.0) * f * rise, D(2.0) * p.z};
    const auto plane = part > D(0.0);
    if (none(plane)) return;
    // Odd parts face down.
    const D level = p.y - D::load(height);
    double down[W];
    for (int k = 0; k < W; ++k) down[k] = static_cast<int>(parts[k]) % 2 == 1 ? -1 : 1;
    const D side = D::load(down);
    value = select(plane, side * level, value);
    gradient = select_lanes(plane, Vec3<D>{D(0.0), side, D(0.0)}, gradient);
  }
  static bool inside(const Pool& pool, std::size_t i, const Vec3d& p);
  /// u around the axis from +z towards +x, v the height, both in [0, 1].
  static SurfaceUv uv(const Pool& pool, std::size_t i, int part, const Vec3d& p);
  /// See ExactOps::closest.
  static SurfaceNearest closest(const Pool& pool, std::size_t i, const Affine& to_world, const Vec3d& p);
  static bool is_kept_by(const Affine& to_world);

 private:
  /// What is known where a ray passes an end of a piece.
  template <class D>
  struct Plane {
    typename D::M here;     ///< inside on this side
    typename D::M differs;  ///< but not beyond, or the other way round
    typename D::M listed;
    D part;
  };

  /// The Bernstein coefficients of a piece's polynomial from v to w: values of its polar form.
  template <class F>
  OKTETT_INLINE static void blossoms(const RevolutionElement::Piece& piece, int degree, const F& v,
                                     const F& w, F (&f)[4]) {
    const auto c = [&](int k) { return F(static_cast<float>(piece.c[k])); };
    if (degree == 1) {
      f[0] = fast_fma(c(1), v, c(0)), f[1] = fast_fma(c(1), w, c(0));
      return;
    }
    const F third(1 / 3.0f), c0 = c(0), c1 = c(1) * third, c2 = c(2) * third, c3 = c(3);
    const auto polar = [&](const F& x, const F& y, const F& z) {
      const F xy = x * y, sum = x + y;
      return fast_fma(c1, sum + z, fast_fma(c2, fast_fma(sum, z, xy), fast_fma(c3, xy * z, c0)));
    };
    f[0] = polar(v, v, v), f[1] = polar(v, v, w), f[2] = polar(v, w, w), f[3] = polar(w, w, w);
  }

  template <class M>
  OKTETT_INLINE static M differ(const M& a, const M& b) {
    return (a & ~b) | (~a & b);
  }

  /// `face` is 3 in lanes that pass the lower end, 4 for the upper one; in others nothing is inside.
  template <class D>
  OKTETT_INLINE static Plane<D> at_plane(const RevolutionElement::Piece& piece, const Line<D>& line,
                                         const D& face, const typename D::M& active) {
    const RevolutionElement::End &low = piece.ends[0], &high = piece.ends[1];
    const auto top = face == D(4.0), passes = active & (top | (face == D(3.0)));
    const D t = (select(top, D(high.height), D(low.height)) - line.o.y) / line.d.y;
    const D x = line.o.x + t * line.d.x, z = line.o.z + t * line.d.z, q = x * x + z * z;
    Plane<D> out;
    out.here = passes & (q < select(top, D(high.here2), D(low.here2)));
    out.differs = passes & differ(out.here, q < select(top, D(high.beyond2), D(low.beyond2)));
    out.listed = passes & ((top & D::M::from_bits(high.listed ? ~0u : 0)) |
                           (~top & D::M::from_bits(low.listed ? ~0u : 0)));
    // It faces away from the inside.
    const D up = select(differ(out.here, top), D(0.0), D(1.0));
    out.part = select(top, D(high.part), D(low.part)) + up;
    return out;
  }

  /// x^2 + z^2 - f(y)^2 in powers of s; returns its degree.
  template <class D>
  OKTETT_INLINE static int substitute(const RevolutionElement& e, const RevolutionElement::Piece& piece,
                                      const RaySegment<D>& segment, D* c) {
    const D per_half(piece.per_half);
    const D m = (segment.m.y - D(piece.middle)) * per_half, h = segment.h.y * per_half;
    D f[4];
    f[0] = D(piece.c[e.degree]);
    for (int i = 1; i <= e.degree; ++i) {
      times_linear(f, i - 1, m, h);
      f[0] = f[0] + D(piece.c[e.degree - i]);
    }
    const int degree = e.squared ? e.degree : 2 * e.degree;
    for (int k = 0; k <= degree; ++k) c[k] = D(0.0);
    for (int i = 0; i <= e.degree; ++i) {
      if (e.squared) {
        c[i] = -f[i];
        continue;
      }
      c[2 * i] = c[2 * i] - f[i] * f[i];
      for (int k = i + 1; k <= e.degree; ++k) c[i + k] = c[i + k] - D(2.0) * f[i] * f[k];
    }
    c[0] = c[0] + (segment.m.x * segment.m.x + segment.m.z * segment.m.z);
    c[1] = c[1] + D(2.0) * (segment.m.x * segment.h.x + segment.m.z * segment.h.z);
    c[2] = c[2] + (segment.h.x * segment.h.x + segment.h.z * segment.h.z);
    return degree;
  }
};

/// A height at which the radius is negative, if there is one: the profile must not cross the axis.
std::optional<double> profile_crosses_axis(const RevolutionShape& shape);

}  // namespace oktett
