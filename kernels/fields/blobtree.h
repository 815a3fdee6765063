#pragma once
/// \file Blob trees: potentials of skeletons, blended by sums, maxima, minima and differences. The crossings
/// are isolated by interval arithmetic along the ray (kernels/exact/march.h).
///
/// The tree is a program for a stack machine, cut down in each cell to what matters there: elements that are
/// zero, and branches that are surely below or above what they are blended with, are left out.

#include <cstdint>
#include <vector>

#include "kernels/exact/cell_tree.h"
#include "kernels/exact/exact.h"
#include "kernels/exact/march.h"
#include "kernels/exact/surface_uv.h"
#include "kernels/fields/blobtree_data.h"
#include "kernels/interval/dual.h"

namespace oktett {

// ---- Distances from skeletons along a line and the potentials that fall with them, as intervals in lanes.
//
// Everything is in terms of R, the square of the distance in units of the element. What describes R along a
// line is computed in plain double: it is that of a line moved by some 2^-49 of the element's own space.
// From there on all is enclosed.

/// An element of a blob tree in own space.
struct FieldPart {
  enum class Shape : std::uint8_t { point, segment, polygon };
  Shape shape = Shape::point;
  PotentialKind kind = PotentialKind::wyvill;
  double d = 0, weight = 1;
  Vec3d origin;  ///< centre of a point, beginning of a segment, a corner of a polygon
  /// R of a point is |rows (p - origin)|^2, ellipsoids have rows of different lengths. The rows of polygons
  /// are two directions in its plane and its normal, of unit length.
  Vec3d row[3];
  Vec3d axis;                             ///< of a segment, to its end
  double axis_square = 0;                 ///< |axis|^2
  double inverse_axis = 0;                ///< 1 / |axis|^2; 0 if it has no length
  double unit_square = 1;                 ///< R per square of distance, for segments and polygons
  double reach = 0;                       ///< about how far the potential reaches
  std::uint32_t corner = 0, corners = 0;  ///< of a polygon, in its plane
};

namespace field {

/// Beyond this value of R a Gaussian counts as zero: it is below 2^-63 there.
inline constexpr double kGaussianEnd = 44;
/// Nearer than this to its skeleton 1 / R grows no more.
inline constexpr double kLeastSquare = 0x1p-200;

/// Square of the distance from a segment along a line: a (s - s0)^2 + m across, and the square of what
/// h0 + h1 s exceeds [0, 1] by, times `length`, along it.
template <class D>
struct SegmentTrack {
  D a, s0, m, h0, h1, length;
};

/// How far h is below 0 or above 1; never falls with h.
template <class D>
OKTETT_INLINE Interval<D> beyond_ends(const SegmentTrack<D>& t, const Interval<D>& x) {
  const Interval<D> h = x * t.h1 + Interval<D>(t.h0);
  const D zero(0.0), one(1.0);
  return interval::outward_sum(min(h.lo, zero) + max(h.lo - one, zero),
                               min(h.hi, zero) + max(h.hi - one, zero));
}

/// R, without its derivative or with it.
template <class D>
OKTETT_INLINE Interval<D> square_values(const SegmentTrack<D>& t, const Interval<D>& x) {
  return sqr(x - Interval<D>(t.s0)) * t.a + Interval<D>(t.m) + sqr(beyond_ends(t, x)) * t.length;
}
template <class D>
OKTETT_INLINE Dual<Interval<D>> square_over(const SegmentTrack<D>& t, const Interval<D>& x) {
  const Interval<D> q = x - Interval<D>(t.s0), over = beyond_ends(t, x);
  return {square_values(t, x), (q * t.a + over * t.h1 * t.length) * D(2.0)};
}

/// R along a line.
template <class D>
struct Track {
  SegmentTrack<D> straight;  ///< points and segments
  D x0, y0, z0, x1, y1, z1;  ///< place in a polygon's own coordinates, and its speed

