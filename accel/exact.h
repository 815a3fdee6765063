#pragma once
/// \file Rays against cells of exact surfaces. The code is compiled per instruction set and family of shapes
/// in translation units of its own (accel/isa/exact*.cpp), so that a change to a shape recompiles little.

#include "accel/crossing_lanes.h"
#include "accel/hit_list.h"
#include "accel/ray_state.h"
#include "accel/shape_hits.h"
#include "core/double_lanes.h"

namespace oktett {

template <class A>
struct ExactCode {
  /// Rays that are solved at once.
  static constexpr int kLanes = kDoubleLanes<A>;
  using F = Simd<float, kLanes, A>;

  /// The first crossing of each ray in `lanes` with the cell, if it is within the ray's range. Returns the
  /// lanes that have one, and the item that the cell belongs to. Hits carry the part of the surface in u and
  /// the turn in v (see Crossings).
  static unsigned first(const Accel& accel, Kind kind, std::uint32_t cell, const RayLanes<F>& rays,
                        unsigned lanes, HitLanes<F>& hits, std::uint32_t& item);
  /// Appends every crossing of one ray with the cell. One ray gives the same bits in every set, so only the
  /// scalar code has this function.
  static void all(const Accel& accel, Kind kind, std::uint32_t cell, const Ray& ray,
                  HitList& hits) requires std::is_same_v<A, ScalarIsa>;
  /// Appends every crossing of the rays in `lanes` with the cell, for kinds that has_one_cell. Returns the
  /// item that the cell belongs to.
  static std::uint32_t rows(const Accel& accel, Kind kind, std::uint32_t cell, const RayLanes<F>& rays,
                            unsigned lanes, CrossingLanes<kLanes>& out);
  /// Surfaces of hits of one element, as exact_surface makes them. False if the kind has no code for that.
  static bool surfaces(const Accel& accel, Kind kind, ShapeHits& hits);
};

/// The rays in `lanes` of a state against the cells of a leaf.
template <int W, class A>
OKTETT_NOINLINE void leaf_exact(const Accel& accel, const LeafEntry& leaf, RayState<W, A>& r,
                                unsigned lanes) {
  constexpr int N = ExactCode<A>::kLanes;
  using F = Simd<float, N, A>;
  for (std::uint32_t cell = leaf.begin; cell < leaf.begin + leaf.count; ++cell) {
    for (int base = 0; base < W; base += N) {
      const unsigned part = lanes >> base & ((1u << N) - 1);
      if (part == 0) continue;
      // Lanes past the end of a narrow state repeat its first one.
      const auto load = [&](const float* column) {
        if constexpr (N <= W) return F::load(column + base);
        float padded[N];
        for (int i = 0; i < N; ++i) padded[i] = column[i < W ? i : 0];
        return F::load(padded);
      };
      const RayLanes<F> rays{{load(r.o[0]), load(r.o[1]), load(r.o[2])},
                             {load(r.d[0]), load(r.d[1]), load(r.d[2])},
                             load(r.tmin),
                             load(r.tmax)};
      HitLanes<F> hits;
      std::uint32_t item;
      unsigned met = ExactCode<A>::first(accel, leaf.kind, cell, rays, part, hits, item);
      if (met == 0) continue;
      float t[N], u[N], v[N];
      hits.t.store(t), hits.u.store(u), hits.v.store(v);
      for (; met != 0; met &= met - 1) {
        const int i = __builtin_ctz(met);
        accept_hit(r, base + i, t[i], u[i], v[i], item, kNoId);
      }
    }
  }
}

}  // namespace oktett
