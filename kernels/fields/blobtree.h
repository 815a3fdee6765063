#pragma once
/// \file Blob trees: potentials of skeletons, blended by sums, maxima, minima and differences. The crossings
/// are isolated by interval arithmetic along the ray (kernels/exact/march.h).
///
/// The tree is a program for a stack machine, cut down in each cell to what matters there: elements that are
/// zero, and branches that are surely below or above what they are blended with, are left out.

#include "kernels/exact/cell_tree.h"
#include "kernels/exact/march.h"
#include "kernels/exact/surface_uv.h"
#include "kernels/fields/blobtree_data.h"
#include "kernels/fields/potential_lanes.h"

namespace oktett {

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

// From the description to what the pool holds (blobtree_program.cpp).

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

  // Not inlined: the march asks in many places, and that would be most of the code of the library.
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
