#pragma once
/// \file The acceleration structure: build it from geometries, then ask it with batches of rays.

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

class Accel;

/// A mesh to trace. The mesh must outlive the acceleration structure: shading reads its normals and uvs.
struct MeshGeometry {
  const TriangleMesh* mesh = nullptr;
  bool smooth = true;
  TriangleTest test = TriangleTest::watertight;
};

/// Everything `child` holds, seen through the geometry's transform.
struct InstanceGeometry {
  std::shared_ptr<const Accel> child;
};

/// One of many instances, in 56 bytes. The place of what it shows is that of these floats.
struct InstancePlace {
  float to_list[12];    ///< row-major 3x4: from the child to the space of the list
  std::uint32_t child;  ///< index into InstanceList::children
  /// If it is not kNoId, it overrides those of the geometries below.
  std::uint32_t user = kNoId;
};

/// Many instances, an item each, that take 64 bytes besides their share of the tree. The children may have
/// several levels of instances; the numbers of their paths are as far apart as the deepest child needs.
struct InstanceList {
  std::vector<std::shared_ptr<const Accel>> children;
  std::vector<InstancePlace> places;  ///< given up when the structure is built
};

struct CsgExpression;

/// A Boolean combination of solids. Each solid keeps its own `user`.
struct CsgGeometry {
  std::shared_ptr<const CsgExpression> expression;
};

/// One thing to trace. `transform` maps it to the space of the structure. `user` is handed back with each
/// hit; an instance whose `user` is not kNoId overrides those of the geometries below it.
struct Geometry {
  std::variant<MeshGeometry, SpheresShape, PlaneShape, DiskShape, BoxShape, PolygonShape, ExactShape,
               CsgGeometry, InstanceGeometry, InstanceList>
      shape;
  Affine transform;
  std::uint32_t user = kNoId;
};

/// A node of a Boolean expression: either solids whose union is an operand, or children to be combined.
/// Closed meshes, spheres, boxes, planes (the half-space below),
/// exact surfaces, and instances and combinations of these are solids; anything else has no inside and is
/// left out.
struct CsgExpression {
  CsgOp op = CsgOp::operand;
  std::vector<Geometry> solids;
  std::vector<CsgExpression> children;
};

/// How hard the builder tries. The hits are the same for each.
enum class BuildQuality : std::uint8_t {
  fast,      ///< few candidates for splits
  balanced,  ///< full blocks and an exact search near the leaves
  best,      ///< also splits space: triangles may stand in several leaves; several times slower to build
};

struct BuildOptions {
  BuildQuality quality = BuildQuality::balanced;
  bool parallel = true;  ///< use TBB tasks; the structure is the same
};

/// Sizes and quality of a built structure.
struct AccelStats {
  std::size_t items = 0;  ///< primitives, instances counted as one each
  std::size_t triangles = 0;
  std::size_t unbounded = 0;  ///< of the items: those in the list beside the tree
  std::size_t nodes = 0, leaves = 0;
  std::size_t node_bytes = 0, leaf_bytes = 0, other_bytes = 0;
  double sah_cost = 0;  ///< expected node visits + leaf visits of a random ray that meets the bounds
  int depth = 0;
  std::size_t bytes() const { return node_bytes + leaf_bytes + other_bytes; }
};

/// Geometry i of `geometries` keeps its index. Shapes that are degenerate (zero area or size, non-finite
/// numbers, singular transform) are left out. Throws Error if there are more than 2^32 - 2 primitives or
/// instance paths.
std::shared_ptr<const Accel> build_accel(std::vector<Geometry> geometries, const BuildOptions& options = {});

AccelStats stats(const Accel& accel);
/// Bounds of all that is bounded; empty if there is nothing.
Box bounds(const Accel& accel);

/// For each ray the nearest hit; at equal distance the one with the lowest (instance, item). Bit-identical
/// for every instruction set, thread count and order of rays. Uses TBB tasks for large batches. `hits.size`
/// >= `rays.size`.
void closest_hit(const Accel& accel, const RaySpan& rays, const HitSpan& hits, Isa isa);

/// occluded[i] = 1 if ray i hits anything, else 0.
void any_hit(const Accel& accel, const RaySpan& rays, std::uint8_t* occluded, Isa isa);

/// Every hit of one ray, nearest first, ties by (instance, item). A closed mesh contributes each crossing
/// exactly once, also at shared edges and vertices.
void all_hits(const Accel& accel, const Ray& ray, std::vector<Hit>& hits, Isa isa);

/// Shading data of a hit that `ray` had with `accel`.
SurfaceInteraction surface_interaction(const Accel& accel, const Ray& ray, const Hit& hit);

/// Only what names the surface of a hit: geometry, primitive, user and material_slot.
SurfaceInteraction identify(const Accel& accel, const Hit& hit);

/// The surfaces of hits `which[0]` ... `which[count - 1]` of a batch, at most InteractionBlock::kMost, with
/// the bits that surface_interaction() gives but without uv and tangent; found in lanes.
void surface_interactions(const Accel& accel, const RaySpan& rays, const HitSpan& hits,
                          const std::uint32_t* which, std::size_t count, Isa isa, InteractionBlock& out);

/// An origin for rays that leave `s` towards `direction`: moved off the surface by the error bound of the
/// hit, so that the surface neither shadows itself nor is passed through (Pharr, Jakob, Humphreys 2016,
/// section 3.9).
Vec3f offset_origin(const SurfaceInteraction& s, const Vec3f& direction);

}  // namespace oktett
