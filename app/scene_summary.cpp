#include "app/scene_summary.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <variant>
#include <vector>

#include "core/open_edges.h"
#include "kernels/exact_ops.h"

namespace oktett {
namespace {

void grow(Box& box, const Vec3d& p) { box.grow(Box{round_down(p), round_up(p)}); }

Box points_bounds(const auto& points) {
  Box box;
  for (const Vec3d& p : points) grow(box, p);
  return box;
}

Box sphere_bounds(const SphereShape& sphere) {
  const Vec3d r{sphere.radius, sphere.radius, sphere.radius};
  return {round_down(sphere.center - r), round_up(sphere.center + r)};
}

/// Bounds of one shape in its own space; empty if it is unbounded.
struct ShapeBounds {
  const std::vector<Box>& prototypes;

  Box operator()(const MeshShape& shape) const {
    Box box;
    if (shape.mesh)
      for (const Vec3f& p : shape.mesh->positions) box.grow(p);
    return box;
  }
  Box operator()(const SphereShape& shape) const { return sphere_bounds(shape); }
  Box operator()(const SpheresShape& shape) const {
    Box box;
    for (const SphereShape& sphere : shape.spheres) box.grow(sphere_bounds(sphere));
    return box;
  }
  Box operator()(const PlaneShape&) const { return {}; }
  Box operator()(const DiskShape& shape) const {
    const Vec3d n = normalize(shape.normal);
    const auto reach = [&](double c) { return shape.radius * std::sqrt(std::max(0.0, 1 - c * c)); };
    const Vec3d extent{reach(n.x), reach(n.y), reach(n.z)};
    return {round_down(shape.center - extent), round_up(shape.center + extent)};
  }
  Box operator()(const BoxShape& shape) const { return {round_down(shape.min), round_up(shape.max)}; }
  Box operator()(const PolygonShape& shape) const { return points_bounds(shape.vertices); }
  Box operator()(const TriangleShape& shape) const { return points_bounds(shape.v); }
  Box operator()(const ExactShape& shape) const { return exact_bounds(shape, {}); }
  Box operator()(const CsgShape& shape) const;
  Box operator()(const InstanceShape& shape) const {
    return shape.prototype < prototypes.size() ? prototypes[shape.prototype] : Box{};
  }
};

/// Tight for a mesh, whose box would grow when it is turned.
Box object_bounds(const Object& object, const std::vector<Box>& prototypes) {
  const auto* shape = std::get_if<MeshShape>(&object.shape);
  if (shape == nullptr || object.transform.is_identity()) {
    const Box box = std::visit(ShapeBounds{prototypes}, object.shape);
    return box.empty() || object.transform.is_identity() ? box : transform_bounds(object.transform, box);
  }
  Box box;
  for (const Vec3f& p : shape->mesh->positions) grow(box, object.transform.point(static_cast<Vec3d>(p)));
  return box;
}

/// Bounds of all operands together: what remains of them is known only after building the combination.
Box ShapeBounds::operator()(const CsgShape& shape) const {
  Box box;
  for (const Object& object : *shape.operands) box.grow(object_bounds(object, prototypes));
  return box;
}

class Counter {
 public:
  explicit Counter(const Scene& scene) {
    // A prototype holds instances of those before it only.
    for (const Prototype& prototype : scene.prototypes) {
      prototype_triangles_.push_back(count(prototype.objects));
      prototype_bounds_.push_back(std::exchange(summary_.bounds, {}));
    }
    summary_.triangles_shown = count(scene.objects);
  }

  const SceneSummary& summary() const { return summary_; }

 private:
  /// Returns the triangles that the objects show, including the contents of instances, and grows the bounds.
  double count(const std::vector<Object>& objects) {
    double triangles = 0;
    for (const Object& object : objects) {
      summary_.bounds.grow(object_bounds(object, prototype_bounds_));
      triangles += count_shape(object.shape);
    }
    return triangles;
  }

  /// Returns the triangles that the shape shows.
  double count_shape(const Shape& shape) {
    if (const auto* mesh = std::get_if<MeshShape>(&shape)) return count_mesh(*mesh);
    if (const auto* instance = std::get_if<InstanceShape>(&shape)) {
      ++summary_.instances;
      return instance->prototype < prototype_triangles_.size() ? prototype_triangles_[instance->prototype]
                                                               : 0;
    }
    const auto* spheres = std::get_if<SpheresShape>(&shape);
    summary_.other_shapes += spheres != nullptr ? spheres->spheres.size() : 1;
    summary_.unbounded += std::holds_alternative<PlaneShape>(shape) ? 1 : 0;
    return 0;
  }

  double count_mesh(const MeshShape& shape) {
    if (!shape.mesh) return 0;
    const TriangleMesh& mesh = *shape.mesh;
    if (seen_.insert(&mesh).second) {
      ++summary_.meshes;
      summary_.triangles += mesh.triangle_count();
      summary_.vertices += mesh.positions.size();
      summary_.mesh_bytes += mesh.bytes();
      summary_.open_edges += find_open_edges(mesh).count;
    }
    return static_cast<double>(mesh.triangle_count());
  }

  SceneSummary summary_;
  std::set<const TriangleMesh*> seen_;
  std::vector<Box> prototype_bounds_;
  std::vector<double> prototype_triangles_;
};

}  // namespace

SceneSummary summarize(const Scene& scene) { return Counter(scene).summary(); }

}  // namespace oktett
