#include "accel/csg/csg.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "accel/accel_data.h"
#include "accel/csg/csg_solids.h"
#include "accel/geometry_bounds.h"
#include "kernels/exact_ops.h"

namespace oktett {

namespace {

/// Six times the volume that a mesh encloses, negative if it is wound inside out.
double signed_volume(const TriangleMesh& mesh) {
  if (mesh.positions.empty()) return 0;
  const Vec3d origin(mesh.positions[0]);
  double volume = 0;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const auto corner = [&](std::size_t k) { return Vec3d(mesh.positions[mesh.indices[i + k]]) - origin; };
    volume += dot(corner(0), cross(corner(1), corner(2)));
  }
  return volume;
}

/// The structures that an instance or a list of instances shows.
std::vector<const Accel*> children_of(const Geometry& g) {
  std::vector<const Accel*> children;
  if (const auto* instance = std::get_if<InstanceGeometry>(&g.shape))
    children.push_back(instance->child.get());
  if (const auto* list = std::get_if<InstanceList>(&g.shape))
    for (const auto& child : list->children) children.push_back(child.get());
  return children;
}

bool is_inside_out(const Geometry& g) {
  const auto* mesh = std::get_if<MeshGeometry>(&g.shape);
  return mesh != nullptr && signed_volume(*mesh->mesh) < 0;
}

/// Appends the meshes wound inside out in `accel` and its instances. `seen`: structures that have been
/// visited, so that each is visited once however many instances show it.
void find_inverted(const Accel& accel, std::set<const Accel*>& seen,
                   std::vector<std::pair<const Accel*, std::uint32_t>>& found) {
  if (!seen.insert(&accel).second) return;
  for (std::uint32_t g = 0; g < accel.geometries.size(); ++g) {
    if (is_inside_out(accel.geometries[g])) found.emplace_back(&accel, g);
    for (const Accel* child : children_of(accel.geometries[g])) find_inverted(*child, seen, found);
  }
}

/// Whether the crossings of all solids can be listed in lanes: all are primitives whose crossings one call
/// lists.
bool fits_lanes(const CsgItem& csg) {
  const Accel& solids = *csg.solids;
  if (solids.first_item.back() > 0x7fffffff) return false;
  return std::all_of(solids.kinds.begin(), solids.kinds.end(), [&](std::uint8_t k) {
    const auto kind = static_cast<Kind>(k);
    bool solid = is_exact(kind) && exact_ops(kind).lists_at_once();
    visit_pool(kind, solids.pools, [&]<class S>(S, const auto&) { solid = kSolid<S>; });
    return solid;
  });
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
    csg.needed.push_back(nodes[node] && count[node] == 1);
    if (csg.needed.back() != 0) kinds.insert(solids.kinds[g]);
  }
  csg.leaf_order.resize(solids.leaves.size());
  std::iota(csg.leaf_order.begin(), csg.leaf_order.end(), 0u);
  std::stable_partition(csg.leaf_order.begin(), csg.leaf_order.end(), [&](std::uint32_t leaf) {
    return kinds.contains(static_cast<std::uint8_t>(solids.leaves[leaf].kind));
  });
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
  return e;
}

/// An operand with combinations among its solids, as the union of these and of its other solids.
static CsgExpression expanded(const CsgExpression& operand) {
  CsgExpression all;
  all.op = CsgOp::unite;
  for (const Geometry& g : operand.solids) {
    const auto* csg = std::get_if<CsgGeometry>(&g.shape);
    if (csg == nullptr)
      all.children.push_back({CsgOp::operand, {g}, {}});
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
    for (const Geometry& g : e.solids) {
      if (is_unbounded(g)) csg.unbounded.push_back(static_cast<std::uint32_t>(solids.size()));
      csg.inverted.push_back(is_inside_out(g));
      for (const Accel* child : children_of(g)) find_inverted(*child, seen, csg.inverted_inside);
      solids.push_back(g);
      csg.operand_of.push_back(node);
    }
    for (const CsgExpression& child : e.children) self(self, child, node, &child == &e.children.front());
  };
  add(add, expression, kNoId, true);
  csg.solids = build_accel(std::move(solids), options);
  std::sort(csg.inverted_inside.begin(), csg.inverted_inside.end());
  number_solids(csg);
  csg.in_lanes = fits_lanes(csg);
  find_needed(csg);
  if (csg.nodes.size() <= kMaxCsgSteps)
    for (std::uint32_t node = 0; node < csg.nodes.size(); ++node) csg.steps.push_back(step_of(csg, node));
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

}  // namespace oktett
