#pragma once
/// \file Metaballs (M. Melcher, Blobs II): the sum of strength (1 - a^2 / r^2)^2 over balls of finite
/// support.
///
/// The ray is cut where it enters and leaves the balls; between two cuts the sum is a quartic of the balls
/// that it is in, added up anew in coordinates that begin at the cut. Where there is only one ball, the
/// surface is a sphere. Each lane goes from cut to cut on its own until a piece may hold a crossing; then all
/// are solved at once.

#include "kernels/exact/cell_tree.h"
#include "kernels/exact/surface_uv.h"
#include "kernels/fields/metaballs_data.h"
#include "kernels/roots/bernstein_lanes.h"

namespace oktett {

/// In own space.
struct Ball {
  Vec3d center;
  double square, inverse_square;  ///< of the radius
  double strength;
  /// Where it is alone, q = 1 - a^2 / r^2 is this on the surface; infinite if there is none.
  double alone;
};

struct MetaballsElement {
  double iso;
  double short_way;            ///< pieces of the ray shorter than this do not matter
  std::uint32_t begin, count;  ///< in the pool's balls
  std::uint32_t root;          ///< of the cells
};

struct MetaballsPool : ExactPool<MetaballsElement> {
  std::vector<Ball> balls;
  CellTree tree;
  std::size_t bytes() const { return ExactPool::bytes() + balls.size() * sizeof(Ball) + tree.bytes(); }
};

namespace metaballs {

/// Where a line is in a ball: |s - middle| <= half (NaN if nowhere); q = k - (s - middle)^2 / r^2.
template <class D>
struct Span {
  D middle, half, k;

  Span() = default;
  OKTETT_INLINE Span(const Ball& ball, const CenteredLine<D>& l) {
    const Vec3<D> m{l.p.x - D(ball.center.x), l.p.y - D(ball.center.y), l.p.z - D(ball.center.z)};
    middle = -dot_lanes(m, l.u);
    const Vec3<D> miss{m.x + middle * l.u.x, m.y + middle * l.u.y, m.z + middle * l.u.z};
    const D h = D(ball.square) - dot_lanes(miss, miss);
    half = sqrt(h);
    k = h * D(ball.inverse_square);
  }
};

/// The spans of a ray in the balls of a cell. The first ones are kept, so that each piece need not compute
/// them again.
template <class D>
class Spans {
 public:
  static constexpr std::uint32_t kKept = 24;

  OKTETT_INLINE Spans(const MetaballsPool& pool, const ExactCell& cell, const CenteredLine<D>& line)
      : balls_(pool.balls.data()), list_(pool.tree.lists.data() + cell.begin), line_(line) {
    for (std::uint32_t i = 0; i < cell.count && i < kKept; ++i) kept_[i] = Span<D>(ball(i), line);
  }
  OKTETT_INLINE const Ball& ball(std::uint32_t i) const { return balls_[list_[i]]; }
  OKTETT_INLINE Span<D> operator[](std::uint32_t i) const {
    return i < kKept ? kept_[i] : Span<D>(ball(i), line_);
  }

