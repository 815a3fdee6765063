#pragma once
/// \file Scenes whose hits depend on more than the line of a ray: on its time, its mask, and code of the
/// program that judges hits or brings shapes of its own.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "accel/accel.h"

namespace oktett {

class HitFilter;

/// What a ray brings along besides its line.
struct RayContext {
  float time = 0;            ///< 0 to 1, for what moves; clamped, NaN counts as 0
  std::uint32_t mask = ~0u;  ///< the ray meets geometries whose masks have one of these bits
  const HitFilter* filter =
      nullptr;           ///< judges what the filters of the geometries let pass; null: all counts
  void* user = nullptr;  ///< the program's own, for its filters and shapes
};

/// Scenes inside scenes: the instances that lead to a geometry, the outermost first.
struct InstanceChain {
  static constexpr std::uint32_t kMost = 8;

  std::uint32_t count = 0;
  std::uint32_t geometry[kMost];   ///< SceneGeometry::number of each instance
  std::uint32_t primitive[kMost];  ///< which of an array of instances, else 0

  InstanceChain() = default;
  InstanceChain(const InstanceChain& other) { *this = other; }
  /// Copies no more than there is: most hits are in no instance.
  InstanceChain& operator=(const InstanceChain& other) {
    count = other.count;
    for (std::uint32_t i = 0; i < count; ++i)
      geometry[i] = other.geometry[i], primitive[i] = other.primitive[i];
    return *this;
  }
  void push(std::uint32_t number, std::uint32_t index) {
    geometry[count] = number, primitive[count] = index;
    ++count;
  }
};

/// Where a ray meets a scene, or a miss.
struct SceneHit {
  float t = std::numeric_limits<float>::infinity();  ///< the hit is at origin + t direction
  float u = 0, v = 0;                                ///< of a triangle as in Hit; else as its shape says
  /// The geometric normal in the space of the innermost scene, of any length: of a triangle (b - a) x
  /// (c - a).
  Vec3f normal;
  std::uint32_t geometry = kNoId;   ///< SceneGeometry::number
  std::uint32_t primitive = kNoId;  ///< in the geometry, see FaceMap
  void* user = nullptr;             ///< SceneGeometry::user
  InstanceChain chain;

