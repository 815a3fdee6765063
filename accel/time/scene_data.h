#pragma once
/// \file A scene as it is traced.

#include <algorithm>
#include <memory>
#include <vector>

#include "accel/time/time_tree.h"
#include "accel/trace_scene.h"
#include "kernels/triangle/triangle_block.h"

namespace oktett {

/// Whether it shows other scenes.
inline bool is_instance(const SceneGeometry& g) {
  return std::holds_alternative<SceneInstance>(g.shape) || std::holds_alternative<SceneInstances>(g.shape);
}

/// The items of a tree: the primitives of some geometries of the scene, one after the other.
struct ItemTable {
  std::vector<std::uint32_t> geometry;  ///< places in TraceScene::geometries
  std::vector<std::uint32_t> first{0};  ///< of each, the first item, and their number at the end

  struct Place {
    std::uint32_t geometry, primitive;
  };
  Place operator[](std::uint32_t item) const {
    const auto after = std::upper_bound(first.begin(), first.end(), item);
    const auto k = static_cast<std::size_t>(after - first.begin()) - 1;
    return {geometry[k], item - first[k]};
  }
  std::uint32_t count() const { return first.back(); }
};

/// A geometry of the fixed structure.
struct FixedGeometry {
  ItemTable::Place place;  ///< in TraceScene::geometries, and which of an array of instances it is
  /// The normals of its triangles, if it is a mesh that stands as it is: a hit then reads one place in memory
  /// instead of six.
  Column<Vec3f> normals;
};

/// What moves with one number of keys, and what a callback tests.
struct MovingPart {
  std::unique_ptr<const TimeTree> tree;
  ItemTable items;
  float begin = 0, end = 1;  ///< SceneGeometry::begin and end

  /// Whether there is anything at a time.
  bool is_there(float time) const {
    return tree->keys < 2 || (begin == 0 && end == 1) ||
           (begin <= time && (time < end || (end >= 1 && time <= end)));
  }
  /// The time of which the keys are from 0 to 1.
  float own_time(float time) const { return begin == 0 && end == 1 ? time : (time - begin) / (end - begin); }
};

class TraceScene {
 public:
  std::vector<SceneGeometry> geometries;
  std::shared_ptr<const Accel> fixed;  ///< never null
  std::vector<FixedGeometry> fixed_geometries;
  std::vector<MovingPart> moving;
  Box bounds;                ///< at all times
  std::uint32_t levels = 0;  ///< of instances
  // Here or in a scene inside:
  bool has_simple_hits = true;  ///< all that does not move are triangles and spheres
  bool has_pieces = false;      ///< a triangle may stand in several leaves of what does not move
  bool has_masks = false;       ///< a mask is not ~0
  bool has_closest_filters = false, has_any_filters = false;
  /// Hits are those of `fixed` alone, and nobody judges them.
  bool is_plain_closest = false, is_plain_any = false;

  /// The scene that instance `index` of a geometry shows.
  const TraceScene& child(std::uint32_t geometry, std::uint32_t index) const {
    const auto& shape = geometries[geometry].shape;
    if (const auto* const one = std::get_if<SceneInstance>(&shape)) return *one->child;
    const auto& many = std::get<SceneInstances>(shape);
    return *many.children[many.places[index].child];
  }
};

}  // namespace oktett
