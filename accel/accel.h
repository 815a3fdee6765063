#pragma once
/// \file The acceleration structure: built from geometries, then queried with rays, one at a time or in
/// batches.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "accel/interaction_block.h"
#include "core/box.h"
#include "core/isa.h"
#include "core/mesh.h"
#include "core/ray.h"
#include "core/surface_interaction.h"
#include "core/transform.h"
#include "kernels/closed/shape_data.h"
#include "kernels/exact_form.h"

namespace oktett {

/// A tree of bounding volumes over geometries, made by build_accel. It never changes, so any number of
/// threads may query it at the same time.
class Accel;

/// A mesh to trace. The mesh must outlive the acceleration structure, which refers to its normals and uvs.
struct MeshGeometry {
  const TriangleMesh* mesh = nullptr;            ///< not null
  bool smooth = true;                            ///< shading normals are interpolated from those of the mesh
  TriangleTest test = TriangleTest::watertight;  ///< how a ray is tested against a triangle
};

/// Everything that `child` holds, moved by the geometry's transform, which is applied in double.
struct InstanceGeometry {
  std::shared_ptr<const Accel> child;  ///< not null
};

/// One instance of a list, in 56 bytes. It is traced with exactly these float values.
struct InstancePlace {
  float to_list[12];           ///< row-major 3x4 matrix [M | t] from the child's space to that of the list
  std::uint32_t child;         ///< index into InstanceList::children
  std::uint32_t user = kNoId;  ///< if not kNoId, it replaces the `user` of everything in the child
};

/// Many instances as one geometry. Each takes 64 bytes besides its share of the tree and counts as one item
/// and one primitive. The children may hold instances themselves.
struct InstanceList {
  std::vector<std::shared_ptr<const Accel>> children;  ///< none is null
  std::vector<InstancePlace> places;
};

struct CsgExpression;

/// A Boolean combination of solids. Hits name the solid whose surface was met: `user` is that of the solid.
struct CsgGeometry {
  std::shared_ptr<const CsgExpression> expression;  ///< not null
};

/// One thing to trace: a shape, in its own space.
struct Geometry {
  /// The closed forms are SpheresShape, PlaneShape, DiskShape, BoxShape and PolygonShape.
  std::variant<MeshGeometry OKTETT_AND_CLOSED_FORMS, ExactShape, CsgGeometry, InstanceGeometry, InstanceList>
      shape;
  Affine transform;  ///< maps the shape's space to that of the structure; invertible
  /// A number of the caller's own, found again in SurfaceInteraction::user. That of an instance, if not
  /// kNoId, replaces those of everything inside it; of nested instances the outermost counts.
  std::uint32_t user = kNoId;
  /// What rays it is for: it is in a structure if it has one of the bits of BuildOptions::mask. Solids of
  /// combinations are there in any case; those of mask 0 cut others, but have no surface that rays hit.
  std::uint32_t mask = ~0u;
};

/// A node of a Boolean expression: an operand, or a combination of other nodes. Spheres, boxes, planes (the
/// half-space dot(normal, p) <= offset), closed meshes, exact surfaces that have an inside, and instances and
/// combinations of these are solids. All other geometries have no inside and are left out, unless the operand
/// is CsgOp::surfaces: then only their surfaces count. A ray meets one where it is outside of the whole, but
/// would be inside if it were inside of that operand: of an intersection, where it is in all other operands;
/// of the first operand of a difference, where it is in no other.
struct CsgExpression {
  CsgOp op = CsgOp::operand;
  std::vector<Geometry> solids;         ///< of operands: it is their union
  std::vector<CsgExpression> children;  ///< of all others: what is combined, in order
  /// Of the root: only rays that run through each of these solids meet the combination, wherever on them it
  /// lies. They do not count for inside() and nearest points, nor where an expression is part of another.
  std::vector<Geometry> windows{};
};

/// How much work the builder does. The hits are the same bits for each; but those of TriangleTest other than
/// watertight may lie outside of their triangle's box by rounding, and then depend on the tree.
enum class BuildQuality : std::uint8_t {
  fast,      ///< the fastest to build
  balanced,  ///< between the two: where the halves of a scene overlap much, as in buildings, triangles are
             ///< split
  best,  ///< the fastest to trace: triangles are split wherever it lowers the cost; several times slower to
         ///< build
  compact,  ///< as balanced, but leaves share corners wherever that is possible: less memory, slower to
            ///< trace; a tree whose vertices move is built again
};

/// How a structure is built. No hit depends on it but for `mask`, and as BuildQuality says.
struct BuildOptions {
  BuildQuality quality = BuildQuality::balanced;
  bool parallel = true;  ///< use several threads; the structure is the same bytes
  /// Geometries without any of these bits are left out. The others keep their numbers, and the items and
  /// paths of hits are those of a structure of all, unless combinations or lists of instances are left out.
  std::uint32_t mask = ~0u;
  /// A structure of more primitives is built in parts of about half as many, one after the other. So a build
  /// takes 80 bytes for each of these beside the structure, and not for all.
  std::size_t together = std::size_t{1} << 25;
};

/// Sizes and quality of a built structure, without those of the structures it holds instances of.
struct AccelStats {
  std::size_t items = 0;      ///< primitives; an instance counts as one
  std::size_t triangles = 0;  ///< of the items
  std::size_t unbounded = 0;  ///< of the items: those without bounds, e.g. planes, which are in no leaf
  std::size_t nodes = 0, leaves = 0;
  std::size_t node_bytes = 0, leaf_bytes = 0, other_bytes = 0;
  double sah_cost = 0;  ///< nodes plus leaves that a random ray through the bounds is expected to visit
  int depth = 0;        ///< nodes from the root to the deepest leaf
  /// All memory of the structure.
  std::size_t bytes() const { return node_bytes + leaf_bytes + other_bytes; }
};

/// Builds a structure. Geometry i of `geometries` has the index i in SurfaceInteraction::geometry. Degenerate
/// shapes are left out: those of zero area or size, with numbers that are not finite, or with a singular
/// transform. Throws Error if there are more than 2^32 - 2 primitives or chains of instances.
std::shared_ptr<const Accel> build_accel(std::vector<Geometry> geometries, const BuildOptions& options = {});

/// Sizes and quality of `accel`.
AccelStats stats(const Accel& accel);
/// The bounds of everything that has bounds (a plane has none); the empty box if nothing has.
Box bounds(const Accel& accel);

// Queries. The hits are the same bits for every instruction set, number of threads, order of rays and size of
// a batch, and for rays traced one at a time. Batches of more than 4096 rays are shared out among threads.
// Rays that start at one point or end at one point, and rays that run together, are traced faster if they are
// neighbours in the batch. Throws Error if the arrays of one call differ in size, or if this build has no
// code for `isa`.

/// hits[i] becomes the nearest hit of ray i, a miss if there is none. Of hits at equal distance the one with
/// the lowest (instance, item) counts, where no instance is lower than any.
void closest_hit(const Accel& accel, const RaySpan& rays, const HitSpan& hits, Isa isa = default_isa());
/// The same for arrays of structures. They are turned into columns piece by piece.
void closest_hit(const Accel& accel, std::span<const Ray> rays, std::span<Hit> hits, Isa isa = default_isa());
/// The nearest hit of one ray.
Hit closest_hit(const Accel& accel, const Ray& ray, Isa isa = default_isa());

/// occluded[i] becomes 1 if ray i hits anything, else 0.
void any_hit(const Accel& accel, const RaySpan& rays, std::span<std::uint8_t> occluded,
             Isa isa = default_isa());
/// The same for an array of structures, which is turned into columns piece by piece.
void any_hit(const Accel& accel, std::span<const Ray> rays, std::span<std::uint8_t> occluded,
             Isa isa = default_isa());
/// Whether one ray hits anything.
bool any_hit(const Accel& accel, const Ray& ray, Isa isa = default_isa());

/// Replaces `hits` by every hit of one ray, nearest first, those at equal distance by (instance, item). A
/// closed mesh contributes each crossing exactly once, also at shared edges and vertices.
void all_hits(const Accel& accel, const Ray& ray, std::vector<Hit>& hits, Isa isa = default_isa());
/// The same for each ray of a batch. `lists` is replaced; its memory is used again.
void all_hits(const Accel& accel, const RaySpan& rays, HitLists& lists, Isa isa = default_isa());
/// The same for an array of structures.
void all_hits(const Accel& accel, std::span<const Ray> rays, HitLists& lists, Isa isa = default_isa());

/// counts[i] becomes the number of hits that all_hits lists for ray i.
void count_hits(const Accel& accel, const RaySpan& rays, std::span<std::uint32_t> counts,
                Isa isa = default_isa());
/// The same for an array of structures.
void count_hits(const Accel& accel, std::span<const Ray> rays, std::span<std::uint32_t> counts,
                Isa isa = default_isa());

/// What shading needs to know of a hit, which is valid and was found by tracing `ray` in `accel`.
SurfaceInteraction surface_interaction(const Accel& accel, const Ray& ray, const Hit& hit);

/// Names what was hit: sets only `geometry`, `primitive`, `user` and `material_slot`. Faster than
/// surface_interaction.
SurfaceInteraction identify(const Accel& accel, const Hit& hit);

/// Where on its mesh a hit lies, for attribute_at; on no mesh if another shape was hit.
MeshPoint mesh_point(const Accel& accel, const Hit& hit);

/// The map to the world from the own space of the shape that was hit, which is that before its geometry's
/// transform; of a combination or an instance, the shape inside it.
Affine object_transform(const Accel& accel, const Hit& hit);

/// Sets dp/du and dp/dv of a triangle with these corners and their texture coordinates; leaves them where
/// those do not span anything.
void set_uv_tangents(const std::array<Vec2f, 3>& uv, const Vec3f (&corners)[3], Vec3f& by_u, Vec3f& by_v);

/// out[k] becomes the surface interaction of ray and hit number which[k], for at most InteractionBlock::kMost
/// of them: the bits that surface_interaction gives, except that uv and tangents are left out. Throws
/// Error if there are more.
void surface_interactions(const Accel& accel, const RaySpan& rays, const HitSpan& hits,
                          std::span<const std::uint32_t> which, InteractionBlock& out,
                          Isa isa = default_isa());

/// The same, with uv if `with_uv`.
void surface_interactions(const Accel& accel, const RaySpan& rays, const HitSpan& hits,
                          std::span<const std::uint32_t> which, InteractionBlock& out, Isa isa, bool with_uv);

/// An origin for rays that leave `s` towards `direction`: moved off the surface by the error bound of the
/// position, so that the ray neither meets the same surface again at its start nor begins behind it (Pharr,
/// Jakob, Humphreys: Physically Based Rendering, 3rd edition, section 3.9).
Vec3f offset_origin(const SurfaceInteraction& s, const Vec3f& direction);

}  // namespace oktett
