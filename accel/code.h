#pragma once
/// \file The code that is compiled for each instruction set, in accel/isa: tables of functions, and what
/// these work on. accel/isa_tables.cpp selects the table of a set at run time; it throws Error if the build
/// holds no code for the set.

#include "accel/closest.h"
#include "accel/hit_judge.h"
#include "accel/hit_sink.h"
#include "accel/interaction_block.h"
#include "accel/query.h"
#include "core/isa.h"

namespace oktett {

struct WindingTree;
struct WindingSum;
struct WindingMap;
class OpenParts;

// ---- Rays.

/// What each ray of a batch hits. Without vector registers every ray goes alone, whatever the mode.
template <Query Q, class A>
void trace(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out, TraceMode mode);

/// The same for one ray. For Query::any only the hit's validity counts.
template <Query Q, class A>
Hit trace_one(const Accel& accel, const Ray& ray);

/// The nearest hit of one ray, and the normal there.
template <class A>
HitWithNormal trace_one_with_normal(const Accel& accel, const Ray& ray);

/// Lets `judge` judge the hits of one ray. Returns whether one counts. For Query::any, the first that counts
/// ends the ray.
template <Query Q, class A>
bool judge_one(const Accel& accel, const Ray& ray, HitJudge& judge);

/// The queries of accel/accel.h.
struct TraceCode {
  Hit (*closest_hit_one)(const Accel&, const Ray&);
  bool (*any_hit_one)(const Accel&, const Ray&);
  HitWithNormal (*closest_hit_with_normal)(const Accel&, const Ray&);
  bool (*judge_closest_hit)(const Accel&, const Ray&, HitJudge&);
  bool (*judge_any_hit)(const Accel&, const Ray&, HitJudge&);
  void (*closest_hit)(const Accel&, const RaySpan&, const HitSink<Query::closest>&, TraceMode);
  void (*any_hit)(const Accel&, const RaySpan&, const HitSink<Query::any>&, TraceMode);
  void (*all_hits_one)(const Accel&, const Ray&, HitList&);
  void (*all_hits)(const Accel&, const RaySpan&, RayHitList&);
};

template <class A>
const TraceCode& trace_code();
const TraceCode& trace_code(Isa isa);

// ---- Points.

/// The queries of accel/point_query.h.
struct PointCode {
  /// The nearest surface of each point.
  void (*closest)(const Accel&, const PointSpan& points, Nearest* nearest);
  /// The sum over a tree for a point in its unit, where a child is seen as a whole if that leaves out at most
  /// `limit`: in float for points of coordinates below 2^30 and trees over triangles, in double, and in
  /// double as a map shows the tree.
  WindingSum (*winding)(const WindingTree&, const Vec3f& point, float limit);
  WindingSum (*winding_precise)(const WindingTree&, const Vec3d& point, double limit, OpenParts*);
  WindingSum (*winding_mapped)(const WindingTree&, const Vec3d& point, double limit, const WindingMap&,
                               OpenParts*);
};

template <class A>
const PointCode& point_code();
const PointCode& point_code(Isa isa);

// ---- Surfaces of groups of hits.

/// `count` hits of one closed-form kind or of one element of an exact kind. Lanes work on groups of eight, so
/// the last hit is repeated to the end of its group.
struct ShapeHits {
  static constexpr std::size_t kMost = InteractionBlock::kMost;

  std::size_t count = 0;
  const float *origin[3], *direction[3];  ///< columns of rays
  const float *t, *part;                  ///< columns of their hits; `part` of an exact shape is Hit::u
  std::uint32_t ray[kMost];               ///< index of each hit in these columns
  std::uint32_t element[kMost];           ///< index in the pool of the kind
  std::uint32_t entry[kMost];             ///< index of each hit in `out`
  InteractionBlock* out;                  ///< receives positions, their errors and normals
  bool with_uv = false;  ///< `out` also receives uv, or `point` what uv follows from: see kHasUvLanes
  /// The points on the surface: of closed forms in the space of the structure, of exact surfaces in their
  /// own.
  double point[3][kMost];
};

/// What the surface of a mesh depends on, beyond the triangle hit.
struct MeshFrame {
  const Affine* to_world = nullptr;  ///< null if the mesh stands as it is
  const Affine* inverse = nullptr;   ///< of `to_world`
  bool mirrored = false;             ///< `to_world` is a mirror
  bool smooth = false;               ///< shading normals are interpolated from normals at the corners
};

/// `count` hits of one triangle mesh. Lanes work on groups of eight, so the last hit is repeated to the end
/// of its group.
struct MeshHits {
  static constexpr std::size_t kMost = InteractionBlock::kMost;

  std::size_t count = 0;
  MeshFrame frame;
  float corner[3][3][kMost];  ///< [corner][axis], in the mesh's own space
  float normal[3][3][kMost];  ///< normals at the corners, if frame.smooth; see MeshSurface
  float u[kMost], v[kMost];
  std::uint32_t entry[kMost];  ///< index of each hit in `out`
  InteractionBlock* out;       ///< receives the columns of MeshSurface
};

/// A geometry of a structure, and its items: `count` from number `first` on.
struct GeometryItems {
  std::uint32_t geometry, user;
  std::uint32_t first, count;
};

/// Items are read in groups of this many.
inline constexpr std::size_t kItemGroup = 16;

struct InteractionCode {
  /// Sets the names of those of `count` hits that are of the geometry, with the material slot 0, and returns
  /// their bits. `items` are those that were hit, filled up to a group with kNoId.
  std::uint64_t (*name_hits)(const std::uint32_t* items, std::size_t count, const GeometryItems& geometry,
                             InteractionBlock& out);
  /// Hits of one mesh.
  void (*mesh)(const MeshHits&);
  /// Hits of one closed-form kind.
  void (*closed_form)(const Accel&, Kind, ShapeHits&);
  /// Hits of one element of an exact surface; false if the kind has no code for lanes.
  bool (*exact)(Kind, const ExactPoolBase&, ShapeHits&);
};

template <class A>
const InteractionCode& interaction_code();
const InteractionCode& interaction_code(Isa isa);

}  // namespace oktett
