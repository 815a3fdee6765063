#include <fmt/format.h>

#include "core/mesh_geometry.h"
#include "io/scene/readers.h"
#include "render/geometry.h"

namespace oktett {
namespace {

/// Why a shape has no inside; empty if it has one.
struct WhyFlat {
  const SceneLoad& load;
  const std::string& why;

  std::string operator()(const MeshShape& shape) const {
    if (!shape.mesh || shape.by_winding) return "";
    const OpenEdges open = find_open_edges(*shape.mesh);
    if (open.count == 0) return "";
    return fmt::format(
        "the mesh is not closed: {} open edges, the first from ({}, {}, {}) to ({}, {}, {}); {} "
        "(`solid: winding` takes it as it is)",
        open.count, open.from.x, open.from.y, open.from.z, open.to.x, open.to.y, open.to.z, why);
  }
  std::string operator()(const ExactShape& shape) const {
    return is_open(shape) ? flat("an open surface") : "";
  }
  std::string operator()(const InstanceShape& shape) const {
    if (shape.prototype < load.scene.prototypes.size())
      for (const Object& object : load.scene.prototypes[shape.prototype].objects) {
        const std::string flat = std::visit(*this, object.shape);
        if (!flat.empty())
          return fmt::format("in prototype '{}': {}", load.scene.prototypes[shape.prototype].name, flat);
      }
    return "";
  }
  template <class T>
  std::string operator()(const T&) const {
    if constexpr (kIsFlat<T>) return flat(std::string("a ") + T::kShapeInfo.key);
    return "";
  }
  std::string flat(const std::string& what) const { return what + " has no inside; " + why; }
};

}  // namespace

void require_solid(const SceneLoad& load, const Object& object, const std::string& why) {
  const std::string flat = std::visit(WhyFlat{load, why}, object.shape);
  if (!flat.empty()) throw Error(object.where, flat);
}

}  // namespace oktett
