#include "accel/geometry_bounds.h"

#include <algorithm>
#include <cmath>

#include "accel/accel_data.h"
#include "kernels/exact_ops.h"

namespace oktett {

Kind kind_of(const Geometry& g) {
  if (std::holds_alternative<MeshGeometry>(g.shape)) return Kind::triangle;
  if (std::holds_alternative<SpheresShape>(g.shape)) return Kind::sphere;
  if (std::holds_alternative<PlaneShape>(g.shape)) return Kind::plane;
  if (std::holds_alternative<DiskShape>(g.shape)) return Kind::disk;
  if (std::holds_alternative<BoxShape>(g.shape)) return Kind::box;
  if (std::holds_alternative<PolygonShape>(g.shape)) return Kind::polygon;
  if (const auto* exact = std::get_if<ExactShape>(&g.shape)) return kind_of(exact->form);
  if (std::holds_alternative<CsgGeometry>(g.shape)) return Kind::csg;
  return std::holds_alternative<InstanceList>(g.shape) ? Kind::instance_list : Kind::instance;
}

SphereShape moved_sphere(const SphereShape& s, const Affine& m) {
  return {m.point(s.center), s.radius * m.uniform_scale()};
}

PlaneShape moved_plane(const PlaneShape& s, const Affine& m) {
  const Vec3d n = normalize(s.normal);
  const Vec3d p = m.point(n * s.offset);
  const Vec3d q = normalize(m.inverse().normal_by_inverse(n));
  return {q, dot(q, p)};
}

Box shape_bounds(const Geometry& g, std::size_t local) {
  const Affine& m = g.transform;
  if (const auto* s = std::get_if<SpheresShape>(&g.shape)) {
    const SphereShape moved = moved_sphere(s->spheres[local], m);
    if (!(moved.radius > 0) || !is_finite(moved.center)) return {};
    return Sphere::bounds(moved);
  }
  if (const auto* s = std::get_if<DiskShape>(&g.shape)) {
    if (!(s->radius > 0) || !(length(s->normal) > 0)) return {};
    Disk::Pool p;
    Disk::add(
        p, {m.point(s->center), m.inverse().normal_by_inverse(s->normal), s->radius * m.uniform_scale()}, 0);
    return Disk::bounds(p, 0);
  }
  if (const auto* s = std::get_if<BoxShape>(&g.shape)) {
    if (!(s->min.x < s->max.x && s->min.y < s->max.y && s->min.z < s->max.z)) return {};
    BoxSolid::Pool p;
    BoxSolid::add(p, *s, m, 0);
    return BoxSolid::bounds(p, 0);
  }
  if (const auto* s = std::get_if<PolygonShape>(&g.shape)) {
    if (s->vertices.size() < 3 || !(length(Polygon::area_normal(s->vertices)) > 0)) return {};
    PolygonShape moved = *s;
    for (Vec3d& v : moved.vertices) v = m.point(v);
    Polygon::Pool p;
    Polygon::add(p, moved, 0);
    return Polygon::bounds(p, 0);
  }
  return {};
}

Box instance_bounds(const Affine& to_world, const Accel& child) {
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
  return std::holds_alternative<PlaneShape>(g.shape);
}

Box geometry_bounds(const Geometry& g) {
  Box box;
  if (const auto* mesh = std::get_if<MeshGeometry>(&g.shape)) {
    for (const Vec3f& p : mesh->mesh->positions) {
      const Vec3d q = g.transform.point(Vec3d(p));
      box.grow(Box{round_down(q), round_up(q)});
    }
  } else if (const auto* spheres = std::get_if<SpheresShape>(&g.shape)) {
    for (std::size_t i = 0; i < spheres->spheres.size(); ++i) box.grow(shape_bounds(g, i));
  } else if (const auto* exact = std::get_if<ExactShape>(&g.shape)) {
    box = exact_bounds(*exact, g.transform);
  } else if (const auto* instance = std::get_if<InstanceGeometry>(&g.shape)) {
    box = instance_bounds(g.transform, *instance->child);
  } else if (const auto* list = std::get_if<InstanceList>(&g.shape)) {
    for (const InstancePlace& place : list->places)
      if (place.child < list->children.size())
        box.grow(
            instance_bounds(g.transform * Affine::from_rows(place.to_list), *list->children[place.child]));
  } else {
    box = shape_bounds(g, 0);
  }
  return box;
}

}  // namespace oktett
