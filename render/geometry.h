#pragma once
/// \file The scene made ready for tracing: acceleration structures and materials.

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "accel/accel.h"
#include "core/box.h"
#include "kernels/exact_form.h"
#include "render/scene.h"
#include "render/strokes.h"

namespace oktett {

/// At least this many instances in a row become one geometry, which takes less memory.
inline constexpr std::size_t kLeastInstanceList = 64;

/// A bent mesh as it is at a time; the mesh itself without a bending.
std::shared_ptr<const TriangleMesh> mesh_at(const MeshShape& shape, double time);

/// What an object of the scene contributes to shading its hits; indexed by SurfaceInteraction::user.
struct ObjectMaterials {
  std::uint32_t material = kNoId;    ///< of the whole object; kNoId = by slot
  std::uint16_t listed = 0;          ///< as in Object
  bool shadow_catcher = false;       ///< as in Object
  bool hollow = false;               ///< as in Object; of an operand that of the combination
  bool has_inside = false;           ///< as has_inside() says, if Whitted's model needs to know
  std::vector<std::uint32_t> slots;  ///< material per slot of the mesh
  /// The object whose inside its surfaces bound: itself, or the combination that it is an operand of. kNoId
  /// if it has no inside, or if paths need not know.
  std::uint32_t solid = kNoId;
  std::uint32_t light_list = kNoId;  ///< as in Object
  std::string name;  ///< of the object; that of the combination for an operand without one; may be empty
  std::shared_ptr<const StrokeParts> strokes{};  ///< if the object is points and lines
};

/// The object that each geometry of a structure shows; of a list of instances the first, which the others
/// follow. The operands of a combination, numbered as its solids are, follow the combination.
using StructureObjects = std::unordered_map<const Accel*, std::vector<std::uint32_t>>;

/// What rays of each kind meet of a structure, numbered by RayKind: the same structure without some objects,
/// with hits of the same numbers. Null: all of it. Behind these, if there are shadow catchers, the same of
/// catchers and of what glows alone.
using SeenBy = std::array<std::shared_ptr<const Accel>, 2 * kRayKinds>;

class FollowingTree;

/// An object that moves: a structure of its own, an instance of which stands in the world at each moment.
struct MovingObject {
  std::shared_ptr<const Accel> shape;
  MotionPointer motion;            ///< null: it stands still, but is bent
  std::uint32_t user = kNoId;      ///< of the instance, as in Geometry; of what is bent, the object
  std::uint32_t instance = kNoId;  ///< the object, if it is an instance
  std::uint32_t mask = kAllRays;   ///< Geometry::mask of the instance
  SeenBy seen_by{};                ///< of `shape`
  // Of a mesh that is bent, of which `shape` and `mesh` are those at a moment.
  std::shared_ptr<const MeshShape> bent{};
  std::shared_ptr<const TriangleMesh> mesh{};
  /// The last tree of a mesh without strokes; shared by all moments, which are made one after the other.
  std::shared_ptr<FollowingTree> following{};
};

/// A scene ready for rays. Objects are numbered through the prototypes in order, then through the scene's
/// own; an instance counts as one object.
struct World {
  std::shared_ptr<const Accel> accel;  ///< of all objects, whatever rays they are for
  SeenBy seen_by{};                    ///< of `accel`
  std::vector<ObjectMaterials> objects;
  std::vector<Material> materials;  ///< those of the scene, and the default material at the end
  std::vector<std::shared_ptr<const TriangleMesh>> meshes;  ///< kept alive for `accel`
  std::shared_ptr<const Accel> still;  ///< what does not move, if anything moves; may be null then
  SeenBy still_seen_by{};              ///< of `still`
  std::vector<MovingObject> moving;
  /// Of all structures but that of `pose`. Not null.
  std::shared_ptr<const StructureObjects> structure_objects;
  Box bounds;                         ///< of all that is bounded
  bool tracks_dielectrics = false;    ///< paths must know which solids they are in
  bool has_enclosing_solids = false;  ///< there are any that they must know of
  bool tracks_insides = false;        ///< in Whitted's model something fills the ways of rays
  bool has_holes = false;             ///< some material is not opaque everywhere, or is no surface at all
  bool has_clear = false;             ///< some material is transparent
  bool has_catchers = false;          ///< there are shadow catchers
  bool has_light_lists = false;       ///< some light is for some objects only
  std::uint16_t lists_of_others = 0;  ///< bit i: LightList::lights_others of list i

  std::uint64_t triangles = 0, primitives = 0;  ///< unique, instances not counted
  std::uint64_t bent_triangles = 0;             ///< of these: what each moment has a tree of its own for
  std::uint64_t geometry_bytes = 0, bvh_bytes = 0;
  double sah_cost = 0;  ///< of the top level
  /// Where meshes stand in structures of their own (with_meshes): how many paths the structure of the other
  /// objects has; else kNoId. See chain_at.
  std::uint32_t paths_of_others = kNoId;
};

/// Each prototype becomes one acceleration structure, shared by its instances. References that lead nowhere
/// (a missing mesh, a prototype that does not stand earlier in the list) are left out. Throws Error if an
/// object that light enters is not seen by all rays while paths must know which solids they are in.
World build_world(const Scene& scene, const BuildOptions& options = {});

/// The world of `others`, which is that of the objects of `scene` before number `first`, and of the objects
/// from there on. These are meshes that do not move, and stand in `top` behind an instance of others.accel
/// without a transform; `user` of their geometries there is their number in the world.
World with_meshes(const World& others, const Scene& scene, std::size_t first,
                  std::shared_ptr<const Accel> top);

/// World::bounds, which with_meshes leaves larger, since instances have room for rounding: the box around the
/// corners of all meshes as they are moved, and of the others. Visits all corners of moved meshes.
Box tight_bounds(const World& world);

/// The number of the chain of instances that a hit's `instance` leads through, kNoId for none, whether or not
/// meshes stand in structures of their own.
inline std::uint32_t chain_at(const World& world, std::uint32_t instance) {
  if (world.paths_of_others == kNoId || instance == kNoId) return instance;
  return instance >= 1 && instance <= world.paths_of_others ? instance - 1 : kNoId;
}

/// Places what moves where it is at `time`: changes `accel` and `bounds`. build_world does it for time 0.
void pose(World& world, double time, const BuildOptions& options = {});

/// What rays of a kind meet.
inline const Accel& seen_by(const World& world, RayKind kind) {
  const auto& seen = world.seen_by[static_cast<std::size_t>(kind)];
  return seen != nullptr ? *seen : *world.accel;
}
/// Whether rays of some kind do not meet all objects.
bool hides_objects(const World& world);
/// Whether bounces of different kinds meet different objects.
bool bounces_differ(const World& world);
/// Whether shadow rays meet other objects than those of some kind of bounce.
bool shadows_differ(const World& world);

/// The world in which rays other than those of the camera meet only shadow catchers and what glows.
World without_others(const World& world);

}  // namespace oktett
