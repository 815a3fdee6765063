#include "render/photon/casters.h"

#include <algorithm>
#include <map>

#include "accel/accel_data.h"
#include "accel/geometry_bounds.h"
#include "render/bsdf/principled/base.h"

namespace oktett {

/// Whether a number that a texture may multiply can be below `limit`.
static bool may_be_below(double value, std::uint32_t texture, double limit) {
  return texture != kNoId || !(value >= limit);
}

bool may_cast(const Material& m) {
  if (!m.principled) return m.reflection != 0 || m.transparency != 0;
  const PrincipledMaterial& p = *m.principled;
  if (may_be_below(p.parameters.roughness, p.roughness_texture, kLeastRoughness)) return true;
  if (p.parameters.coat != 0 &&
      may_be_below(p.parameters.coat_roughness, p.coat_roughness_texture, kLeastRoughness))
    return true;
  // Glass that hardly bends light is smooth whatever its roughness. What lies around it may be as dense.
  return p.parameters.transmission != 0 && (m.priority != kNoPriority || p.ior_texture != kNoId ||
                                            std::abs(p.parameters.ior - 1) < 2 * kLeastIorDifference);
}

namespace {

class CasterSearch {
 public:
  explicit CasterSearch(const World& world) : world_(world) {
    for (const Material& m : world.materials) casts_.push_back(may_cast(m));
  }

  Casters find() {
    if (std::find(casts_.begin(), casts_.end(), true) == casts_.end()) return {};
    for (const Geometry& g : world_.accel->geometries) {
      if (!casts(g, kNoId)) continue;
      const Box box = geometry_bounds(g);
      if (!box.empty()) found_.bounds.grow(box);
      if (is_unbounded(g)) found_.unbounded = true;
    }
    return found_;
  }

 private:
  /// Whether a material of the object casts.
  bool casts(std::uint32_t user) const {
    if (casts_[material_index(world_, user, 0)]) return true;
    if (user >= world_.objects.size() || world_.objects[user].material != kNoId) return false;
    for (std::uint32_t slot = 1; slot < world_.objects[user].slots.size(); ++slot)
      if (casts_[material_index(world_, user, slot)]) return true;
    return false;
  }

  /// `outer`: the `user` of the outermost instance that has one.
  bool casts(const Geometry& g, std::uint32_t outer) {
    const std::uint32_t user = outer != kNoId ? outer : g.user;
    if (const auto* instance = std::get_if<InstanceGeometry>(&g.shape)) return casts(*instance->child, user);
    if (const auto* list = std::get_if<InstanceList>(&g.shape))
      return std::any_of(list->places.begin(), list->places.end(), [&](const InstancePlace& place) {
        return casts(*list->children[place.child], user != kNoId ? user : place.user);
      });
    if (const auto* csg = std::get_if<CsgGeometry>(&g.shape)) return casts(*csg->expression, user);
    return casts(user);
  }

  bool casts(const CsgExpression& expression, std::uint32_t outer) {
    return std::any_of(expression.solids.begin(), expression.solids.end(),
                       [&](const Geometry& solid) { return casts(solid, outer); }) ||
           std::any_of(expression.children.begin(), expression.children.end(),
                       [&](const CsgExpression& child) { return casts(child, outer); });
  }

  /// A structure that many instances show is looked at once.
  bool casts(const Accel& accel, std::uint32_t outer) {
    if (outer != kNoId) return casts(outer);
    const auto known = structures_.find(&accel);
    if (known != structures_.end()) return known->second;
    const bool any = std::any_of(accel.geometries.begin(), accel.geometries.end(),
                                 [&](const Geometry& g) { return casts(g, kNoId); });
    return structures_[&accel] = any;
  }

  const World& world_;
  std::vector<bool> casts_;  ///< by material
  std::map<const Accel*, bool> structures_;
  Casters found_;
};

}  // namespace

Casters find_casters(const World& world) { return CasterSearch(world).find(); }

}  // namespace oktett