 private:
  const Ball* balls_;
  const std::uint32_t* list_;
  const CenteredLine<D>& line_;
  Span<D> kept_[kKept];
};

/// A piece of a line with the same balls all along: iso minus their sum in powers of the way from its
/// beginning.
template <class D>
struct Piece {
  D c[5], width;
  D balls;         ///< how many
  D middle, half;  ///< of the sphere, if there is one ball: |way - middle| < half is inside
};

/// The piece that begins at s; at most to `end`.
template <class D>
OKTETT_INLINE Piece<D> piece_at(const Spans<D>& spans, std::uint32_t count, const D& s, const D& end,
                                const MetaballsElement& e) {
  Piece<D> p;
  for (int k = 1; k < 5; ++k) p.c[k] = D(0.0);
  p.c[0] = D(e.iso), p.balls = D(0.0), p.middle = p.half = D(0.0);
  const D from = s + D(e.short_way);
  D next = end;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Span<D> span = spans[i];
    const Ball& ball = spans.ball(i);
    const D enter = span.middle - span.half, leave = span.middle + span.half;
    next = select(enter > from, min(enter, next), next);
    next = select(leave > from, min(leave, next), next);
    const auto in = (enter <= from) & (leave > from);
    if (none(in)) continue;
    // q = a + b x + c x^2, with the way x.
    const D x = s - span.middle, inverse(ball.inverse_square);
    const D a = span.k - x * x * inverse, b = D(-2.0) * x * inverse, c = -inverse;
    const D w = select(in, D(ball.strength), D(0.0));
    p.c[0] = p.c[0] - w * (a * a);
    p.c[1] = p.c[1] - w * (D(2.0) * a * b);
    p.c[2] = p.c[2] - w * (b * b + D(2.0) * a * c);
    p.c[3] = p.c[3] - w * (D(2.0) * b * c);
    p.c[4] = p.c[4] - w * (c * c);
    p.balls = select(in, p.balls + D(1.0), p.balls);
    p.middle = select(in, -x, p.middle);
    p.half = select(in, (span.k - D(ball.alone)) * D(ball.square), p.half);
  }
  p.half = sqrt(p.half);
  p.width = next - s;
  return p;
}

/// Whether the sum along the line surely stays below iso.
template <class D>
OKTETT_INLINE typename D::M stays_outside(const Spans<D>& spans, std::uint32_t count, const D& a, const D& b,
                                          double iso) {
  D most(0.0);
  for (std::uint32_t i = 0; i < count; ++i) {
    const Ball& ball = spans.ball(i);
    if (!(ball.strength > 0)) continue;
    const Span<D> span = spans[i];
    const D x = min(max(span.middle, a), b) - span.middle;
    const D q = max(span.k - x * x * D(ball.inverse_square), D(0.0));
    most = most + D(ball.strength) * (q * q);
  }
  return most < D(iso * (1 - 0x1p-30));
}

/// Crossings in a piece, and the sign of the function at its beginning.
template <int R, class D>
struct PieceRoots {
  D x[R], turn[R], begin;
};

/// In pieces of one ball: where the sphere is entered and left.
template <int R, class D>
OKTETT_INLINE PieceRoots<R, D> sphere_roots(const Piece<D>& p) {
  const D none(roots::kNoRoot), zero(0.0), lo = p.middle - p.half, hi = p.middle + p.half;
  const auto lo_in = (lo >= zero) & (lo <= p.width), hi_in = (hi >= zero) & (hi <= p.width) & (lo < hi);
  PieceRoots<R, D> r;
  for (int i = 0; i < R; ++i) r.x[i] = none, r.turn[i] = D(1.0);
  r.x[0] = select(lo_in, lo, select(hi_in, hi, none));
  r.turn[0] = select(lo_in, D(-1.0), D(1.0));
  if constexpr (R > 1) r.x[1] = select(lo_in & hi_in, hi, none);
  r.begin = select((lo < zero) & (hi >= zero), D(-1.0), D(1.0));
  return r;
}

template <int R, class D>
OKTETT_INLINE PieceRoots<R, D> quartic_roots(const Piece<D>& p, const typename D::M& wanted) {
  const auto found = roots::certified_roots<4, R, roots::Touching::drop>(p.c, D(0.0), p.width, wanted);
  PieceRoots<R, D> r;
  for (int i = 0; i < R; ++i) {
    const D x = select(found.x[i] < D(roots::kNoRoot), found.x[i], D(0.0));
    const D slope = ((D(4.0) * p.c[4] * x + D(3.0) * p.c[3]) * x + D(2.0) * p.c[2]) * x + p.c[1];
    r.x[i] = found.x[i];
    r.turn[i] = select(slope < D(0.0), D(-1.0), D(1.0));
  }
  const D w = p.width, end = (((p.c[4] * w + p.c[3]) * w + p.c[2]) * w + p.c[1]) * w + p.c[0];
  r.begin = select(r.x[0] < D(roots::kNoRoot), -r.turn[0], select(p.c[0] + end < D(0.0), D(-1.0), D(1.0)));
  return r;
}

/// Lanes in which the piece surely has no crossing; `sign` is that of the function.
template <class D>
OKTETT_INLINE typename D::M surely_clear(const Piece<D>& p, const PieceRoots<1, D>& sphere, D& sign) {
  D b[5];
  b[0] = p.c[0];
  D power = p.width, size = abs(b[0]);
  for (int k = 1; k < 5; ++k) {
    b[k] = p.c[k] * power;
    size = size + abs(b[k]);
    power = power * p.width;
  }
  roots::lanes::to_bernstein<4>(b);
  const D error = size * D(0x1p-44);
  auto above = b[0] > error, below = b[0] < -error;
  for (int k = 1; k < 5; ++k) above = above & (b[k] > error), below = below & (b[k] < -error);
  const auto one = p.balls == D(1.0);
  sign = select(one, sphere.begin, select(below, D(-1.0), D(1.0)));
  return (one & ~(sphere.x[0] < D(roots::kNoRoot))) | (~one & (above | below));
}

}  // namespace metaballs

struct Metaballs {
  using Data = MetaballsShape;
  using Pool = MetaballsPool;
  static constexpr int kMaxCrossings = 8;

  static void add(Pool& pool, const MetaballsShape& shape, const ExactPlace& place);

