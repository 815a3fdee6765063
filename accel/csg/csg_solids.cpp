#include "accel/csg/csg_solids.h"

#include <algorithm>
#include <cmath>

#include "accel/accel_data.h"
#include "accel/geometry_bounds.h"
#include "kernels/exact_ops.h"

namespace oktett {
namespace {

/// A half-line in double.
struct HalfLine {
  Vec3d origin, direction;

  HalfLine moved(const Affine& m) const { return {m.point(origin), m.vector(direction)}; }
};

bool is_inside(const Accel& accel, std::uint32_t geometry, const HalfLine& line);

/// The combination's state far along the line. Bounded solids are not there.
bool is_inside(const CsgItem& csg, const HalfLine& line) {
  const Accel& solids = *csg.solids;
  double size = length(line.origin);
  if (!solids.bounds.empty()) size += max_component(max(abs(solids.bounds.lo), abs(solids.bounds.hi)));
  const double far = 0x1p30 * (1 + size) / length(line.direction);
  const HalfLine end{line.origin + line.direction * far, line.direction};
  std::vector<char> inside(csg.nodes.size(), 0);
  for (const std::uint32_t geometry : csg.unbounded)
    if (is_inside(solids, geometry, end)) inside[csg.operand_of[geometry]] = 1;
  // Children stand behind their parents, the first of them in front of the others.
  const auto evaluate = [&](const auto& self, std::uint32_t node) -> bool {
    const CsgOp op = csg.nodes[node].op;
    if (op == CsgOp::operand) return inside[node] != 0;
    std::uint32_t met = 0, first = 0;
    for (std::uint32_t k = node + 1; k < csg.nodes.size(); ++k) {
      if (csg.nodes[k].parent != node || !self(self, k)) continue;
      ++met;
      if (csg.nodes[k].is_first) first = 1;
    }
    if (op == CsgOp::unite) return met > 0;
    if (op == CsgOp::intersect) return met > 0 && met == csg.nodes[node].children;
    return first == 1 && met == 1;
  };
  return evaluate(evaluate, 0);
}

/// Inside of something in `child` that may reach to where the line ends.
bool is_inside_unbounded(const Accel& child, const HalfLine& line) {
  for (std::uint32_t i = 0; i < child.geometries.size(); ++i)
    if ((is_unbounded(child.geometries[i]) ||
         std::holds_alternative<CsgGeometry>(child.geometries[i].shape)) &&
        is_inside(child, i, line))
      return true;
  return false;
}

bool is_inside(const Accel& accel, std::uint32_t geometry, const HalfLine& line) {
  const Geometry& g = accel.geometries[geometry];
  if (const auto* instance = std::get_if<InstanceGeometry>(&g.shape))
    return is_inside_unbounded(*instance->child, line.moved(accel.frames[geometry].inverse));
  if (std::holds_alternative<InstanceList>(g.shape)) {
    return std::any_of(accel.listed_instances.begin(), accel.listed_instances.end(),
                       [&](const ListedInstance& listed) {
                         return accel.geometry_of(listed.item) == geometry &&
                                is_inside_unbounded(*accel.listed_children[listed.child],
                                                    line.moved(Affine::from_rows(listed.to_child)));
                       });
  }
  if (std::holds_alternative<CsgGeometry>(g.shape)) {
    for (const CsgItem& csg : accel.combinations)
      if (csg.item == accel.first_item[geometry]) return is_inside(csg, line);
    return false;
  }
  const Kind kind = static_cast<Kind>(accel.kinds[geometry]);
  if (!is_shape(kind)) return false;
  const std::uint32_t i = accel.index_in_pool(geometry, 0);
  if (i == kNoId) return false;
  if (is_exact(kind)) {
    const ExactPoolBase& pool = accel.exact_pool(kind);
    return exact_ops(kind).inside(pool, i, pool.frames[i].to_own.point(line.origin));
  }
  bool inside = false;
  visit_pool(kind, accel.pools, [&](auto shape, const auto& pool) {
    using S = decltype(shape);
    if constexpr (kSolid<S>) inside = S::inside(pool, i, line.origin);
  });
  return inside;
}

}  // namespace

bool runs_inside(const Accel& accel, std::uint32_t geometry, const Ray& ray) {
  const Vec3d direction(ray.direction);
  return is_inside(accel, geometry, {Vec3d(ray.origin) + direction * double(ray.tmin), direction});
}

}  // namespace oktett
