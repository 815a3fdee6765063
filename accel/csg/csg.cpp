#include "accel/csg/csg.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <utility>

#include "accel/accel_data.h"
#include "accel/geometry_bounds.h"
#include "accel/winding/mesh_sense.h"
#include "kernels/exact_ops.h"

namespace oktett {

namespace {

/// The structures that an instance or a list of instances shows.
std::vector<const Accel*> children_of(const Geometry& g) {
  std::vector<const Accel*> children;
  if (const auto* instance = std::get_if<InstanceGeometry>(&g.shape))
    children.push_back(instance->child.get());
  if (const auto* list = std::get_if<InstanceList>(&g.shape))
    for (const auto& child : list->children) children.push_back(child.get());
  return children;
}

/// Finds the senses of the meshes in `accel` and its instances, so that no ray has to. Returns whether there
/// are meshes. `seen`: structures that have been visited, so that each is visited once however many instances
/// show it.
bool prepare_senses(const Accel& accel, std::set<const Accel*>& seen) {
  if (!seen.insert(&accel).second) return false;
  bool has_meshes = false;
  for (std::uint32_t g = 0; g < accel.geometries.size(); ++g) {
    if (std::holds_alternative<MeshGeometry>(accel.geometries[g].shape))
      mesh_sense(accel, g), has_meshes = true;
    for (const Accel* child : children_of(accel.geometries[g])) has_meshes |= prepare_senses(*child, seen);
  }
  return has_meshes;
}

/// Whether one call lists all crossings with a solid.
bool is_primitive(const Accel& solids, Kind kind) {
  bool solid = is_exact(kind) && exact_ops(kind).lists_at_once();
  visit_pool(kind, solids.pools, [&]<class S>(S, const auto&) { solid = kSolid<S>; });
  return solid;
}

/// Whether the crossings of all solids can be listed in lanes.
bool fits_lanes(const CsgItem& csg) {
  const Accel& solids = *csg.solids;
  if (solids.first_item.back() > 0x7fffffff) return false;
  return std::all_of(solids.kinds.begin(), solids.kinds.end(),
                     [&](std::uint8_t k) { return is_primitive(solids, static_cast<Kind>(k)); });
}

void number_solids(CsgItem& csg) {
  const Accel& solids = *csg.solids;
  std::uint32_t count = 0;
  for (std::size_t g = 0; g < solids.kinds.size(); ++g) {
    csg.first_solid.push_back(count);
    count +=
        is_shape(static_cast<Kind>(solids.kinds[g])) ? solids.first_item[g + 1] - solids.first_item[g] : 1;
  }
  csg.first_solid.push_back(count);
}

/// Nodes outside of which there is nothing of the combination.
std::vector<bool> needed_nodes(const CsgItem& csg) {
  std::vector<bool> needed(csg.nodes.size());
  // Parents stand before their children.
  for (std::size_t node = 0; node < csg.nodes.size(); ++node) {
    const CsgNode& n = csg.nodes[node];
    if (n.parent == kNoId) {
      needed[node] = true;
      continue;
    }
    const CsgNode& above = csg.nodes[n.parent];
    const bool contains_all =
        above.op == CsgOp::intersect || (above.op == CsgOp::subtract && n.is_first) || above.children == 1;
    needed[node] = needed[n.parent] && contains_all;
  }
  return needed;
}

/// Finds the needed geometries: operands of one solid outside of which there is nothing of the combination.
/// Orders the leaves so that theirs come first.
void find_needed(CsgItem& csg) {
  const Accel& solids = *csg.solids;
  const std::vector<bool> nodes = needed_nodes(csg);
  std::vector<std::uint32_t> count(csg.nodes.size());
  for (std::size_t g = 0; g < csg.operand_of.size(); ++g)
    count[csg.operand_of[g]] += csg.first_solid[g + 1] - csg.first_solid[g];
  std::set<std::uint8_t> kinds;
  for (std::size_t g = 0; g < csg.operand_of.size(); ++g) {
    const std::uint32_t node = csg.operand_of[g];
    csg.needed.push_back(nodes[node] && count[node] == 1 && csg.nodes[node].op != CsgOp::surfaces);
    if (csg.needed.back() != 0) kinds.insert(solids.kinds[g]);
  }
  csg.leaf_order.resize(solids.leaves.size());
  std::iota(csg.leaf_order.begin(), csg.leaf_order.end(), 0u);
  std::stable_partition(csg.leaf_order.begin(), csg.leaf_order.end(), [&](std::uint32_t leaf) {
    return kinds.contains(static_cast<std::uint8_t>(solids.leaves[leaf].kind));
  });
}

/// Those of the needed geometries that are primitives.
void find_probes(CsgItem& csg) {
  const Accel& solids = *csg.solids;
  const auto add = [&](const LeafEntry& leaf) {
    if (!is_primitive(solids, leaf.kind)) return;
    for (std::uint32_t k = leaf.begin; k < leaf.begin + leaf.count; ++k) {
      std::uint32_t item = kNoId;
      if (is_exact(leaf.kind)) item = solids.exact_pool(leaf.kind).item_of_cell(k);
      visit_pool(leaf.kind, solids.pools, [&](auto, const auto& pool) { item = pool.item[k]; });
      const std::uint32_t g = solids.geometry_of(item);
      if (csg.needed[g] != 0)
        csg.probes.push_back({{k, 1, leaf.kind, leaf.test}, g, is_unbounded(solids.geometries[g])});
    }
  };
  for (const LeafEntry& leaf : solids.unbounded) add(leaf);
  for (const LeafEntry& leaf : solids.leaves) add(leaf);
}

constexpr std::uint32_t kAll = ~std::uint32_t{0};

CsgStep step_of(const CsgItem& csg, std::uint32_t node) {
  const CsgNode& n = csg.nodes[node];
  CsgStep step{0, n.op == CsgOp::unite ? kAll : 0, n.op == CsgOp::operand || n.children == 0 ? 0 : kAll};
  if (n.op == CsgOp::unite) step.initial = kAll;
  if (n.parent == kNoId) return step;
  const CsgOp above = csg.nodes[n.parent].op;
  step.parent = n.parent;
  if (above == CsgOp::unite || (above == CsgOp::subtract && !n.is_first)) step.flip ^= kAll;
  return step;
}

}  // namespace

CsgExpression moved(CsgExpression e, const Affine& m) {
  for (Geometry& g : e.solids) g.transform = m * g.transform;
  for (CsgExpression& child : e.children) child = moved(std::move(child), m);
  for (Geometry& window : e.windows) window.transform = m * window.transform;
  return e;
}

/// An operand with combinations among its solids, as the union of these and of its other solids.
static CsgExpression expanded(const CsgExpression& operand) {
  CsgExpression all;
  all.op = CsgOp::unite;
  for (const Geometry& g : operand.solids) {
    const auto* csg = std::get_if<CsgGeometry>(&g.shape);
    if (csg == nullptr)
      all.children.push_back({operand.op, {g}, {}});
    else if (csg->expression)
      all.children.push_back(moved(*csg->expression, g.transform));
  }
  return all;
}

CsgItem build_csg(const CsgExpression& expression, const BuildOptions& options) {
  CsgItem csg;
  std::vector<Geometry> solids;
  std::set<const Accel*> seen;
  const auto add = [&](const auto& self, const CsgExpression& e, std::uint32_t parent,
                       bool is_first) -> void {
    for (const Geometry& g : e.solids)
      if (std::holds_alternative<CsgGeometry>(g.shape)) return self(self, expanded(e), parent, is_first);
    const auto node = static_cast<std::uint32_t>(csg.nodes.size());
    csg.nodes.push_back({e.op, is_first, parent, static_cast<std::uint32_t>(e.children.size())});
    csg.has_surfaces |= e.op == CsgOp::surfaces;
    for (const Geometry& g : e.solids) {
      if (is_unbounded(g) && e.op != CsgOp::surfaces)
        csg.unbounded.push_back(static_cast<std::uint32_t>(solids.size()));
      solids.push_back(g);
      csg.operand_of.push_back(node);
    }
    for (const CsgExpression& child : e.children) self(self, child, node, &child == &e.children.front());
  };
  add(add, expression, kNoId, true);
  if (std::ranges::any_of(solids, [](const Geometry& g) { return g.mask == 0; }))
    for (Geometry& g : solids) csg.unseen.push_back(std::exchange(g.mask, ~0u) == 0);
  csg.solids = build_accel(std::move(solids), options);
  csg.has_meshes = prepare_senses(*csg.solids, seen);
  number_solids(csg);
  csg.in_lanes = !csg.has_surfaces && fits_lanes(csg);
  find_needed(csg);
  csg.listed = !csg.has_surfaces && std::ranges::all_of(csg.solids->kinds, [](std::uint8_t kind) {
    return is_shape(static_cast<Kind>(kind));
  });
  if (!csg.in_lanes) find_probes(csg);
  if (csg.nodes.size() <= kMaxCsgSteps)
    for (std::uint32_t node = 0; node < csg.nodes.size(); ++node) csg.steps.push_back(step_of(csg, node));
  for (Geometry window : expression.windows) {
    window.mask = ~0u;
    csg.windows.push_back(build_accel({std::move(window)}, options));
    prepare_senses(*csg.windows.back(), seen);
  }
  return csg;
}

Box csg_bounds(const CsgItem& csg) {
  const float inf = std::numeric_limits<float>::infinity();
  const Box all{{-inf, -inf, -inf}, {inf, inf, inf}};
  std::vector<Box> boxes(csg.nodes.size());
  for (std::uint32_t g = 0; g < csg.operand_of.size(); ++g) {
    const Geometry& geometry = csg.solids->geometries[g];
    boxes[csg.operand_of[g]].grow(is_unbounded(geometry) ? all : geometry_bounds(geometry));
  }
  // Children stand behind their parents.
  std::vector<bool> begun(csg.nodes.size());
  for (std::uint32_t node = static_cast<std::uint32_t>(csg.nodes.size()); node-- > 1;) {
    const CsgNode& n = csg.nodes[node];
    Box& parent = boxes[n.parent];
    const CsgOp op = csg.nodes[n.parent].op;
    if (op == CsgOp::unite) parent.grow(boxes[node]);
    if (op == CsgOp::subtract && n.is_first) parent = boxes[node];
    if (op == CsgOp::intersect)
      parent =
          begun[n.parent] ? Box{max(parent.lo, boxes[node].lo), min(parent.hi, boxes[node].hi)} : boxes[node];
    begun[n.parent] = true;
  }
  return boxes[0];
}

std::vector<CsgStep>& csg_steps(const CsgItem& csg, std::uint32_t* operands, int count) {
  static thread_local std::vector<CsgStep> steps;
  static thread_local std::vector<std::uint32_t> nodes, place, met;
  if (place.size() < csg.nodes.size()) place.resize(csg.nodes.size(), kNoId);
  nodes.clear();
  for (int i = 0; i < count; ++i)
    for (std::uint32_t node = operands[i]; node != kNoId && place[node] == kNoId;
         node = csg.nodes[node].parent)
      place[node] = 0, nodes.push_back(node);
  std::sort(nodes.begin(), nodes.end());
  for (std::uint32_t i = 0; i < nodes.size(); ++i) place[nodes[i]] = i;
  steps.clear();
  met.assign(nodes.size(), 0);
  for (const std::uint32_t node : nodes) {
    const CsgNode& n = csg.nodes[node];
    CsgStep step = step_of(csg, node);
    step.parent = n.parent == kNoId ? 0 : place[n.parent];
    // An intersection needs a step for each of its children, a difference for the first.
    if (n.parent != kNoId && (csg.nodes[n.parent].op == CsgOp::intersect || n.is_first)) ++met[step.parent];
    steps.push_back(step);
  }
  for (std::uint32_t i = 0; i < nodes.size(); ++i) {
    const CsgNode& n = csg.nodes[nodes[i]];
    const std::uint32_t needed = n.op == CsgOp::intersect ? n.children : n.op == CsgOp::subtract ? 1 : 0;
    if (met[i] < needed) steps[i].initial = 0;
  }
  for (int i = 0; i < count; ++i) operands[i] = place[operands[i]];
  for (const std::uint32_t node : nodes) place[node] = kNoId;
  return steps;
}

float coincidence_slack(const Accel& accel, const Ray& ray) {
  float size = 0, speed = 0;
  for (int k = 0; k < 3; ++k) {
    size = std::max(size, std::abs(ray.origin[k]));
    if (!accel.bounds.empty())
      size = std::max({size, std::abs(accel.bounds.lo[k]), std::abs(accel.bounds.hi[k])});
    speed = std::max(speed, std::abs(ray.direction[k]));
  }
  return std::isfinite(size) ? 0x1p-22f * (size / speed) : 0;
}

// ---- Questions of the sweep along a ray about the solids of a Boolean combination.

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
    if (op == CsgOp::operand || op == CsgOp::surfaces) return inside[node] != 0;
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

bool runs_through_windows(const CsgItem& csg, const Ray& ray) {
  const Ray endless{ray.origin, ray.tmin, ray.direction, std::numeric_limits<float>::infinity()};
  return std::ranges::all_of(csg.windows, [&](const std::shared_ptr<const Accel>& window) {
    return any_hit(*window, endless) ||
           (is_unbounded(window->geometries[0]) && runs_inside(*window, 0, endless));
  });
}

bool runs_inside(const Accel& accel, std::uint32_t geometry, const Ray& ray) {
  const Vec3d direction(ray.direction);
  return is_inside(accel, geometry, {Vec3d(ray.origin) + direction * double(ray.tmin), direction});
}

}  // namespace oktett
