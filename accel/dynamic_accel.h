#pragma once
/// \file A structure whose geometries change.

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "accel/accel.h"

namespace oktett {

/// Geometries that are added, removed, hidden, moved and bent, and the acceleration structure over them as
/// they are. Each mesh, each combination, and each list of spheres or instances has a tree of its own, which
/// is kept for as long as it does not change. All else stands in the tree above, which is built anew, or
/// refitted if nothing happened but that some of these trees were moved.
///
/// Vertices that move refit the tree of their mesh: boxes and corners follow, links stay. When the expected
/// cost of a ray (AccelStats::sah_cost) has grown by more than kMostGrowth since the tree was built, or the
/// tree cannot follow, it is built anew. No hit depends on that, as BuildQuality says: after any changes hits
/// have the bits that they have in an object made afresh of the same geometries in the same order.
///
/// Not for several threads at a time. The structures that accel() returns never change, and may be queried by
/// any thread whatever becomes of this object.
class DynamicAccel {
 public:
  /// By how much the cost of a tree may grow while it is refitted.
  static constexpr double kMostGrowth = 1.5;

  /// `options`: of all trees. A mesh whose vertices move is built with BuildQuality::fast where `options`
  /// says so or splits triangles, since split ones cannot be refitted.
  explicit DynamicAccel(const BuildOptions& options = {});
  ~DynamicAccel();
  DynamicAccel(const DynamicAccel&) = delete;
  DynamicAccel& operator=(const DynamicAccel&) = delete;

  /// Adds a geometry and returns its number. They count up from 0; those of removed ones are not given again.
  /// SurfaceInteraction::user is `geometry.user`, or this number if that is kNoId and `geometry` has no users
  /// in it: if it is no instance, list of instances or combination.
  std::uint32_t add(Geometry geometry);
  /// The same for a mesh that is kept alive here. `geometry` is a MeshGeometry, whose mesh is replaced.
  std::uint32_t add(std::shared_ptr<const TriangleMesh> mesh, Geometry geometry);

  /// A geometry that is removed is never seen again; its number is no longer known.
  void remove(std::uint32_t number);
  /// Rays meet a geometry while it is enabled, as it is from the beginning.
  void set_enabled(std::uint32_t number, bool enabled);
  /// Puts another geometry in the place of one.
  void replace(std::uint32_t number, Geometry geometry);
  /// The same for a mesh that is kept alive here.
  void replace(std::uint32_t number, std::shared_ptr<const TriangleMesh> mesh, Geometry geometry);
  /// Replaces the transform, which must be invertible.
  void set_transform(std::uint32_t number, const Affine& transform);
  /// Replaces Geometry::mask.
  void set_mask(std::uint32_t number, std::uint32_t mask);
  /// Replaces the positions of the vertices from `first` on of a mesh, and its normals if some are given: one
  /// for each of its normals from `first` on. The mesh that was added is copied before the first change.
  void set_vertices(std::uint32_t number, std::span<const Vec3f> positions, std::size_t first = 0,
                    std::span<const Vec3f> normals = {});

  /// The geometry as it is; of a mesh the positions, too. It, and its mesh, last until this geometry changes.
  const Geometry& geometry(std::uint32_t number) const;
  /// A mesh as it is, if it was added as one that is kept alive here or has changed since; else null. While
  /// somebody holds it, a change makes a copy.
  std::shared_ptr<const TriangleMesh> mesh(std::uint32_t number) const;
  bool is_enabled(std::uint32_t number) const;
  /// Those that are not removed, ascending.
  std::vector<std::uint32_t> numbers() const;

  /// The structure over what is enabled. Does what changes made necessary, with all threads if the options
  /// say so; without changes it is the one returned before. Geometry i of it is the i-th of those enabled.
  /// One that is alone, has a tree and is not moved is that tree itself.
  std::shared_ptr<const Accel> accel();
  /// The structure for rays with this mask: without the geometries whose masks have none of its bits. Its
  /// hits have the numbers that they have in accel(), which can be asked for all else about them. Structures
  /// of the same geometries are one, and are kept until something changes.
  std::shared_ptr<const Accel> accel(std::uint32_t mask);

  /// How often trees of meshes were built and refitted so far.
  struct Work {
    std::size_t builds = 0, refits = 0;
  };
  const Work& work() const { return work_; }

  // Those that take a number throw Error if no geometry has it, and if it is not of the kind that they need.

 private:
  struct Entry;
  struct Snapshot;

  Entry& find(std::uint32_t number);
  const Entry& find(std::uint32_t number) const;
  void update();
  void update(Entry& entry);
  bool move(Snapshot& snapshot, std::uint32_t mask) const;
  std::shared_ptr<Snapshot> snapshot_of(std::uint32_t mask) const;

  BuildOptions options_;
  std::vector<std::unique_ptr<Entry>> entries_;  ///< by number; null: removed
  /// By mask; empty: something has changed since.
  std::map<std::uint32_t, std::shared_ptr<Snapshot>> snapshots_;
  bool moved_ = false;            ///< transforms have changed since these were made
  std::uint32_t used_masks_ = 0;  ///< see least_mask; as it was when the first of these was made
  Work work_;
};

/// Of all masks that meet the same geometries one, and the same for each: `used` are the bits of the
/// geometries' masks, but for those that have all.
inline std::uint32_t least_mask(std::uint32_t mask, std::uint32_t used) {
  const std::uint32_t others = mask & ~used;
  return (mask & used) | (others & -others);
}

/// hits[i] becomes the nearest hit of ray i, which has the mask masks[i]; see DynamicAccel::accel(mask). The
/// rays of each structure are traced together. Throws Error if the arrays differ in size.
void closest_hit(DynamicAccel& scene, const RaySpan& rays, std::span<const std::uint32_t> masks,
                 const HitSpan& hits, Isa isa = default_isa());

/// occluded[i] becomes 1 if ray i, which has the mask masks[i], hits anything, else 0.
void any_hit(DynamicAccel& scene, const RaySpan& rays, std::span<const std::uint32_t> masks,
             std::span<std::uint8_t> occluded, Isa isa = default_isa());

}  // namespace oktett
