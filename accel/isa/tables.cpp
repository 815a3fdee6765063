/// \file The tables of functions of one instruction set, and the functions in them that are not long enough
/// to be compiled in units of their own.

#include "accel/build/kernels.h"
#include "accel/code.h"
#include "accel/exact_table.h"
#include "accel/surface/surface_lanes.h"
#include "accel/traverse/closest.h"
#include "accel/traverse/inflight/all_hits_pairs.h"
#include "accel/winding/winding_walk.h"
#include "core/simd_memory.h"
#include "core/simd_native.h"

namespace oktett {

// ---- Rays. The two queries that trace() answers are compiled beside this file, see accel/traverse/ways.h.

template <class A>
void trace_all_hits(const Accel& accel, const RaySpan& rays, RayHitList& hits) {
  if constexpr (std::is_same_v<A, ScalarIsa>) {
    for (std::size_t i = 0; i < rays.size; ++i) {
      trace_all_hits<A>(accel, rays[i], hits.scratch());
      hits.take_scratch(i);
    }
  } else {
    AllHitsTraversal<A>(accel, rays, hits).run();
  }
}

template <class A>
const TraceCode& trace_code() {
  static constexpr TraceCode code = {
      trace_one<Query::closest, A>,
      [](const Accel& accel, const Ray& ray) { return trace_one<Query::any, A>(accel, ray).valid(); },
      trace_one_with_normal<A>,
      judge_one<Query::closest, A>,
      judge_one<Query::any, A>,
      trace<Query::closest, A>,
      trace<Query::any, A>,
      trace_all_hits<A>,
      trace_all_hits<A>};
  return code;
}

template const TraceCode& trace_code<OKTETT_ISA>();

// ---- Points: what is nearest, and winding numbers.

template <class A>
static void closest(const Accel& accel, const PointSpan& points, Nearest* nearest) {
  Vec3d last_point;
  NodeRef hint = NodeRef::none();
  Nearest last;
  for (std::size_t i = 0; i < points.size; ++i) {
    const Vec3f p = points[i];
    const float zero = (p.x - p.x) + (p.y - p.y) + (p.z - p.z);
    // Nothing is nearest to a point that is not finite.
    nearest[i] = {};
    if (zero != 0) continue;
    const PointPlace place = place_point(accel, p);
    Nearest best = nearest_by(place, last_point, last);
    ClosestSearch<A> search(accel, best);
    search.start(place, hint);
    search.run(place);
    hint = search.found();
    if (best.item == kNoId) continue;
    nearest[i] = last = best;
    last_point = place.world;
  }
}

template <class A>
static WindingSum winding(const WindingTree& tree, const Vec3f& point, float limit) {
  return WindingWalk<A, float, false>(tree, point, limit, nullptr, nullptr).run();
}

template <class A>
static WindingSum winding_precise(const WindingTree& tree, const Vec3d& point, double limit,
                                  OpenParts* parts) {
  return WindingWalk<A, double, false>(tree, point, limit, nullptr, parts).run();
}

template <class A>
static WindingSum winding_mapped(const WindingTree& tree, const Vec3d& point, double limit,
                                 const WindingMap& map, OpenParts* parts) {
  return WindingWalk<A, double, true>(tree, point, limit, &map, parts).run();
}

template <class A>
const PointCode& point_code() {
  static constexpr PointCode code = {closest<A>, winding<A>, winding_precise<A>, winding_mapped<A>};
  return code;
}

template const PointCode& point_code<OKTETT_ISA>();

// ---- Exact surfaces. Each is compiled in a unit that cmake/surfaces.cmake makes of exact_surface.cpp.in.

template <class A>
constexpr ExactTable<A> make_exact_table() {
  ExactTable<A> table{};
#define SURFACE(Type, name)                                                           \
  table.of[static_cast<int>(Kind::name)] = {                                          \
      ExactSurfaceCode<Type, A>::first,       ExactSurfaceCode<Type, ScalarIsa>::all, \
      ExactSurfaceCode<Type, A>::lists,       ExactSurfaceCode<Type, A>::rows,        \
      ExactSurfaceCode<Type, A>::filter,      ExactSurfaceCode<Type, A>::outside,     \
      ExactSurfaceCode<Type, A>::interactions};
#include "kernels/exact/surfaces.def"
#undef SURFACE
  return table;
}

template <class A>
constexpr ExactTable<A> ExactTable<A>::table = make_exact_table<A>();

template struct ExactTable<OKTETT_ISA>;

// ---- Surfaces of groups of hits.

/// Without vector registers one hit at a time.
template <class A>
void mesh_surfaces_code(const MeshHits& hits) {
  constexpr int W = std::is_same_v<A, ScalarIsa> ? 1 : 8;
  using F = Simd<float, W, A>;
  for (std::size_t i = 0; i < hits.count; i += W) {
    const auto load = [i](const float(&column)[3][MeshHits::kMost]) {
      return Vec3<F>{F::load(column[0] + i), F::load(column[1] + i), F::load(column[2] + i)};
    };
    const PickedLanes<F> entry(hits.entry + i);
    const auto store = [&](const Vec3<F>& v, float(&column)[3][InteractionBlock::kMost]) {
      entry.store(v.x, column[0]), entry.store(v.y, column[1]), entry.store(v.z, column[2]);
    };
    Vec3<F> corners[3], normals[3];
    for (int k = 0; k < 3; ++k) {
      corners[k] = place_corner(hits.frame, load(hits.corner[k]));
      if (hits.frame.smooth) normals[k] = load(hits.normal[k]);
    }
    const MeshSurface<F> s =
        mesh_surface(hits.frame, corners, normals, F::load(hits.u + i), F::load(hits.v + i));
    store(s.position, hits.out->position), store(s.position_error, hits.out->position_error);
    store(s.geometric_normal, hits.out->geometric_normal), store(s.shading_normal, hits.out->shading_normal);
  }
}

template <class A>
bool exact_interactions_code(Kind kind, const ExactPoolBase& pool, ShapeHits& hits) {
  return exact_code<A>(kind).interactions(pool, hits);
}

template <class A>
std::uint64_t name_hits_code(const std::uint32_t* items, std::size_t count, const GeometryItems& geometry,
                             InteractionBlock& out) {
  using I = Simd<std::int32_t, kItemGroup, A>;
  const auto same = [](std::uint32_t x) { return I(static_cast<std::int32_t>(x)); };
  // Lanes compare signed numbers. With the lowest number added, these have the order of unsigned ones.
  const I lowest(INT32_MIN), first = same(geometry.first), end = same(geometry.count) + lowest;
  const I number = same(geometry.geometry), user = same(geometry.user), slot(0);
  std::uint64_t found = 0;
  for (std::size_t i = 0; i < count; i += kItemGroup) {
    const I primitive = I::load(reinterpret_cast<const std::int32_t*>(items) + i) - first;
    const auto here = primitive + lowest < end;
    const auto set = [&](const I& value, std::uint32_t* column) {
      auto* to = reinterpret_cast<std::int32_t*>(column + i);
      select(here, value, I::load(to)).store(to);
    };
    set(number, out.geometry), set(primitive, out.primitive), set(user, out.user),
        set(slot, out.material_slot);
    found |= std::uint64_t{bits(here)} << i;
  }
  return found;
}

template <class A>
const InteractionCode& interaction_code() {
  static constexpr InteractionCode code = {name_hits_code<A>, mesh_surfaces_code<A>, closed_surfaces_code<A>,
                                           exact_interactions_code<A>};
  return code;
}

template const InteractionCode& interaction_code<OKTETT_ISA>();

// ---- The builder.

template const BuildKernels& build_kernels<OKTETT_ISA>();

}  // namespace oktett
