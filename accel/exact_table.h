#pragma once
/// \file Rays against cells of exact surfaces: for each surface a few functions, compiled for each
/// instruction set in a unit of its own, so that an edit of a surface compiles little.

#include <type_traits>

#include "accel/beam_view.h"
#include "accel/crossing_lanes.h"
#include "accel/hit_list.h"
#include "accel/shape_hits.h"
#include "core/isa_select.h"
#include "core/lanes.h"
#include "core/simd_native.h"
#include "kernels/kinds.h"

namespace oktett {

struct ExactPoolBase;
#define SURFACE(Type, name) struct Type;
#include "kernels/exact/surfaces.def"
#undef SURFACE

/// The functions of one surface for one instruction set. A pool must be of that surface.
template <class A>
struct ExactCode {
  /// Rays that are solved at once.
  static constexpr int kLanes = kDoubleLanes<A>;
  using F = Simd<float, kLanes, A>;

  /// The first crossing of each ray in `lanes` with the cell, if it is within the ray's range. Returns the
  /// lanes that have one. Hits carry the part of the surface in u and the turn in v (see Crossings).
  unsigned (*first)(const ExactPoolBase& pool, std::uint32_t cell, const RayLanes<F>& rays, unsigned lanes,
                    HitLanes<F>& hits);
  /// Appends every crossing of one ray with the cell.
  void (*all)(const ExactPoolBase& pool, std::uint32_t cell, const Ray& ray, HitList& hits);
  /// Appends every crossing of the rays in `lanes` with the cell; of surfaces that list their crossings at
  /// once (ExactOps::lists_at_once).
  void (*rows)(const ExactPoolBase& pool, std::uint32_t cell, const RayLanes<F>& rays, unsigned lanes,
               CrossingLanes<kLanes>& out);
  /// Groups of a beam against the cell by conservative arithmetic in float. Leaves `lanes` as they are if
  /// there is none.
  void (*filter)(const ExactPoolBase& pool, std::uint32_t cell, const BeamView& beam, unsigned groups,
                 BeamLanes& lanes);
  /// Those of `lanes` whose origin surely is outside of the surface.
  unsigned (*outside)(const ExactPoolBase& pool, std::uint32_t cell, const RayLanes<F>& rays, unsigned lanes);
  /// Interactions of hits of one element, as ExactOps::interaction_without_uv makes them. False if there is
  /// no code for that in lanes.
  bool (*interactions)(const ExactPoolBase& pool, ShapeHits& hits);
};

/// The functions of ExactCode for the surface S, defined in accel/isa/exact_code.h.
template <class S, class A>
struct ExactSurfaceCode {
  static constexpr int kLanes = ExactCode<A>::kLanes;
  using F = typename ExactCode<A>::F;

  static unsigned first(const ExactPoolBase& pool, std::uint32_t cell, const RayLanes<F>& rays,
                        unsigned lanes, HitLanes<F>& hits);
  /// Only in scalar code: a ray alone has the same bits in every set.
  static void all(const ExactPoolBase& pool, std::uint32_t cell, const Ray& ray,
                  HitList& hits) requires std::is_same_v<A, ScalarIsa>;
  static void rows(const ExactPoolBase& pool, std::uint32_t cell, const RayLanes<F>& rays, unsigned lanes,
                   CrossingLanes<kLanes>& out);
  static void filter(const ExactPoolBase& pool, std::uint32_t cell, const BeamView& beam, unsigned groups,
                     BeamLanes& lanes);
  static unsigned outside(const ExactPoolBase& pool, std::uint32_t cell, const RayLanes<F>& rays,
                          unsigned lanes);
  static bool interactions(const ExactPoolBase& pool, ShapeHits& hits);
};

/// The functions of each exact kind.
template <class A>
struct ExactTable {
  ExactCode<A> of[kKinds];
  OKTETT_INLINE const ExactCode<A>& operator[](Kind kind) const { return of[static_cast<int>(kind)]; }
  static const ExactTable table;
};
// accel/isa/exact.cpp, compiled once per set, defines them.
extern template struct ExactTable<ScalarIsa>;
extern template struct ExactTable<Sse42Isa>;
extern template struct ExactTable<Avx2Isa>;
extern template struct ExactTable<Avx512Isa>;
extern template struct ExactTable<NeonIsa>;

template <class A>
OKTETT_INLINE const ExactCode<A>& exact_code(Kind kind) {
  return ExactTable<A>::table[kind];
}

}  // namespace oktett