  Track() = default;
  OKTETT_INLINE Track(const FieldPart& part, const CenteredLine<D>& l) {
    const Vec3<D> o{l.p.x - D(part.origin.x), l.p.y - D(part.origin.y), l.p.z - D(part.origin.z)};
    const auto dot_with = [](const Vec3d& a, const Vec3<D>& b) {
      return (D(a.x) * b.x + D(a.y) * b.y) + D(a.z) * b.z;
    };
    if (part.shape == FieldPart::Shape::segment) {
      const D h0 = dot_with(part.axis, o) * D(part.inverse_axis);
      const D h1 = dot_with(part.axis, l.u) * D(part.inverse_axis);
      const Vec3<D> p{o.x - h0 * D(part.axis.x), o.y - h0 * D(part.axis.y), o.z - h0 * D(part.axis.z)};
      const Vec3<D> v{l.u.x - h1 * D(part.axis.x), l.u.y - h1 * D(part.axis.y), l.u.z - h1 * D(part.axis.z)};
      straight = across(p, v);
      straight.h0 = h0, straight.h1 = h1;
      straight.length = D(part.axis_square * part.unit_square);
      straight.a = straight.a * D(part.unit_square), straight.m = straight.m * D(part.unit_square);
      return;
    }
    const Vec3<D> p{dot_with(part.row[0], o), dot_with(part.row[1], o), dot_with(part.row[2], o)};
    const Vec3<D> v{dot_with(part.row[0], l.u), dot_with(part.row[1], l.u), dot_with(part.row[2], l.u)};
    if (part.shape == FieldPart::Shape::point) {
      straight = across(p, v);
    } else {
      x0 = p.x, y0 = p.y, z0 = p.z, x1 = v.x, y1 = v.y, z1 = v.z;
    }
  }