  /// False for a miss.
  bool valid() const { return geometry != kNoId; }
};

/// Judges candidate hits. Many threads may call it at once.
class HitFilter {
 public:
  virtual ~HitFilter();
  /// Judges hits of one ray with one geometry in one chain of instances, in their order, until one is
  /// accepted, and returns its number: `hits.size()` if all are rejected. The accepted one may be changed, t
  /// only to less; with the geometry kNoId the ray ends there as if it met nothing, in any_hit at once. `ray`
  /// is in the space of the innermost scene. Each hit is judged once in a query, the nearest not always
  /// first.
  virtual std::size_t judge(const Ray& ray, const RayContext& context, std::span<SceneHit> hits) const = 0;
};

/// A shape of the program's own: any number of primitives. Many threads may call it at once.
class UserShape {
 public:
  virtual ~UserShape();
  virtual std::uint32_t primitive_count() const = 0;
  /// At how many times, equally far apart, the bounds are told; between them they are interpolated linearly.
  /// RayContext::time is 0 at the first and 1 at the last.
  virtual std::uint32_t key_count() const { return 1; }
  /// The bounds of a primitive at a key. One whose bounds are empty or not finite at any key is left out. The
  /// others may also be asked about rays that miss them.
  virtual Box bounds(std::uint32_t primitive, std::uint32_t key) const = 0;
  /// Whether a primitive may have a hit behind one that a filter rejects; then it is asked for it.
  virtual bool has_several_hits() const { return false; }
  /// Whether what it finds outside of the range of the ray counts, too; else such hits are left out.
  virtual bool may_leave_range() const { return false; }
  /// Looks for the nearest hit with ray.tmin < t <= ray.tmax: sets t, u, v and the normal of `hit`, whose
  /// other members are set already and may be changed, and returns true; else false.
  virtual bool closest_hit(std::uint32_t primitive, const Ray& ray, const RayContext& context,
                           SceneHit& hit) const = 0;
  /// Whether there is any; sets `hit` likewise.
  virtual bool any_hit(std::uint32_t primitive, const Ray& ray, const RayContext& context,
                       SceneHit& hit) const {
    return closest_hit(primitive, ray, context, hit);
  }
};

/// A mesh whose vertices move along straight lines between keys, which are equally far apart from time 0 to
/// 1. At time s between two of them a vertex is at (1 - f) a + f b, computed in float, where f = s (keys - 1)
/// less the number of the first; hits are the bits of a mesh with these positions. Triangles that are not
/// finite at some key are left out.
struct MovingMesh {
  std::shared_ptr<const TriangleMesh> mesh;    ///< its positions are those of the first key
  std::vector<Column<Vec3f>> later_positions;  ///< of the other keys; at least one, as many as `mesh` has
};

/// How primitives of a mesh are named where they are more than a triangle, such as quads. Many threads may
/// call it at once.
class FaceMap {
 public:
  virtual ~FaceMap();
  /// Replaces the number of a triangle by that of its face, and the weights u and v by the coordinates of the
  /// face.
  virtual void to_face(std::uint32_t& primitive, float& u, float& v) const = 0;
};

/// Faces of two triangles each: with corners a, b, c, d, the triangles (a, b, d) and (c, d, b). u counts from
/// a to b, v from a to d.
class QuadFaces final : public FaceMap {
 public:
  void to_face(std::uint32_t& primitive, float& u, float& v) const override;
};

class TraceScene;

/// A map that turns: at a key it is p -> outer + R(quaternion) inner(p). Between keys the quaternion turns at
/// constant speed the shorter way (Shoemake 1985), the rest is linear.
struct TurningMap {
  double quaternion[4] = {1, 0, 0, 0};  ///< real part first; of any length but zero
  Affine inner;                         ///< applied before the rotation
  Vec3d outer;                          ///< added after it
};

/// A scene shown inside another one.
struct SceneInstance {
  std::shared_ptr<const TraceScene> child;
  /// At keys that are equally far apart from time 0 to 1: one, or the entries are interpolated linearly.
  std::vector<Affine> transforms{1};
  std::vector<TurningMap> turning;  ///< if not empty, in place of `transforms`
};

/// Many instances as one geometry.
struct SceneInstances {
  std::vector<std::shared_ptr<const TraceScene>> children;
  struct Place {
    Affine transform;         ///< at the first key
    std::uint32_t child = 0;  ///< index into `children`
  };
  std::vector<Place> places;
  /// The transforms at the other keys, those of a key side by side; none: the instances do not move.
  std::vector<std::vector<Affine>> later_transforms;
  /// If not empty, the maps at all keys, in place of all transforms.
  std::vector<std::vector<TurningMap>> turning;
};

/// One thing in a scene.
struct SceneGeometry {
  /// A Geometry is any fixed one but instances; its `user` and `mask` do not count.
  std::variant<Geometry, MovingMesh, std::shared_ptr<const UserShape>, SceneInstance, SceneInstances> shape;
  std::uint32_t number = kNoId;  ///< the caller's; not kNoId, and no two of a scene have the same
  std::uint32_t mask = ~0u;      ///< see RayContext::mask
  /// The times of the first and the last key of what has keys. Nothing of it is seen at other times, nor at
  /// `end` if that is below 1, when what follows may begin.
  float begin = 0, end = 1;
  /// Judge hits of closest_hit and any_hit; null: all count. They must outlive the scene. Those of instances
  /// are never asked.
  const HitFilter* closest_filter = nullptr;
  const HitFilter* any_filter = nullptr;
  /// Of a Geometry: a structure of it alone without its transform, built before, which is shown in place of
  /// one that would be built; null: none. So what does not change need not be built again.
  std::shared_ptr<const Accel> tree;
  std::shared_ptr<const FaceMap> faces;  ///< of meshes; null: a primitive is a triangle
  void* user = nullptr;                  ///< the program's own, found again in hits
};

/// A scene of geometries. It never changes, so any number of threads may query it at the same time. What does
/// not move and is no code of the program stands in one Accel and is traced as such; the rest in trees of its
/// own, whose boxes move along straight lines with it.
///
/// Of hits at equal distance those in no instance, combination or sphere that a transform distorts count
/// first, then those of the geometry that was given first, then the lowest primitive. User shapes are asked
/// with a ray that ends at the nearest hit so far.
///
/// Throws Error if there are more than 2^32 - 2 primitives, numbers are doubled, keys do not fit, or
/// instances are nested deeper than InstanceChain::kMost.
std::shared_ptr<const TraceScene> build_trace_scene(std::vector<SceneGeometry> geometries,
                                                    const BuildOptions& options = {});

/// The bounds of all that has bounds at the first key and at the last, see bounds(const Accel&).
struct SceneBounds {
  Box first, last;
};
SceneBounds bounds(const TraceScene& scene);

/// Whether rays need no contexts: nothing moves, and there are neither masks, nor filters, nor shapes of the
/// program.
bool needs_no_contexts(const TraceScene& scene);

/// The nearest hit of one ray.
SceneHit closest_hit(const TraceScene& scene, const Ray& ray, const RayContext& context = {},
                     Isa isa = default_isa());
/// Whether one ray hits anything.
bool any_hit(const TraceScene& scene, const Ray& ray, const RayContext& context = {},
             Isa isa = default_isa());

/// hits[i] becomes the nearest hit of ray i, whose context is contexts[i], or contexts[0] if there is one for
/// all. Batches of more than 4096 rays are shared out among threads. Throws Error if sizes differ.
void closest_hit(const TraceScene& scene, std::span<const Ray> rays, std::span<const RayContext> contexts,
                 std::span<SceneHit> hits, Isa isa = default_isa());
/// occluded[i] becomes 1 if ray i hits anything, else 0.
void any_hit(const TraceScene& scene, std::span<const Ray> rays, std::span<const RayContext> contexts,
             std::span<std::uint8_t> occluded, Isa isa = default_isa());

/// The same for rays in columns, without contexts. Throws Error if the scene needs them.
void closest_hit(const TraceScene& scene, const RaySpan& rays, std::span<SceneHit> hits,
                 Isa isa = default_isa());
void any_hit(const TraceScene& scene, const RaySpan& rays, std::span<std::uint8_t> occluded,
             Isa isa = default_isa());

}  // namespace oktett
