#include "accel/csg.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "accel/accel_data.h"
#include "accel/csg_solids.h"
#include "accel/geometry_bounds.h"

namespace oktett {

namespace {

/// The state of all nodes on the way along one ray. Only what was touched is put back afterwards.
class States {
 public:
  void begin(const CsgItem& csg) {
    nodes_ = csg.nodes.data();
    if (inside_.size() < csg.nodes.size())
      inside_.resize(csg.nodes.size(), 0), depth_.resize(csg.nodes.size(), 0);
  }
  void end() {
    for (const std::uint32_t node : touched_) inside_[node] = 0, depth_[node] = 0;
    touched_.clear();
  }

  /// How often the ray is inside of what the operand consists of.
  void add(std::uint32_t operand, int turns) {
    touch(operand);
    const bool before = depth_[operand] > 0;
    depth_[operand] += turns;
    const bool after = depth_[operand] > 0;
    if (before != after) turn(operand, after);
  }
  bool whole() const { return is_inside(0); }

 private:
  bool is_inside(std::uint32_t node) const {
    const CsgNode& n = nodes_[node];
    switch (n.op) {
      case CsgOp::operand:
        return depth_[node] > 0;
      case CsgOp::unite:
        return inside_[node] > 0;
      case CsgOp::intersect:
        return inside_[node] == static_cast<int>(n.children);
      case CsgOp::subtract:
        // Bit 0: inside of the first; the others count in twos.
        return inside_[node] == 1;
    }
    return false;
  }
  /// Operand or node `node` has become inside or outside.
  void turn(std::uint32_t node, bool inside) {
    for (std::uint32_t parent = nodes_[node].parent; parent != kNoId; parent = nodes_[node].parent) {
      touch(parent);
      const bool before = is_inside(parent);
      const int weight = nodes_[parent].op == CsgOp::subtract && !nodes_[node].is_first ? 2 : 1;
      inside_[parent] += inside ? weight : -weight;
      const bool after = is_inside(parent);
      if (before == after) return;
      inside = after, node = parent;
    }
  }
  void touch(std::uint32_t node) { touched_.push_back(node); }