  static OKTETT_INLINE SegmentTrack<D> across(const Vec3<D>& p, const Vec3<D>& v) {
    SegmentTrack<D> t;
    t.a = dot_lanes(v, v);
    t.s0 = -select(t.a > D(0.0), dot_lanes(p, v) / t.a, D(0.0));
    const Vec3<D> n{p.x + t.s0 * v.x, p.y + t.s0 * v.y, p.z + t.s0 * v.z};
    t.m = dot_lanes(n, n);
    t.h0 = t.h1 = t.length = D(0.0);
    return t;
  }
};

/// The square of the distance from a polygon in its plane. All over an interval it is zero, or that from the
/// nearest edge, unless the border may be within reach.
template <class D>
OKTETT_INLINE Dual<Interval<D>> square_over(const FieldPart& part, const double* corner, const Track<D>& t,
                                            const Interval<D>& x) {
  const D zero(0.0);
  const D mid = x.lo + (x.hi - x.lo) * D(0.5);
  const D px = t.x0 + t.x1 * mid, py = t.y0 + t.y1 * mid;
  Dual<Interval<D>> edges{Interval<D>(D(0x1p900)), Interval<D>(zero)};
  D nearest(0x1p900);
  auto within = zero < zero;
  const double* a = corner + 2 * (part.corners - 1);
  for (std::uint32_t i = 0; i < part.corners; ++i) {
    const double* b = corner + 2 * i;
    const double ex = b[0] - a[0], ey = b[1] - a[1], square = ex * ex + ey * ey, inverse = 1 / square;
    const D ox = t.x0 - D(a[0]), oy = t.y0 - D(a[1]);
    const D h0 = (ox * D(ex) + oy * D(ey)) * D(inverse), h1 = (t.x1 * D(ex) + t.y1 * D(ey)) * D(inverse);
    const Vec3<D> p{ox - h0 * D(ex), oy - h0 * D(ey), zero}, v{t.x1 - h1 * D(ex), t.y1 - h1 * D(ey), zero};
    SegmentTrack<D> edge = Track<D>::across(p, v);
    edge.h0 = h0, edge.h1 = h1, edge.length = D(square);
    edges = min(edges, square_over(edge, x));
    // The place in the middle: its distance from the edge, and whether the edge is to its right.
    const D h = min(max(h0 + h1 * mid, zero), D(1.0));
    const D dx = px - D(a[0]) - h * D(ex), dy = py - D(a[1]) - h * D(ey);
    nearest = min(nearest, dx * dx + dy * dy);
    const auto a_above = D(a[1]) > py, b_above = D(b[1]) > py;
    const auto spans = (a_above & ~b_above) | (b_above & ~a_above);
    const auto right = ey != 0 ? px < D(a[0]) + (py - D(a[1])) * D(ex / ey) : zero < zero;
    const auto turns = spans & right;
    within = (within & ~turns) | (~within & turns);
    a = b;
  }
  const D reach = max(x.hi - mid, mid - x.lo) * sqrt(t.x1 * t.x1 + t.y1 * t.y1) * D(1 + 0x1p-40) + D(0x1p-46);
  const auto clear = sqrt(nearest) > reach, outside = clear & ~within, inside = clear & within;
  const D low = select(outside, max(edges.v.lo, zero), zero);
  edges.v = {low, select(inside, zero, edges.v.hi)};
  edges.d = {select(outside, edges.d.lo, select(inside, zero, min(edges.d.lo, zero))),
             select(outside, edges.d.hi, select(inside, zero, max(edges.d.hi, zero)))};
  const Interval<D> z = x * t.z1 + Interval<D>(t.z0);
  return {(edges.v + sqr(z)) * D(part.unit_square), (edges.d + z * t.z1 * D(2.0)) * D(part.unit_square)};
}

/// Those that end are zero from R = 1 on, exactly.
inline bool potential_ends(PotentialKind kind) {
  return kind != PotentialKind::inverse_square && kind != PotentialKind::gaussian;
}

/// A potential and its derivative by R.
template <class D>
OKTETT_INLINE void potential_at(PotentialKind kind, double d, const D& square, D& value, D& slope) {
  const D zero(0.0), one(1.0);
  switch (kind) {
    case PotentialKind::inverse_square: {
      value = one / max(square, D(kLeastSquare));
      slope = -(value * value);
      break;
    }
    case PotentialKind::gaussian: {
      const D r = min(square, D(1000.0));
      value = lane::exp2(r * D(-std::numbers::log2e));
      slope = -value;
      break;
    }
    case PotentialKind::quadratic: {
      const D r = sqrt(square), q = max(one - r, zero);
      const auto near = D(9.0) * square <= one;
      value = select(near, one - D(3.0) * square, D(1.5) * (q * q));
      slope = select(near, D(-3.0), D(-1.5) * q / max(r, D(0.25)));
      break;
    }
    case PotentialKind::rational: {
      const D q = max(one - square, zero), r = one / (one + D(d) * square);
      value = q * q * r;
      slope = -(q * (D(2.0) + D(d) + D(d) * square) * r * r);
      break;
    }
    default: {
      const D q = max(one - square, zero);
      value = q * q;
      slope = D(-2.0) * q;
    }
  }
}

/// Potentials fall with R and are convex in it: the ends of an interval tell all. First the values alone.
template <class D>
OKTETT_INLINE Interval<D> potential_over(const FieldPart& part, const Interval<D>& square) {
  const D zero(0.0), error(0x1p-48);
  const D near = max(square.lo, zero), far = max(square.hi, zero);
  D most, least, slope;
  potential_at(part.kind, part.d, near, most, slope);
  potential_at(part.kind, part.d, far, least, slope);
  const auto past = potential_ends(part.kind) ? near >= D(1.0) : zero > zero;
  const Interval<D> v{max(least - (least + D(1.0)) * error, zero),
                      select(past, zero, most + (most + D(1.0)) * error)};
  return v * D(part.weight);
}
template <class D>
OKTETT_INLINE Dual<Interval<D>> potential_over(const FieldPart& part, const Dual<Interval<D>>& square) {
  const D zero(0.0), error(0x1p-48);
  const D near = max(square.v.lo, zero), far = max(square.v.hi, zero);
  D value, steepest, flattest;
  potential_at(part.kind, part.d, near, value, steepest);
  potential_at(part.kind, part.d, far, value, flattest);
  const auto past = potential_ends(part.kind) ? near >= D(1.0) : zero > zero;
  const D slack = (abs(steepest) + D(1.0)) * error;
  Interval<D> slope{select(past, zero, steepest - slack), select(past, zero, min(flattest + slack, zero))};
  if (part.kind == PotentialKind::inverse_square) slope.hi = select(near <= D(kLeastSquare), zero, slope.hi);
  return {potential_over(part, square.v), slope * square.d * D(part.weight)};
}

}  // namespace field

// ---- Blob trees.

/// A step of the program: what to do in the upper bits, the number of the element below. Blends take two
/// values from the stack; `difference` leaves min(a, 2 iso - b).
struct BlobCode {
  enum Op : std::uint32_t { zero, element, sum, max, min, difference };
  static constexpr int kShift = 28;
  static constexpr std::uint32_t make(Op op, std::uint32_t index = 0) {
    return static_cast<std::uint32_t>(op) << kShift | index;
  }
  static constexpr Op op(std::uint32_t code) { return static_cast<Op>(code >> kShift); }
  static constexpr std::uint32_t index(std::uint32_t code) { return code & ((1u << kShift) - 1); }
};
/// A blend adds one value at most to what is on the stack.
inline constexpr int kBlobStack = kMaxBlendLevels + 2;

struct BlobTreeElement {
  double iso;
  std::uint32_t begin, count;  ///< the whole program, in the pool's codes
  std::uint32_t root;          ///< of the cells
};

struct BlobTreePool : ExactPool<BlobTreeElement> {
  std::vector<FieldPart> parts;
  std::vector<double> corners;  ///< x and y of polygons in their planes
  std::vector<std::uint32_t> codes;
  CellTree tree;
  std::size_t bytes() const {
    return ExactPool::bytes() + parts.size() * sizeof(FieldPart) + corners.size() * sizeof(double) +
           codes.size() * sizeof(std::uint32_t) + tree.bytes();
  }
};

namespace field {

// From the description to what the pool holds.

/// The program: each list of a blend taken two at a time, from the left. Empty if the description is
/// malformed.
std::vector<std::uint32_t> program(const BlobTreeShape& shape);

/// What is within `reach` of a skeleton; of an ellipsoid, reach times its radii.
CellBox box_of(const Skeleton& skeleton, double reach);

/// An element in the own space, which is about `middle` and in units of `size`. Appends the corners of a
/// polygon to `corners`.
FieldPart make_part(const FieldElement& element, const Vec3d& middle, double size,
                    std::vector<double>& corners);

/// iso minus the blended potentials in a cell, along a line.
template <class D>
class CellField {
 public:
  static constexpr std::uint32_t kKept = 12;

