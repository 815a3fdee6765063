#include "accel/inside.h"

#include <algorithm>

#include "accel/csg/csg_solids.h"
#include "accel/hit_place.h"
#include "accel/instance.h"
#include "kernels/exact_ops.h"
#include "kernels/open_surface.h"

namespace oktett {
namespace {

/// In no special direction, so that few rays run along edges, faces and axes of symmetry.
constexpr Vec3f kDirection{0.4142f, 0.2718f, 0.8686f};

bool has_inside(const Accel& accel, std::uint32_t geometry) {
  const Geometry& g = accel.geometries[geometry];
  if (const auto* exact = std::get_if<ExactShape>(&g.shape)) return !is_open(*exact);
  return !std::holds_alternative<DiskShape>(g.shape) && !std::holds_alternative<PolygonShape>(g.shape);
}

/// The item of an entry of Accel::unbounded that is a shape.
std::uint32_t item_of(const Accel& accel, const LeafEntry& leaf) {
  if (is_exact(leaf.kind)) return accel.exact_pool(leaf.kind).item_of_cell(leaf.begin);
  return std::get<Plane::Pool>(accel.pools).item[leaf.begin];
}

Ray moved_ray(const Affine& m, const Ray& ray) {
  return {Vec3f(m.point(Vec3d(ray.origin))), ray.tmin, Vec3f(m.vector(Vec3d(ray.direction))), ray.tmax};
}

}  // namespace

InsideTest::InsideTest(const Accel& accel, Isa isa)
    : accel_(accel),
      isa_(isa),
      is_one_mesh_(accel.kinds.size() == 1 && static_cast<Kind>(accel.kinds[0]) == Kind::triangle) {
  find_unbounded(accel, Affine{}, kNoId);
}

void InsideTest::find_unbounded(const Accel& accel, const Affine& to_here, std::uint32_t instance) {
  const auto add = [&](std::uint32_t item, bool is_combination) {
    const std::uint32_t geometry = accel.geometry_of(item);
    // A surface may have several cells.
    if (!unbounded_.empty() && unbounded_.back().accel == &accel && unbounded_.back().instance == instance &&
        unbounded_.back().item == item)
      return;
    if (has_inside(accel, geometry))
      unbounded_.push_back({&accel, geometry, instance, item, is_combination, to_here});
  };
  for (const LeafEntry& leaf : accel.unbounded) {
    if (leaf.kind == Kind::csg)
      add(accel.combinations[leaf.begin].item, true);
    else if (!holds_instances(leaf.kind))
      add(item_of(accel, leaf), false);
    else
      each_instance(accel, leaf, [&](const auto& shown, const Accel& child) {
        find_unbounded(child, Affine::from_rows(shown.to_child) * to_here,
                       instance + (outer_path(shown, kNoId) + 1));
        return true;
      });
  }
}

bool InsideTest::is_inside(const Ray& ray, std::span<const Hit> hits) const {
  if (is_one_mesh_) return hits.size() % 2 == 1;
  // A solid, and whether its crossings count.
  struct Crossed {
    std::uint32_t instance, item;
    bool operator==(const Crossed&) const = default;
    bool operator<(const Crossed& b) const {
      return instance != b.instance ? instance < b.instance : item < b.item;
    }
  };
  static thread_local std::vector<Crossed> crossed;
  crossed.clear();
  for (const Hit& hit : hits) {
    const CrossedSolid solid = crossed_solid(accel_, hit);
    if (has_inside(*solid.accel, solid.geometry)) crossed.push_back({solid.instance, solid.item});
  }
  for (const Unbounded& u : unbounded_) {
    const bool runs = runs_inside(*u.accel, u.geometry, moved_ray(u.to_here, ray));
    const Crossed solid{u.instance, u.item};
    if (!u.is_combination) {
      if (runs) return true;
      std::erase(crossed, solid);
    } else if (runs) {
      crossed.push_back(solid);
    }
  }
  std::sort(crossed.begin(), crossed.end());
  for (std::size_t i = 0; i < crossed.size();) {
    const std::size_t first = i;
    while (i < crossed.size() && crossed[i] == crossed[first]) ++i;
    if ((i - first) % 2 == 1) return true;
  }
  return false;
}

void InsideTest::operator()(const PointSpan& points, std::uint8_t* answers) const {
  static thread_local RayBatch rays;
  static thread_local HitLists lists;
  static thread_local std::vector<std::size_t> asked;
  asked.clear();
  for (std::size_t i = 0; i < points.size; ++i) {
    answers[i] = 0;
    const Vec3f p = points[i];
    if (is_finite(p) && (!unbounded_.empty() || accel_.bounds.contains(p))) asked.push_back(i);
  }
  rays.resize_uninitialized(asked.size());
  for (std::size_t k = 0; k < asked.size(); ++k) rays.set(k, {points[asked[k]], 0, kDirection});
  all_hits(accel_, rays.span(), lists, isa_);
  for (std::size_t k = 0; k < asked.size(); ++k) answers[asked[k]] = is_inside(rays[k], lists.of_ray(k));
}

}  // namespace oktett
