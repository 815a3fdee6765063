#pragma once
/// \file Geometries as programs set them up.

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "accel/dynamic_accel.h"
#include "accel/trace_scene.h"
#include "embree/buffer.h"

namespace oktett::embree {
class Geometry;
class Scene;
}  // namespace oktett::embree

struct RTCGeometryTy : oktett::embree::Shell<oktett::embree::Geometry> {};
struct RTCSceneTy : oktett::embree::Shell<oktett::embree::Scene> {};

namespace oktett::embree {

/// Shapes as scenes hold them, made of a geometry's buffers at one moment.
struct Made {
  decltype(SceneGeometry::shape) shape;
  std::shared_ptr<const FaceMap> faces;
  std::shared_ptr<const TriangleMesh> mesh;  ///< that `shape` refers to
  std::shared_ptr<const Accel> tree;         ///< of it alone, if it was asked for
};

class Geometry {
 public:
  Geometry(Ref<RTCDeviceTy> owner, RTCGeometryType type);

  /// Whether this type does not exist here. Such a geometry takes all settings and has no surface, so that
  /// programs that do not look at errors run on.
  bool is_refused() const;

  // ---- Buffers.

  using Slot = std::pair<RTCBufferType, unsigned>;

  /// Throws ApiError unless a geometry of this type has such a buffer.
  void set_view(const Slot& slot, View view);
  /// The view of a slot; throws ApiError if the geometry has no such slot.
  const View& view(const Slot& slot) const;
  /// The same, null if there is none.
  const View* find(RTCBufferType type, unsigned slot = 0) const;

  // ---- What a scene is made of.

  std::uint32_t primitive_count() const;
  /// The shape; made anew if the geometry has changed. `with_tree`: a mesh that does not move has a tree of
  /// its own, which is kept, and refitted where only vertices have changed.
  const Made& made(bool with_tree);
  /// Counts up where the geometry changes in a way that a scene sees.
  std::uint64_t version() const { return version_; }
  /// Notes a change, which counts when the geometry is committed.
  void change_shape() { shape_version_ = ++version_, is_committed = false; }
  void change_setting() { ++version_, is_committed = false; }
  /// The same for what counts at once.
  void change_at_once() { ++version_; }

  bool is_mesh() const {
    return type == RTC_GEOMETRY_TYPE_TRIANGLE || type == RTC_GEOMETRY_TYPE_QUAD ||
           type == RTC_GEOMETRY_TYPE_GRID;
  }
  bool is_instance() const;

  const Ref<RTCDeviceTy> device;
  const RTCGeometryType type;
  bool is_enabled = true, is_committed = false;
  unsigned mask = kDefaultMask;
  unsigned time_steps = 1;
  float begin = 0, end = 1;  ///< the time range
  unsigned attributes = 0;
  RTCBuildQuality quality = RTC_BUILD_QUALITY_MEDIUM;
  void* user = nullptr;
  RTCFilterFunctionN closest_filter = nullptr, any_filter = nullptr;
  bool takes_filter_of_query = OKTETT_EMBREE == 3;
  RTCPointQueryFunction point_query = nullptr;

  // User geometries.
  unsigned user_primitives = 0;
  RTCBoundsFunction bounds = nullptr;
  void* bounds_user = nullptr;
  RTCIntersectFunctionN intersect = nullptr;
  RTCOccludedFunctionN occluded = nullptr;

  // Instances.
  std::vector<Ref<RTCSceneTy>> scenes;
  std::vector<Affine> transforms{1};  ///< at each time step
  std::vector<TurningMap> turning;    ///< if given, in their place

 private:
  Made make() const;
  void grow_tree();

  std::map<Slot, View> views_;
  std::uint64_t version_ = 1, shape_version_ = 1, made_version_ = 0;
  Made made_;
  std::unique_ptr<DynamicAccel> tree_;  ///< of the mesh
  std::uint32_t tree_number_ = 0;       ///< of the mesh in it
};

/// Makes the shape of a geometry's buffers. Primitives whose numbers are out of range, and those that are not
/// finite, have no surface.
Made make_triangles(const Geometry& geometry);
Made make_quads(const Geometry& geometry);
Made make_grids(const Geometry& geometry);
Made make_points(const Geometry& geometry);
Made make_lines(const Geometry& geometry);
Made make_user(const Geometry& geometry);
Made make_instance(const Geometry& geometry);

/// A transform in a format of the interface. Throws ApiError for other formats.
Affine read_transform(RTCFormat format, const void* data);
void write_transform(const Affine& map, RTCFormat format, void* data);

TurningMap to_turning_map(const RTCQuaternionDecomposition& q);

/// The transform of an instance, number `index` of an array, at a time.
Affine transform_at(const Geometry& geometry, std::uint32_t index, float time);

}  // namespace oktett::embree
