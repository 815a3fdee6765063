#pragma once
/// \file Metaballs (M. Melcher, Blobs II): the sum of strength (1 - a^2 / r^2)^2 over balls of finite
/// support, ellipsoids and capsules about segments among them.
///
/// The ray is cut where it enters and leaves the balls, and where the nearest place of a segment comes to an
/// end of it; between two cuts the sum is a quartic of the balls that it is in, added up anew in coordinates
/// that begin at the cut. Where there is only one ball, its surface is a quadric. Each lane goes from cut to
/// cut on its own until a piece may hold a crossing; then all are solved at once.

#include "kernels/exact/cell_tree.h"
#include "kernels/exact/surface_uv.h"
#include "kernels/fields/metaballs_data.h"
#include "kernels/roots/bernstein_lanes.h"

namespace oktett {

/// In own space.
struct Ball {
  static constexpr std::uint32_t kSphere = 0xffffffff;
  Vec3d center;                   ///< of a segment, its first end
  double square, inverse_square;  ///< of the radius, the least one if it is no sphere
  double strength;
  /// Where it is alone, q = 1 - a^2 / r^2 is this on the surface; infinite if there is none.
  double alone;
  std::uint32_t form = kSphere;  ///< in the pool's forms
};

/// A ball that is no sphere: a^2 / r^2 is the square of the distance of rows (p - center) from the segment
/// between the origin and `axis`.
struct BallForm {
  Vec3d row[3];
  Vec3d axis;           ///< 0 of an ellipsoid
  double inverse_axis;  ///< 1 / |axis|^2, or 0
};

struct MetaballsElement {
  double iso;
  double short_way;            ///< pieces of the ray shorter than this do not matter
  std::uint32_t begin, count;  ///< in the pool's balls
  std::uint32_t root;          ///< of the cells
};

struct MetaballsPool : ExactPool<MetaballsElement> {
  std::vector<Ball> balls;
  std::vector<BallForm> forms;
  CellTree tree;
  std::size_t bytes() const {
    return ExactPool::bytes() + balls.size() * sizeof(Ball) + forms.size() * sizeof(BallForm) + tree.bytes();
  }
};

namespace metaballs {

/// Where a line is in a sphere: |s - middle| <= half (NaN if nowhere); q = k - (s - middle)^2 / r^2.
template <class D>
struct Span {
  D middle, half, k;

  Span() = default;
  OKTETT_INLINE Span(const Ball& ball, const CenteredLine<D>& l) {
    const Vec3<D> m = sub_lanes(l.p, broadcast<D>(ball.center));
    middle = -dot_lanes(m, l.u);
    const Vec3<D> miss{m.x + middle * l.u.x, m.y + middle * l.u.y, m.z + middle * l.u.z};
    const D h = D(ball.square) - dot_lanes(miss, miss);
    half = sqrt(h);
    k = h * D(ball.inverse_square);
  }
};

/// A part of a line in one ball, from `enter` to `leave` (NaN if there is none), with one polynomial:
/// q = k - curve (s - middle)^2.
template <class D>
struct Stretch {
  D enter, leave, middle, k;
  D curve, inverse_curve;

