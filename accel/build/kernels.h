#pragma once
/// \file Binning and partitioning of references, compiled per instruction set.

#include "accel/build/sah.h"
#include "accel/build/sweep.h"
#include "core/simd.h"

namespace oktett {

template <class A>
struct BuildCode {
  using F = Simd<float, 4, A>;
  using B = Simd<float, 8, A>;

  // Item number and kind in the gaps of a reference look like denormals, which are slow to multiply: set to
  // 0.

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
    // Successive references tend to fall into the same bin, and reading what was just written is slow: two
    // sets of bins take turns.
    Bins other;
    Bins* const sets[2] = {job.out, &other};
    const B empty(-std::numeric_limits<float>::infinity());
    const int bins = job.grid.bins;
    for (Bins* out : sets)
      for (int axis = 0; axis < 3; ++axis)
        for (int b = 0; b < bins; ++b) empty.store(out->box[axis][b].v), out->count[axis][b] = 0;
    const Cell cell(job.grid);
    const auto add = [&](const PrimRef& r, Bins& out) {
      const B box = B::load(r.negative_lo);
      alignas(16) float c[4];
      cell(r).store(c);
      for (int axis = 0; axis < 3; ++axis) {
        const auto b = static_cast<std::uint64_t>(static_cast<std::int64_t>(c[axis]));
        float* v = out.box[axis][b].v;
        max(box, B::load(v)).store(v);
        ++out.count[axis][b];
      }
    };
    const PrimRef* refs = job.refs;
    const std::size_t count = job.count;
    std::size_t i = 0;
    for (; i + 1 < count; i += 2) add(refs[i], *job.out), add(refs[i + 1], other);
    if (i < count) add(refs[i], other);
    for (int axis = 0; axis < 3; ++axis)
      for (int b = 0; b < bins; ++b) {
        float* v = job.out->box[axis][b].v;
        max(B::load(other.box[axis][b].v), B::load(v)).store(v);
        job.out->count[axis][b] += other.count[axis][b];
      }
  }

  static void bound(const PrimRef* refs, std::size_t count, Centers& out) {
    F lo[2] = {F::load(out.lo), F::load(out.lo)}, hi[2] = {F::load(out.hi), F::load(out.hi)};
    std::size_t i = 0;
    for (; i + 1 < count; i += 2)
      for (int k = 0; k < 2; ++k) {
        const F c = center(refs[i + k]);
        lo[k] = min(c, lo[k]), hi[k] = max(c, hi[k]);
      }
    if (i < count) {
      const F c = center(refs[i]);
      lo[0] = min(c, lo[0]), hi[0] = max(c, hi[0]);
    }
    min(lo[0], lo[1]).store(out.lo), max(hi[0], hi[1]).store(out.hi);
  }

  static void partition(PartitionJob& job) {
    constexpr std::size_t kPiece = 256;  // bounds are computed of pieces that are still in the cache
    const int axis = job.split.axis;
    const float plane = static_cast<float>(job.split.bin + 1);
    const float origin = job.grid.origin[axis], scale = job.grid.scale[axis];
    const PrimRef* const refs = job.refs;
    const std::size_t count = job.count;
    // Places count from job.left.
    std::ptrdiff_t left = 0, right = job.right - job.left;
    for (std::size_t i = 0; i < count;) {
      const std::ptrdiff_t left_begin = left, right_end = right;
      const std::size_t end = count - i > kPiece ? i + kPiece : count;
      for (; i < end; ++i) {
        const float c = (refs[i].hi[axis] - refs[i].negative_lo[axis] - origin) * scale;
        // Without a branch, which would be mispredicted half the time.
        const std::ptrdiff_t is_left = c < plane;
        const std::ptrdiff_t to = (right - 1) ^ (((right - 1) ^ left) & -is_left);
        B::load(refs[i].negative_lo).store(job.left[to].negative_lo);
        left += is_left, right += is_left - 1;
      }
      bound(job.left + left_begin, static_cast<std::size_t>(left - left_begin), job.centers[0]);
      bound(job.left + right, static_cast<std::size_t>(right_end - right), job.centers[1]);
    }
  }

  static void sweep(SweepJob& job) { Sweep<A>(job).run(); }
};

template <class A>
const BuildKernels& build_kernels() {
  static constexpr BuildKernels kernels = {BuildCode<A>::bin, BuildCode<A>::bound, BuildCode<A>::partition,
                                           BuildCode<A>::sweep};
  return kernels;
}

}  // namespace oktett
