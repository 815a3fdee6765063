#pragma once
/// \file Rays against cells of exact surfaces: for each surface a few functions, compiled for each
/// instruction set in a unit of its own, so that an edit of a surface compiles little.

#include <cstdint>
#include <type_traits>

#include "accel/code.h"
#include "accel/hit_sink.h"
#include "core/isa_select.h"
#include "core/lanes.h"
#include "core/platform.h"
#include "core/simd.h"
#include "core/simd_native.h"
#include "core/vec3.h"
#include "kernels/kinds.h"

namespace oktett {

// ---- The part of a beam (accel/traverse/beam/beam_rays.h) that the code of a surface reads.

inline constexpr int kBeamRays = 256;
inline constexpr int kBeamGroup = 16;  ///< rays that are tested against a triangle or a shape together
inline constexpr int kBeamGroups = kBeamRays / kBeamGroup;

/// The columns and the frame of a beam; see the members of BeamRays of the same names.
struct BeamView {
  const float *x, *y, *hit_lo, *hit_hi;
  Vec3d apex;  ///< in the scene
  int axis[3];
  bool mirrored;
  float farthest;  ///< greatest |x| and |y|
  float slack;     ///< bounds the distance of a ray from the line that (x, y) stands for
  float near_s;
  bool any;  ///< any hit will do, and the rays end at the apex
};

/// For each group of a beam, the rays that a shape may concern, a bit each.
struct BeamLanes {
  std::uint16_t maybe[kBeamGroups];  ///< in: the rays to be tested; out: those that may hit the shape
  std::uint16_t sure[kBeamGroups];   ///< out: those of them that surely hit it before the end of their range
  std::uint16_t leave[kBeamGroups];  ///< out: those that miss it if they start outside (ExactCode::outside)
};

// ---- Crossings of several rays with several solids, in columns.

/// Crossings of up to W rays. Row k of a solid has the k-th crossing of each ray with it; its distance is
/// infinite for rays that have no such crossing. The rows of a solid stand together, in the order of
/// distance.
template <int W>
struct CrossingLanes {
  static constexpr int kMost = 96;  ///< rows
  static constexpr int kMostPerSolid = 4;

  alignas(64) float t[kMost][W];
  alignas(64) float turn[kMost][W];  ///< -1 enters, 1 leaves
  alignas(64) float part[kMost][W];  ///< Hit::u
  std::uint32_t item[kMost];
  bool exact[kMost];  ///< of an exact surface: Hit::v is the turn
  int rows = 0;
};

/// Appends a row with crossings in the lanes of `valid`, unless there are none.
template <int W, class A>
OKTETT_INLINE void push_row(CrossingLanes<W>& out, const Mask<float, W, A>& valid, const Simd<float, W, A>& t,
                            const Simd<float, W, A>& turn, const Simd<float, W, A>& part, std::uint32_t item,
                            bool exact) {
  if (none(valid)) return;
  using F = Simd<float, W, A>;
  const int row = out.rows++;
  select(valid, t, F(std::numeric_limits<float>::infinity())).store(out.t[row]);
  turn.store(out.turn[row]);
  part.store(out.part[row]);
  out.item[row] = item, out.exact[row] = exact;
}

/// Where the crossings of each of W rays go.
template <int W>
struct RayLists {
  HitList* list[W] = {};
};

// ---- Rays against cells of exact surfaces.

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
  /// The same for the rays in `lanes`, with the same bits, also beyond tmax.
  void (*lists)(const ExactPoolBase& pool, std::uint32_t cell, const RayLanes<F>& rays, unsigned lanes,
                const RayLists<kLanes>& out);
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
  static void lists(const ExactPoolBase& pool, std::uint32_t cell, const RayLanes<F>& rays, unsigned lanes,
                    const RayLists<kLanes>& out);
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
// accel/isa/tables.cpp, compiled once per set, defines them.
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