  Stretch() = default;
  OKTETT_INLINE Stretch(const Span<D>& span, const Ball& ball)
      : enter(span.middle - span.half),
        leave(span.middle + span.half),
        middle(span.middle),
        k(span.k),
        curve(ball.inverse_square),
        inverse_curve(ball.square) {}
  /// Where 1 - |p + s u|^2 is positive.
  OKTETT_INLINE Stretch(const Vec3<D>& p, const Vec3<D>& u) : curve(dot_lanes(u, u)) {
    const D zero(0.0);
    inverse_curve = D(1.0) / curve;
    middle = select(zero < curve, -(dot_lanes(p, u) * inverse_curve), zero);
    const Vec3<D> miss{p.x + middle * u.x, p.y + middle * u.y, p.z + middle * u.z};
    k = D(1.0) - dot_lanes(miss, miss);
    const D half = sqrt(k * inverse_curve);
    enter = middle - half, leave = middle + half;
  }
  /// Leaves the part between `lo` and `hi`.
  OKTETT_INLINE void cut(const D& lo, const D& hi) {
    enter = select(enter < lo, lo, enter), leave = select(hi < leave, hi, leave);
    const D nan(std::numeric_limits<double>::quiet_NaN());
    const auto some = enter < leave;
    enter = select(some, enter, nan), leave = select(some, leave, nan);
  }
};

/// The parts of a line in a ball that is no sphere; returns how many.
template <class D>
OKTETT_NOINLINE int find_stretches(const Ball& ball, const BallForm& form, const CenteredLine<D>& l,
                                   Stretch<D> (&out)[3]) {
  const auto by_rows = [&](const Vec3<D>& v) {
    return Vec3<D>{dot_lanes(broadcast<D>(form.row[0]), v), dot_lanes(broadcast<D>(form.row[1]), v),
                   dot_lanes(broadcast<D>(form.row[2]), v)};
  };
  const Vec3<D> p = by_rows(sub_lanes(l.p, broadcast<D>(ball.center))), u = by_rows(l.u);
  out[0] = Stretch<D>(p, u);
  if (form.inverse_axis == 0) return 1;
  // The nearest point of the segment is at the fraction h0 + h1 s of its length. Below 0 that is its first
  // end, above 1 its last.
  const Vec3<D> axis = broadcast<D>(form.axis);
  const D zero(0.0), one(1.0), inf(std::numeric_limits<double>::infinity());
  const D h0 = dot_lanes(p, axis) * D(form.inverse_axis), h1 = dot_lanes(u, axis) * D(form.inverse_axis);
  out[1] = Stretch<D>(sub_lanes(p, scale_lanes(axis, h0)), sub_lanes(u, scale_lanes(axis, h1)));
  out[2] = Stretch<D>(sub_lanes(p, axis), u);
  const auto level = abs(h1) < D(0x1p-900), back = ~level & (h1 < zero);
  const D at_first = select(level, select(h0 < zero, inf, -inf), -(h0 / h1));
  const D at_last = select(level, select(one < h0, -inf, inf), (one - h0) / h1);
  out[0].cut(select(back, at_first, -inf), select(back, inf, at_first));
  out[1].cut(select(back, at_last, at_first), select(back, at_first, at_last));
  out[2].cut(select(back, -inf, at_last), select(back, at_last, inf));
  return 3;
}

/// The parts of a ray in the balls of a cell. The first ones are kept, so that each piece need not compute
/// them again.
template <class D>
class Spans {
 public:
  OKTETT_INLINE Spans(const MetaballsPool& pool, const ExactCell& cell, const CenteredLine<D>& line)
      : pool_(pool), list_(pool.tree.lists.data() + cell.begin), count_(cell.count), line_(line) {
    std::uint32_t forms = 0;
    for (std::uint32_t i = 0; i < count_ && i < kKept; ++i) {
      const Ball& b = ball(i);
      if (b.form == Ball::kSphere)
        kept_[i] = Span<D>(b, line);
      else if (forms < kKeptForms)
        counts_[forms] = find_stretches(b, pool.forms[b.form], line, kept_forms_[forms]), ++forms;
    }
  }
  /// Calls f(ball, stretches, count) for each ball.
  template <class F>
  OKTETT_INLINE void each(F&& f) const {
    std::uint32_t forms = 0;
    for (std::uint32_t i = 0; i < count_; ++i) {
      const Ball& b = ball(i);
      if (b.form == Ball::kSphere) {
        const Stretch<D> stretch(i < kKept ? kept_[i] : Span<D>(b, line_), b);
        f(b, &stretch, 1);
        continue;
      }
      Stretch<D> own[3];
      const bool kept = i < kKept && forms < kKeptForms;
      const int count = kept ? counts_[forms] : find_stretches(b, pool_.forms[b.form], line_, own);
      f(b, kept ? kept_forms_[forms] : own, count);
      if (kept) ++forms;
    }
  }

 private:
  static constexpr std::uint32_t kKept = 24, kKeptForms = 8;

  OKTETT_INLINE const Ball& ball(std::uint32_t i) const { return pool_.balls[list_[i]]; }