  OKTETT_INLINE CellField(const BlobTreePool& pool, const ExactCell& cell, const CenteredLine<D>& line)
      : pool_(pool),
        code_(pool.tree.lists.data() + cell.begin),
        count_(cell.count),
        line_(line),
        iso_(pool.elements[cell.element].iso) {
    std::uint32_t k = 0;
    for (std::uint32_t i = 0; i < count_ && k < kKept; ++i)
      if (BlobCode::op(code_[i]) == BlobCode::element) kept_[k++] = Track<D>(part(i), line);
  }

  // Not inlined: the march calls it in many places, and that would be most of the code of the library.
  OKTETT_NOINLINE Dual<Interval<D>> over(const Interval<D>& x) const { return run<Dual<Interval<D>>>(x); }
  OKTETT_NOINLINE Interval<D> at(const D& s) const { return run<Interval<D>>(Interval<D>(s)); }

 private:
  OKTETT_INLINE void square(const FieldPart& p, const Track<D>& track, const Interval<D>& x,
                            Dual<Interval<D>>& out) const {
    const bool flat = p.shape == FieldPart::Shape::polygon;
    out = flat ? square_over(p, corners(p), track, x) : square_over(track.straight, x);
  }
  OKTETT_INLINE void square(const FieldPart& p, const Track<D>& track, const Interval<D>& x,
                            Interval<D>& out) const {
    const bool flat = p.shape == FieldPart::Shape::polygon;
    out = flat ? square_over(p, corners(p), track, x).v : square_values(track.straight, x);
  }

