#include <fmt/format.h>

#include "core/open_edges.h"
#include "io/scene/readers.h"

namespace oktett {
namespace {

/// Why a shape has no inside; empty if it has one.
struct WhyFlat {
  const SceneLoad& load;

  std::string operator()(const MeshShape& shape) const {
    if (!shape.mesh || shape.by_winding) return "";
    const OpenEdges open = find_open_edges(*shape.mesh);
    if (open.count == 0) return "";
    return fmt::format(
        "the mesh is not closed: {} open edges, the first from ({}, {}, {}) to ({}, {}, {}); only solids can "
        "be combined (`solid: winding` takes it as it is)",
        open.count, open.from.x, open.from.y, open.from.z, open.to.x, open.to.y, open.to.z);
  }
  std::string operator()(const DiskShape&) const { return flat("a disk"); }
  std::string operator()(const PolygonShape&) const { return flat("a polygon"); }
  std::string operator()(const TriangleShape&) const { return flat("a triangle"); }
  std::string operator()(const ExactShape& shape) const {
    const bool open = std::visit(
        [](const auto& form) {
          // Without a box a quadric or a blob has no faces that could be missing.
          if constexpr (requires { form.clipped; })
            return form.open && form.clipped;
          else if constexpr (requires { form.bounded; })
            return form.open && form.bounded;
          else if constexpr (requires { form.open; })
            return form.open;
          else
            return false;
        },
        shape.form);
    return open ? flat("an open surface") : "";
  }
  std::string operator()(const InstanceShape& shape) const {
    if (shape.prototype < load.scene.prototypes.size())
      for (const Object& object : load.scene.prototypes[shape.prototype].objects) {
        const std::string why = std::visit(*this, object.shape);
        if (!why.empty())
          return fmt::format("in prototype '{}': {}", load.scene.prototypes[shape.prototype].name, why);
      }
    return "";
  }
  template <class T>
  std::string operator()(const T&) const {
    return "";
  }
  static std::string flat(const char* what) {
    return std::string(what) + " has no inside; only solids can be combined";
  }
};

}  // namespace

void require_solid(const SceneLoad& load, const Object& object) {
  const std::string why = std::visit(WhyFlat{load}, object.shape);
  if (!why.empty()) throw Error(object.where, why);
}

}  // namespace oktett
