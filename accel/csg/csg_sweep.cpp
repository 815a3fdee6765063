#include <algorithm>

#include "accel/accel_data.h"
#include "accel/csg/csg.h"
#include "accel/csg/csg_solids.h"
#include "accel/hit_place.h"

namespace oktett {
namespace {

struct Event {
  float t;
  float turn;
  std::uint32_t solid, geometry;
  std::uint32_t crossing;
};

/// Which solids, operands and nodes the ray is inside of. Only what was touched is put back afterwards.
class States {
 public:
  void begin(const CsgItem& csg) {
    csg_ = &csg;
    nodes_ = csg.nodes.data();
    if (inside_.size() < csg.nodes.size()) inside_.resize(csg.nodes.size(), 0);
    if (depth_.size() < csg.first_solid.back()) depth_.resize(csg.first_solid.back(), 0);
  }
  void end() {
    for (const std::uint32_t node : touched_nodes_) inside_[node] = 0;
    for (const std::uint32_t solid : touched_solids_) depth_[solid] = 0;
    touched_nodes_.clear(), touched_solids_.clear();
  }

  /// The ray is inside of `solid`, of the given geometry, so many times more.
  void add(std::uint32_t solid, std::uint32_t geometry, int turns) {
    touched_solids_.push_back(solid);
    const bool before = depth_[solid] > 0;
    depth_[solid] += turns;
    const bool after = depth_[solid] > 0;
    if (before == after) return;
    const std::uint32_t operand = csg_->operand_of[geometry];
    const bool was = inside_[operand] > 0;
    count(operand, after ? 1 : -1);
    if (was != (inside_[operand] > 0)) turn(operand, after);
  }
  bool whole() const { return is_inside(0); }

 private:
  void count(std::uint32_t node, int change) {
    touched_nodes_.push_back(node);
    inside_[node] += change;
  }
  bool is_inside(std::uint32_t node) const {
    const CsgNode& n = nodes_[node];
    switch (n.op) {
      case CsgOp::operand:
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
      const bool before = is_inside(parent);
      const int weight = nodes_[parent].op == CsgOp::subtract && !nodes_[node].is_first ? 2 : 1;
      count(parent, inside ? weight : -weight);
      const bool after = is_inside(parent);
      if (before == after) return;
      inside = after, node = parent;
    }
  }

  const CsgItem* csg_ = nullptr;
  const CsgNode* nodes_ = nullptr;
  std::vector<int> inside_;  ///< per node: how many children are, weighted as the node's kind asks for
  std::vector<int> depth_;   ///< per solid
  std::vector<std::uint32_t> touched_nodes_, touched_solids_;
};

/// What is known of one solid's crossings.
struct Begin {
  int sum = 0, least = 0;  ///< of the turns so far
  bool met = false;
};

/// Room for one ray's sweep, kept between rays.
struct Scratch {
  std::vector<Event> events;
  std::vector<Begin> begin;  ///< per solid; all as new between rays
  States states;
};

/// One past the last of the events that coincide with event `first`.
std::size_t group_end(const std::vector<Event>& events, std::size_t first, float slack) {
  const float limit = events[first].t + coincidence(events[first].t, slack);
  std::size_t end = first + 1;
  while (end < events.size() && events[end].t <= limit) ++end;
  return end;
}

/// Where the ray begins. It is inside of a primitive whose first crossing leaves it. Meshes and instances,
/// which it may be inside of several times, have been left more often than entered; there, crossings that
/// coincide have no order. What is not met at all and not bounded is asked.
void start_states(const CsgItem& csg, const Ray& ray, float slack, Scratch& s) {
  const Accel& solids = *csg.solids;
  if (s.begin.size() < csg.first_solid.back()) s.begin.resize(csg.first_solid.back());
  const auto is_primitive = [&](const Event& e) {
    return static_cast<Kind>(solids.kinds[e.geometry]) < Kind::triangle;
  };
  for (std::size_t i = 0; i < s.events.size();) {
    const std::size_t first = i, end = group_end(s.events, first, slack);
    for (; i < end; ++i) {
      const Event& e = s.events[i];
      Begin& b = s.begin[e.solid];
      if (is_primitive(e) && !b.met) b.least = e.turn < 0 ? 0 : -1;
      b.met = true;
      b.sum += e.turn < 0 ? 1 : -1;
    }
    for (std::size_t k = first; k < end; ++k) {
      Begin& b = s.begin[s.events[k].solid];
      if (!is_primitive(s.events[k])) b.least = std::min(b.least, b.sum);
    }
  }
  for (const std::uint32_t geometry : csg.unbounded)
    for (std::uint32_t solid = csg.first_solid[geometry]; solid < csg.first_solid[geometry + 1]; ++solid)
      if (!s.begin[solid].met && runs_inside(solids, geometry, ray)) s.states.add(solid, geometry, 1);
  for (const Event& e : s.events) {
    Begin& b = s.begin[e.solid];
    if (b.least < 0) s.states.add(e.solid, e.geometry, -b.least);
    b = {};
  }
}

/// Whether the hit, inside of an instance, is with a mesh that is wound inside out.
bool is_inverted_inside(const CsgItem& csg, const Hit& hit) {
  if (csg.inverted_inside.empty() || hit.instance == kNoId) return false;
  const Accel* accel = follow_path(*csg.solids, hit.instance).accel;
  return std::binary_search(csg.inverted_inside.begin(), csg.inverted_inside.end(),
                            std::pair(accel, accel->geometry_of(hit.item)));
}

/// Calls f(crossing) for each crossing of the combination until it returns false.
template <class Function>
void sweep(const CsgItem& csg, const Ray& ray, const std::vector<Crossing>& crossings, Function&& f) {
  static thread_local Scratch scratch;
  Scratch& s = scratch;
  s.events.clear();
  const Accel& solids = *csg.solids;
  for (std::uint32_t i = 0; i < crossings.size(); ++i) {
    if (crossings[i].turn == 0) continue;
    const Hit& hit = crossings[i].hit;
    const std::uint32_t item = hit.instance == kNoId ? hit.item : top_item(solids, hit.instance);
    const std::uint32_t geometry = solids.geometry_of(item);
    const bool inverted = csg.inverted[geometry] != 0 || is_inverted_inside(csg, hit);
    const float turn = inverted ? -crossings[i].turn : crossings[i].turn;
    std::uint32_t solid = csg.first_solid[geometry];
    if (csg.first_solid[geometry + 1] > solid + 1) solid += item - solids.first_item[geometry];
    s.events.push_back({hit.t, turn, solid, geometry, i});
  }
  if (s.events.empty()) return;
  std::sort(s.events.begin(), s.events.end(), [&](const Event& a, const Event& b) {
    if (a.t != b.t) return a.t < b.t;
    const Hit &x = crossings[a.crossing].hit, &y = crossings[b.crossing].hit;
    if (x.instance != y.instance) return x.instance + 1 < y.instance + 1;
    if (x.item != y.item) return x.item < y.item;
    return a.crossing < b.crossing;
  });
  s.states.begin(csg);
  const float slack = coincidence_slack(solids, ray);
  start_states(csg, ray, slack, s);
  bool inside = s.states.whole();
  for (std::size_t i = 0; i < s.events.size();) {
    const std::size_t first = i, end = group_end(s.events, first, slack);
    for (; i < end; ++i) s.states.add(s.events[i].solid, s.events[i].geometry, s.events[i].turn < 0 ? 1 : -1);
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
