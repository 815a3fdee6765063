#include "accel/geometry_bounds.h"

#include <algorithm>
#include <cmath>

#include "accel/accel_data.h"
#include "core/mesh_geometry.h"
#include "kernels/exact_ops.h"

namespace oktett {

Kind kind_of(const Geometry& g) {
  if (std::holds_alternative<MeshGeometry>(g.shape)) return Kind::triangle;
  if (const auto* exact = std::get_if<ExactShape>(&g.shape)) return kind_of(exact->form);
  if (std::holds_alternative<CsgGeometry>(g.shape)) return Kind::csg;
  if (std::holds_alternative<InstanceList>(g.shape)) return Kind::instance_list;
  Kind kind = Kind::instance;
  visit_closed_form(g.shape, [&](auto, Kind found, const auto&) { kind = found; });
  return kind;
}

Box instance_bounds(const Affine& to_world, const Accel& child) {
  // Then rays stay the same to the last bit.
  if (to_world.is_identity()) return child.bounds;
  Box b = transform_bounds(to_world, child.bounds);
  if (b.empty()) return b;
  const Vec3f e = b.extent();
  const float pad = 0x1p-20f * std::max({e.x, e.y, e.z, max_component(abs(b.lo)), max_component(abs(b.hi))});
  b.lo -= Vec3f{pad, pad, pad}, b.hi += Vec3f{pad, pad, pad};
  return b;
}

bool is_unbounded(const Geometry& g) {
  if (const auto* i = std::get_if<InstanceGeometry>(&g.shape)) return !i->child->unbounded.empty();
  if (const auto* list = std::get_if<InstanceList>(&g.shape))
    return std::any_of(list->children.begin(), list->children.end(),
                       [](const auto& child) { return !child->unbounded.empty(); });
  if (const auto* exact = std::get_if<ExactShape>(&g.shape)) return is_unbounded(*exact, g.transform);
  bool unbounded = false;
  visit_closed_form(g.shape, [&]<class S>(S, Kind, const auto&) { unbounded = !kHasBounds<S>; });
  return unbounded;
}

Box geometry_bounds(const Geometry& g) {
  Box box;
  if (const auto* mesh = std::get_if<MeshGeometry>(&g.shape)) {
    each_corner(*mesh->mesh, [&](const Vec3f& p) {
      const Vec3d q = g.transform.point(Vec3d(p));
      box.grow(Box{round_down(q), round_up(q)});
    });
  } else if (const auto* exact = std::get_if<ExactShape>(&g.shape)) {
    box = exact_bounds(*exact, g.transform);
  } else if (const auto* instance = std::get_if<InstanceGeometry>(&g.shape)) {
    box = instance_bounds(g.transform, *instance->child);
  } else if (const auto* list = std::get_if<InstanceList>(&g.shape)) {
    for (const InstancePlace& place : list->places)
      if (place.child < list->children.size())
        box.grow(
            instance_bounds(g.transform * Affine::from_rows(place.to_list), *list->children[place.child]));
  }
  visit_closed_form(g.shape, [&]<class S>(S, Kind, const auto& data) {
    for (std::size_t i = 0; i < shape_count<S>(data); ++i)
      box.grow(moved_bounds<S>(nth_shape<S>(data, i), g.transform));
  });
  return box;
}

}  // namespace oktett