  const CsgNode* nodes_ = nullptr;
  std::vector<int> inside_;  ///< per node: how many children are, weighted as the node's kind asks for
  std::vector<int> depth_;   ///< per operand
  std::vector<std::uint32_t> touched_;
};

/// The geometry of `solids` that a hit belongs to, instances followed up to the top.
std::uint32_t top_geometry(const Accel& solids, const Hit& hit) {
  return solids.geometry_of(hit.instance == kNoId ? hit.item : top_item(solids, hit.instance));
}

struct Event {
  float t;
  float turn;
  std::uint32_t operand;
  std::uint32_t crossing;
};

/// Room for one ray's sweep, kept between rays.
struct Scratch {
  std::vector<Event> events;
  std::vector<int> least, sum;  // per node: of the turns so far
  std::vector<std::uint32_t> seen;
  States states;
};

/// One past the last of the events that coincide with event `first`.
std::size_t group_end(const std::vector<Event>& events, std::size_t first, float slack) {
  const float limit = events[first].t + coincidence(events[first].t, slack);
  std::size_t end = first + 1;
  while (end < events.size() && events[end].t <= limit) ++end;
  return end;
}

/// Operands start as far inside as their crossings tell: they end outside, or never were anywhere else.
/// Crossings that coincide have no order.
void start_states(const CsgItem& csg, const Ray& ray, const std::vector<Crossing>& crossings, float slack,
                  Scratch& s) {
  if (s.sum.size() < csg.nodes.size()) s.sum.resize(csg.nodes.size(), 0), s.least.resize(csg.nodes.size(), 0);
  for (std::size_t i = 0; i < s.events.size();) {
    const std::size_t first = i, end = group_end(s.events, first, slack);
    for (; i < end; ++i) {
      const Event& e = s.events[i];
      s.seen.push_back(e.operand);
      s.sum[e.operand] += e.turn < 0 ? 1 : -1;
    }
    for (std::size_t k = first; k < end; ++k) {
      const std::uint32_t operand = s.events[k].operand;
      s.least[operand] = std::min(s.least[operand], s.sum[operand]);
    }
  }
  for (const std::uint32_t operand : s.seen) {
    if (s.least[operand] < 0) s.states.add(operand, -s.least[operand]);
    s.sum[operand] = s.least[operand] = 0;
  }
  s.seen.clear();
  for (const std::uint32_t geometry : csg.unbounded) {
    const std::uint32_t operand = csg.operand_of[geometry];
    const bool crossed = std::any_of(s.events.begin(), s.events.end(), [&](const Event& e) {
      return top_geometry(*csg.solids, crossings[e.crossing].hit) == geometry;
    });
    if (!crossed && runs_inside(*csg.solids, geometry, ray)) s.states.add(operand, 1);
  }
}

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

}  // namespace

CsgExpression moved(CsgExpression e, const Affine& m) {
  for (Geometry& g : e.solids) g.transform = m * g.transform;
  for (CsgExpression& child : e.children) child = moved(std::move(child), m);
  return e;
}

/// An operand that holds combinations is the union of these and of what else it holds.
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
  const auto add = [&](const auto& self, const CsgExpression& e, std::uint32_t parent,
                       bool is_first) -> void {
    for (const Geometry& g : e.solids)
      if (std::holds_alternative<CsgGeometry>(g.shape)) return self(self, expanded(e), parent, is_first);
    const auto node = static_cast<std::uint32_t>(csg.nodes.size());
    csg.nodes.push_back({e.op, is_first, parent, static_cast<std::uint32_t>(e.children.size())});
    for (const Geometry& g : e.solids) {
      if (is_unbounded(g)) csg.unbounded.push_back(static_cast<std::uint32_t>(solids.size()));
      const auto* mesh = std::get_if<MeshGeometry>(&g.shape);
      csg.inverted.push_back(mesh != nullptr && signed_volume(*mesh->mesh) < 0);
      solids.push_back(g);
      csg.operand_of.push_back(node);
    }
    for (const CsgExpression& child : e.children) self(self, child, node, &child == &e.children.front());
  };
  add(add, expression, kNoId, true);
  csg.solids = build_accel(std::move(solids), options);
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

namespace {

/// Calls f(crossing) for each crossing of the combination until it returns false.
template <class Function>
void sweep(const CsgItem& csg, const Ray& ray, const std::vector<Crossing>& crossings, Function&& f) {
  static thread_local Scratch scratch;
  Scratch& s = scratch;
  s.events.clear();
  for (std::uint32_t i = 0; i < crossings.size(); ++i) {
    if (crossings[i].turn == 0) continue;
    const std::uint32_t geometry = top_geometry(*csg.solids, crossings[i].hit);
    const float turn = csg.inverted[geometry] != 0 ? -crossings[i].turn : crossings[i].turn;
    s.events.push_back({crossings[i].hit.t, turn, csg.operand_of[geometry], i});
  }
  std::sort(s.events.begin(), s.events.end(), [&](const Event& a, const Event& b) {
    if (a.t != b.t) return a.t < b.t;
    const Hit &x = crossings[a.crossing].hit, &y = crossings[b.crossing].hit;
    if (x.instance != y.instance) return x.instance + 1 < y.instance + 1;
    if (x.item != y.item) return x.item < y.item;
    return a.turn < b.turn;
  });
  s.states.begin(csg);
  const float slack = coincidence_slack(*csg.solids, ray);
  start_states(csg, ray, crossings, slack, s);
  bool inside = s.states.whole();
  for (std::size_t i = 0; i < s.events.size();) {
    const std::size_t first = i, end = group_end(s.events, first, slack);
    for (; i < end; ++i) s.states.add(s.events[i].operand, s.events[i].turn < 0 ? 1 : -1);
    const bool now = s.states.whole();
    if (now == inside) continue;
    inside = now;
    // The surface that is seen: one that turns as the whole does, if there is one; its normal then is right.
    const float turn = now ? -1.0f : 1.0f;
    std::size_t seen = first;
    for (std::size_t k = i; k-- > first;)
      if (s.events[k].turn == turn) seen = k;
    // The normal goes by the winding, whether that is inside out or not.
    Crossing found = crossings[s.events[seen].crossing];
    found.hit.instance = csg_path(csg, found.hit.instance, found.turn != turn);
    found.turn = turn;
    if (!f(found)) break;
  }
  s.states.end();
}

/// Lists of crossings for combinations within combinations, kept between rays.
struct Lists {
  std::vector<std::unique_ptr<std::vector<Crossing>>> lists;
  std::size_t used = 0;
};
thread_local Lists free_lists;

std::vector<Crossing>& borrow_list() {
  if (free_lists.used == free_lists.lists.size())
    free_lists.lists.push_back(std::make_unique<std::vector<Crossing>>());
  std::vector<Crossing>& list = *free_lists.lists[free_lists.used++];
  list.clear();
  return list;
}

}  // namespace

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

CsgSweep::CsgSweep() : list_(borrow_list()) {}
CsgSweep::~CsgSweep() { --free_lists.used; }

bool CsgSweep::first(const CsgItem& csg, const Ray& ray, Crossing& found) {
  bool any = false;
  sweep(csg, ray, list_.crossings(), [&](const Crossing& c) {
    found = c, any = true;
    return false;
  });
  return any;
}

void CsgSweep::all(const CsgItem& csg, const Ray& ray, HitList& out) {
  sweep(csg, ray, list_.crossings(), [&](const Crossing& c) {
    if (c.hit.t <= ray.tmax) out.push(c.hit, c.turn);
    return c.hit.t <= ray.tmax;
  });
}

}  // namespace oktett