  template <int K, class D>
  static void crossings(const Pool& pool, const ExactCell& cell, const Line<D>& line,
                        const LineRange<D>& range, const typename D::M& active, Crossings<K, D>& out) {
    static_assert(K == 1 || K >= 4);
    constexpr int R = K == 1 ? 1 : 4;
    using namespace metaballs;
    const MetaballsElement& e = pool.elements[cell.element];
    const CenteredLine<D> l(line);
    const D a = l.to_s(range.a), b = l.to_s(range.b);
    const Spans<D> spans(pool, cell, l);
    CrossingList<K, D> list(out);
    auto open = active & (a <= b) & ~stays_outside(spans, cell.count, a, b, e.iso);
    if (none(open)) return;
    // Sign of the function before s, 0 if not known; idle lanes compute along.
    D s = select(open, a, D(0.0)), end = select(open, b, D(0.0)), state(0.0);
    while (any(open)) {
      Piece<D> held{{D(1.0), D(0.0), D(0.0), D(0.0), D(0.0)}, D(1.0), D(0.0), D(0.0), D(0.0)};
      auto seeking = open, holds = ~(s == s);
      while (any(seeking)) {
        const Piece<D> p = piece_at(spans, cell.count, s, end, e);
        D sign;
        const auto clear = surely_clear(p, sphere_roots<1>(p), sign);
        const auto pass = seeking & clear & ((state == sign) | (state == D(0.0)));
        const auto hold = seeking & ~pass;
        for (int k = 0; k < 5; ++k) held.c[k] = select(hold, p.c[k], held.c[k]);
        held.width = select(hold, p.width, held.width), held.balls = select(hold, p.balls, held.balls);
        held.middle = select(hold, p.middle, held.middle), held.half = select(hold, p.half, held.half);
        holds = holds | hold;
        state = select(pass, sign, state);
        const auto last = ~(s + p.width < end);
        s = select(pass, s + p.width, s);
        open = open & ~(pass & last);
        seeking = pass & ~last;
      }
      if (none(holds)) break;
      const auto one = held.balls == D(1.0);
      PieceRoots<R, D> r = sphere_roots<R>(held);
      if (any(holds & ~one)) {
        const PieceRoots<R, D> q = quartic_roots<R>(held, holds & ~one);
        for (int i = 0; i < R; ++i)
          r.x[i] = select(one, r.x[i], q.x[i]), r.turn[i] = select(one, r.turn[i], q.turn[i]);
        r.begin = select(one, r.begin, q.begin);
      }
      // Signs tell a crossing that falls into the gap between two pieces.
      const auto push = [&](const typename D::M& where, const D& x, const D& turn) {
        const D t = l.to_t(s + x);
        list.push(where & (t >= range.a) & ~(state == turn) & ~(state == D(0.0)), t, turn, D(0.0));
        state = select(where, turn, state);
      };
      push(holds, D(0.0), r.begin);
      for (int i = 0; i < R; ++i) push(holds & (r.x[i] < D(roots::kNoRoot)), r.x[i], r.turn[i]);
      D way = held.width;
      // A crossing before the range leads on to the next one.
      if constexpr (R == 1) way = select(r.x[0] < way, min(r.x[0] + D(e.short_way), way), way);
      const auto last = ~(s + way < end);
      s = select(holds, s + way, s);
      open = open & ~(holds & last) & (list.count < D(K));
    }
    // A full list may have left out some.
    out.up_to = select(list.count < D(K), D(roots::kNoRoot), out.t[K - 1]);
  }

  template <class D>
  static void slope(const Pool& pool, std::size_t i, const D&, const Vec3<D>& p, D& value,
                    Vec3<D>& gradient) {
    const MetaballsElement& e = pool.elements[i];
    value = D(e.iso), gradient = {D(0.0), D(0.0), D(0.0)};
    pool.tree.each_leaf(e.root, p, [&](const CellNode& node, const typename D::M& lanes) {
      const bool listed = node.kind == CellNode::Kind::leaf;
      const std::uint32_t* list = pool.tree.lists.data() + node.first;
      for (std::uint32_t k = 0; k < (listed ? node.second : e.count); ++k) {
        const Ball& ball = pool.balls[listed ? list[k] : e.begin + k];
        const Vec3<D> d = sub_lanes(p, broadcast<D>(ball.center));
        const D q = max(D(1.0) - dot_lanes(d, d) * D(ball.inverse_square), D(0.0));
        const D falls = D(4 * ball.strength * ball.inverse_square) * q;
        value = select(lanes, value - D(ball.strength) * (q * q), value);
        gradient = select_lanes(lanes, add_lanes(gradient, scale_lanes(d, falls)), gradient);
      }
    });
  }
  /// Longitude and latitude about the middle of the element's bounds, as for a sphere.
  static SurfaceUv uv(const Pool&, std::size_t, int, const Vec3d& p) { return globe_uv(p); }
};

}  // namespace oktett