  /// The program on values of one kind, with or without derivatives.
  template <class T>
  OKTETT_INLINE T run(const Interval<D>& x) const {
    T stack[kBlobStack];
    int top = -1;
    std::uint32_t k = 0;
    for (std::uint32_t i = 0; i < count_; ++i) {
      const BlobCode::Op op = BlobCode::op(code_[i]);
      if (op == BlobCode::zero) {
        set(stack[++top], 0);
      } else if (op == BlobCode::element) {
        const FieldPart& p = part(i);
        const Track<D> track = k < kKept ? kept_[k] : Track<D>(p, line_);
        ++k;
        T r;
        square(p, track, x, r);
        stack[++top] = potential_over(p, r);
      } else {
        const T b = stack[top--];
        T& a = stack[top];
        if (op == BlobCode::sum) {
          a = a + b;
        } else if (op == BlobCode::max) {
          a = oktett::max(a, b);
        } else if (op == BlobCode::min) {
          a = oktett::min(a, b);
        } else {
          a = oktett::min(a, plus(-b, 2 * iso_));
        }
      }
    }
    return plus(-stack[0], iso_);
  }

  OKTETT_INLINE const FieldPart& part(std::uint32_t i) const {
    return pool_.parts[BlobCode::index(code_[i])];
  }
  OKTETT_INLINE const double* corners(const FieldPart& p) const {
    return pool_.corners.data() + 2 * std::size_t{p.corner};
  }

  const BlobTreePool& pool_;
  const std::uint32_t* code_;
  std::uint32_t count_;
  const CenteredLine<D>& line_;
  double iso_;
  Track<D> kept_[kKept];
};

}  // namespace field

struct BlobTree {
  using Data = BlobTreeShape;
  using Pool = BlobTreePool;
  static constexpr int kMaxCrossings = 8;

  static void add(Pool& pool, const BlobTreeShape& shape, const ExactPlace& place);

  template <int K, class D>
  static void crossings(const Pool& pool, const ExactCell& cell, const Line<D>& line,
                        const LineRange<D>& range, const typename D::M& active, Crossings<K, D>& out) {
    const CenteredLine<D> l(line);
    const D a = l.to_s(range.a), b = l.to_s(range.b);
    const auto sound = active & (a <= b) & (abs(a) < D(0x1p30)) & (abs(b) < D(0x1p30));
    out.clear();
    if (none(sound)) return;
    // Idle lanes compute along.
    const D from = select(sound, a, D(0.0)), to = select(sound, b, D(0.0));
    const field::CellField<D> f(pool, cell, l);
    interval::march(f, from, to, to, sound, interval::Jumps::list, out);
    place_crossings(out, [&](const D& s) { return l.to_t(s); });
    for (D& part : out.part) part = D(0.0);
  }

  static Slope slope_at(const Pool& pool, std::size_t i, int part, const Vec3d& p);
  /// Longitude and latitude about the middle of the element's bounds, as for a sphere.
  static SurfaceUv uv(const Pool&, std::size_t, int, const Vec3d& p) { return globe_uv(p); }
};

}  // namespace oktett
