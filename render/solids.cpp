#include "render/solids.h"

#include <algorithm>
#include <variant>

#include "core/mesh_geometry.h"
#include "render/dielectric_stack.h"

namespace oktett {

namespace {

struct IsSolid {
  const std::vector<Prototype>& prototypes;

  bool operator()(const MeshShape& shape) const {
    return shape.mesh != nullptr && shape.stroke_width == 0 &&
           (shape.by_winding || find_open_edges(*shape.mesh).count == 0);
  }
  bool operator()(const ExactShape& shape) const { return !is_open(shape); }
  bool operator()(const CsgShape& shape) const {
    // Where surfaces are among the operands, they may be all that is left.
    const auto is_whole = [](const auto& self, const CsgShape& csg) -> bool {
      return csg.op != CsgOp::surfaces && std::ranges::all_of(*csg.operands, [&](const Object& o) {
               const auto* const inner = std::get_if<CsgShape>(&o.shape);
               return inner == nullptr || self(self, *inner);
             });
    };
    return is_whole(is_whole, shape);
  }
  bool operator()(const InstanceShape& shape) const {
    if (shape.prototype >= prototypes.size()) return false;
    const std::vector<Object>& objects = prototypes[shape.prototype].objects;
    return std::ranges::all_of(objects, [&](const Object& o) { return std::visit(*this, o.shape); });
  }
  template <class T>
  bool operator()(const T&) const {
    return !kIsFlat<T>;
  }
};

}  // namespace

bool is_solid(const Shape& shape, const std::vector<Prototype>& prototypes) {
  return std::visit(IsSolid{prototypes}, shape);
}

/// Whether light enters what is of this material.
static bool lets_light_in(const Scene& scene, std::uint32_t material) {
  return material < scene.materials.size() && encloses(scene.materials[material]);
}

/// The triangles that light enters.
static TriangleMesh entered_part(const MeshShape& shape, const Scene& scene) {
  const TriangleMesh& mesh = *shape.mesh;
  TriangleMesh part;
  part.positions = mesh.positions;
  for (std::size_t i = 0; i < mesh.triangle_count(); ++i) {
    const std::size_t slot = mesh.material_slots[i];
    if (slot >= shape.slot_materials.size() || !lets_light_in(scene, shape.slot_materials[slot])) continue;
    for (std::size_t k = 0; k < 3; ++k) part.indices.push_back(mesh.indices[3 * i + k]);
  }
  return part;
}

bool has_inside(const Object& object, const Scene& scene) {
  if (is_solid(object.shape, scene.prototypes)) return true;
  const auto* const shape = std::get_if<MeshShape>(&object.shape);
  if (shape == nullptr || shape->mesh == nullptr || shape->stroke_width > 0 || object.material != kNoId ||
      shape->mesh->material_slots.empty())
    return false;
  const TriangleMesh part = entered_part(*shape, scene);
  return part.triangle_count() > 0 && find_open_edges(part).count == 0;
}

bool needs_dielectrics(const Scene& scene) {
  if (!traits(scene.integrator.kind).traces_paths) return false;
  return scene.medium != kNoId || std::ranges::any_of(scene.materials, [](const Material& m) {
           return m.interior != kNoId || m.priority != kNoPriority;
         });
}

bool needs_insides(const Scene& scene) {
  if (!traits(scene.integrator.kind).light_from_points) return false;
  return !scene.fogs.empty() || !scene.rainbows.empty() || scene.medium != kNoId ||
         std::ranges::any_of(scene.materials, [](const Material& m) { return m.interior != kNoId; });
}

bool is_entered(const Object& object, const Scene& scene) {
  const auto lets_in = [&](std::uint32_t material) { return lets_light_in(scene, material); };
  const auto* const mesh = std::get_if<MeshShape>(&object.shape);
  const bool by_slot = object.material == kNoId && mesh != nullptr;
  return (by_slot ? std::ranges::any_of(mesh->slot_materials, lets_in) : lets_in(object.material)) &&
         has_inside(object, scene);
}

void check_not_entered(const Object& object, std::uint32_t outer, const Scene& scene, const Location& where) {
  const std::uint32_t material = outer != kNoId ? outer : object.material;
  const auto check_all = [&](const std::vector<Object>& objects) {
    for (const Object& inner : objects) check_not_entered(inner, material, scene, where);
  };
  if (const auto* csg = std::get_if<CsgShape>(&object.shape)) return check_all(*csg->operands);
  const auto* const instance = std::get_if<InstanceShape>(&object.shape);
  if (instance != nullptr && instance->prototype < scene.prototypes.size())
    return check_all(scene.prototypes[instance->prototype].objects);
  const auto lets_in = [&](std::uint32_t number) { return lets_light_in(scene, number); };
  const auto* const mesh = std::get_if<MeshShape>(&object.shape);
  if (material != kNoId || mesh == nullptr ? lets_in(material)
                                           : std::ranges::any_of(mesh->slot_materials, lets_in))
    throw Error(where, "with media or priorities, what light enters must be visible to all rays");
}

}  // namespace oktett
