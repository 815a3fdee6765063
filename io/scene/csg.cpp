#include "io/scene/csg.h"

#include <fmt/format.h>

#include <utility>

#include "core/open_edges.h"

namespace oktett {
namespace {

struct CsgKey {
  const char* name;
  CsgOp op;
};
constexpr CsgKey kKeys[] = {
    {"union", CsgOp::unite}, {"intersection", CsgOp::intersect}, {"difference", CsgOp::subtract}};

/// Why a shape has no inside; empty if it has one.
struct WhyFlat {
  const SceneLoad& load;

  std::string operator()(const MeshShape& shape) const {
    if (!shape.mesh || shape.by_winding) return "";
    const OpenEdges open = find_open_edges(*shape.mesh);
    if (open.count == 0) return "";
    return fmt::format(
        "the mesh is not closed: {} open edges, the first from ({}, {}, {}) to ({}, {}, {}); only solids can "
        "be "
        "combined (`solid: winding` takes it as it is)",
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

bool is_csg_key(const std::string& key) {
  for (const CsgKey& k : kKeys)
    if (key == k.name) return true;
  return false;
}

std::vector<std::string> csg_keys() {
  std::vector<std::string> keys;
  for (const CsgKey& k : kKeys) keys.push_back(k.name);
  return keys;
}

void require_solid(const SceneLoad& load, const Object& object) {
  const std::string why = std::visit(WhyFlat{load}, object.shape);
  if (!why.empty()) throw Error(object.where, why);
}

CsgShape make_csg(const std::string& key, std::vector<Object> operands) {
  CsgShape shape;
  for (const CsgKey& k : kKeys)
    if (key == k.name) shape.op = k.op;
  shape.operands = std::make_shared<const std::vector<Object>>(std::move(operands));
  return shape;
}

Object unite(std::vector<Object> members, const Location& where) {
  if (members.size() == 1) return std::move(members.front());
  Object object;
  object.shape = CsgShape{CsgOp::unite, std::make_shared<const std::vector<Object>>(std::move(members))};
  object.where = where;
  return object;
}

}  // namespace oktett