  const MetaballsPool& pool_;
  const std::uint32_t* list_;
  std::uint32_t count_;
  const CenteredLine<D>& line_;
  Span<D> kept_[kKept];
  Stretch<D> kept_forms_[kKeptForms][3];
  int counts_[kKeptForms];
};

/// a^2 / r^2 at the distance d from the ball's centre, which becomes half its gradient.
template <class D>
OKTETT_INLINE D square_at(const BallForm& form, Vec3<D>& d) {
  Vec3<D> rows[3], y;
  for (int k = 0; k < 3; ++k) rows[k] = broadcast<D>(form.row[k]);
  y = {dot_lanes(rows[0], d), dot_lanes(rows[1], d), dot_lanes(rows[2], d)};
  const Vec3<D> axis = broadcast<D>(form.axis);
  const D along = min(max(dot_lanes(y, axis) * D(form.inverse_axis), D(0.0)), D(1.0));
  y = sub_lanes(y, scale_lanes(axis, along));
  d = add_lanes(add_lanes(scale_lanes(rows[0], y.x), scale_lanes(rows[1], y.y)), scale_lanes(rows[2], y.z));
  return dot_lanes(y, y);
}

/// A piece of a line with the same balls all along: iso minus their sum in powers of the way from its
/// beginning.
template <class D>
struct Piece {
  D c[5], width;
  D balls;         ///< how many
  D middle, half;  ///< if there is one ball: |way - middle| < half is inside
};

/// The piece that begins at s; at most to `end`.
template <class D>
OKTETT_INLINE Piece<D> piece_at(const Spans<D>& spans, const D& s, const D& end, const MetaballsElement& e) {
  Piece<D> p;
  for (int k = 1; k < 5; ++k) p.c[k] = D(0.0);
  p.c[0] = D(e.iso), p.balls = D(0.0), p.middle = p.half = D(0.0);
  const D from = s + D(e.short_way);
  D next = end;
  spans.each([&](const Ball& ball, const Stretch<D>* stretches, int count) __attribute__((always_inline)) {
    for (int part = 0; part < count; ++part) {
      const Stretch<D>& t = stretches[part];
      next = select(t.enter > from, min(t.enter, next), next);
      next = select(t.leave > from, min(t.leave, next), next);
      const auto in = (t.enter <= from) & (t.leave > from);
      if (none(in)) continue;
      // q = a + b x + c x^2, with the way x.
      const D x = s - t.middle;
      const D a = t.k - x * x * t.curve, b = D(-2.0) * x * t.curve, c = -t.curve;
      const D w = select(in, D(ball.strength), D(0.0));
      p.c[0] = p.c[0] - w * (a * a);
      p.c[1] = p.c[1] - w * (D(2.0) * a * b);
      p.c[2] = p.c[2] - w * (b * b + D(2.0) * a * c);
      p.c[3] = p.c[3] - w * (D(2.0) * b * c);
      p.c[4] = p.c[4] - w * (c * c);
      p.balls = select(in, p.balls + D(1.0), p.balls);
      p.middle = select(in, -x, p.middle);
      p.half = select(in, (t.k - D(ball.alone)) * t.inverse_curve, p.half);
    }
  });
  p.half = sqrt(p.half);
  p.width = next - s;
  return p;
}

/// Whether the sum along the line surely stays below iso.
template <class D>
OKTETT_INLINE typename D::M stays_outside(const Spans<D>& spans, const D& a, const D& b, double iso) {
  const D zero(0.0);
  D most = zero;
  spans.each([&](const Ball& ball, const Stretch<D>* stretches, int count) __attribute__((always_inline)) {
    if (!(ball.strength > 0)) return;
    D best = zero;
    for (int part = 0; part < count; ++part) {
      const Stretch<D>& t = stretches[part];
      // Of a sphere what is beyond its ends is negative; other parts end within.
      const D lo = count == 1 ? a : select(a < t.enter, t.enter, a);
      const D hi = count == 1 ? b : select(t.leave < b, t.leave, b);
      const D x = min(max(t.middle, lo), hi) - t.middle;
      const D q = max(t.k - x * x * t.curve, zero);
      best = max(best, count == 1 ? q : select((t.enter < t.leave) & (lo <= hi), q, zero));
    }
    most = most + D(ball.strength) * (best * best);
  });
  return most < D(iso * (1 - 0x1p-30));
}

/// Crossings in a piece, and the sign of the function at its beginning.
template <int R, class D>
struct PieceRoots {
  D x[R], turn[R], begin;
};

/// In pieces of one ball: where its surface is entered and left.
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
    auto open = active & (a <= b) & ~stays_outside(spans, a, b, e.iso);
    if (none(open)) return;
    // Sign of the function before s, 0 if not known; idle lanes compute along.
    D s = select(open, a, D(0.0)), end = select(open, b, D(0.0)), state(0.0);
    while (any(open)) {
      Piece<D> held{{D(1.0), D(0.0), D(0.0), D(0.0), D(0.0)}, D(1.0), D(0.0), D(0.0), D(0.0)};
      auto seeking = open, holds = ~(s == s);
      while (any(seeking)) {
        const Piece<D> p = piece_at(spans, s, end, e);
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
        Vec3<D> d = sub_lanes(p, broadcast<D>(ball.center));
        D square;
        double unit = ball.inverse_square;
        if (ball.form == Ball::kSphere)
          square = dot_lanes(d, d) * D(unit);
        else
          square = metaballs::square_at(pool.forms[ball.form], d), unit = 1;
        const D q = max(D(1.0) - square, D(0.0));
        const D falls = D(4 * ball.strength * unit) * q;
        value = select(lanes, value - D(ball.strength) * (q * q), value);
        gradient = select_lanes(lanes, add_lanes(gradient, scale_lanes(d, falls)), gradient);
      }
    });
  }
  /// Longitude and latitude about the middle of the element's bounds, as for a sphere.
  static SurfaceUv uv(const Pool&, std::size_t, int, const Vec3d& p) { return globe_uv(p); }
};

}  // namespace oktett
