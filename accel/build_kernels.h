#pragma once
/// \file Binning and partitioning of references, compiled per instruction set.

#include "accel/build_sah.h"
#include "accel/build_sweep.h"
#include "core/simd.h"

namespace oktett {

template <class A>
struct BuildCode {
  using F = Simd<float, 4, A>;
  using B = Simd<float, 8, A>;

  // The numbers in the gaps of a reference look like denormals, which are slow to multiply: they are set to 0.

  /// (centre - origin) * scale, clamped to [0, bins - 1].
  struct Cell {
    F origin, scale, last;
    explicit OKTETT_INLINE Cell(const Grid& g)
        : origin(F::load(g.origin)), scale(F::load(g.scale)), last(static_cast<float>(g.bins - 1)) {}
    OKTETT_INLINE F operator()(const PrimRef& r) const {
      const F c = center(r);
      return min(max((c - origin) * scale, F(0.0f)), last);
    }
  };
  /// Twice the centre.
  OKTETT_INLINE static F center(const PrimRef& r) {
    return select(F::M::from_bits(7), F::load(r.hi) - F::load(r.negative_lo), F(0.0f));
  }

  static void bin(const BinJob& job) {
    Bins& out = *job.out;
    const B empty(-std::numeric_limits<float>::infinity());
    for (int axis = 0; axis < 3; ++axis)
      for (int b = 0; b < job.grid.bins; ++b) empty.store(out.box[axis][b].v), out.count[axis][b] = 0;
    const Cell cell(job.grid);
    for (std::size_t i = 0; i < job.count; ++i) {
      const PrimRef& r = job.refs[i];
      const B box = B::load(r.negative_lo);
      alignas(16) float c[4];
      cell(r).store(c);
      for (int axis = 0; axis < 3; ++axis) {
        const auto b = static_cast<std::uint64_t>(static_cast<std::int64_t>(c[axis]));
        float* v = out.box[axis][b].v;
        max(box, B::load(v)).store(v);
        ++out.count[axis][b];
      }
    }
  }

  static void bound(const PrimRef* refs, std::size_t count, Centers& out) {
    F lo = F::load(out.lo), hi = F::load(out.hi);
    for (std::size_t i = 0; i < count; ++i) {
      const F c = center(refs[i]);
      lo = min(c, lo), hi = max(c, hi);
    }
    lo.store(out.lo), hi.store(out.hi);
  }

  static void partition(PartitionJob& job) {
    constexpr std::size_t kPiece = 256;  // what was just written is bounded while it is in the cache
    const Cell cell(job.grid);
    const int axis = job.split.axis;
    const float plane = static_cast<float>(job.split.bin + 1);
    PrimRef *left = job.left, *right = job.right;
    for (std::size_t i = 0; i < job.count;) {
      PrimRef *const left_begin = left, *const right_end = right;
      const std::size_t end = job.count - i > kPiece ? i + kPiece : job.count;
      for (; i < end; ++i) {
        const PrimRef r = job.refs[i];
        const float c = (r.hi[axis] - r.negative_lo[axis] - job.grid.origin[axis]) * job.grid.scale[axis];
        // Written to both sides, kept on one: a branch would be mispredicted half the time. The two ends
        // meet only at the last reference, where both places are the same.
        const bool is_left = c < plane;
        *(is_left ? left : right - 1) = r;
        left += is_left, right -= !is_left;
      }
      bound(left_begin, static_cast<std::size_t>(left - left_begin), job.centers[0]);
      bound(right, static_cast<std::size_t>(right_end - right), job.centers[1]);
    }
  }

  static void sweep(SweepJob& job) { Sweep<A>(job).run(); }
};

template <class A>
constexpr BuildKernels build_kernels() {
  return {BuildCode<A>::bin, BuildCode<A>::bound, BuildCode<A>::partition, BuildCode<A>::sweep};
}

}  // namespace oktett
