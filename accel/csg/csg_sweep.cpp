#include <algorithm>
#include <span>

#include "accel/accel_data.h"
#include "accel/csg/csg.h"
#include "accel/hit_place.h"
#include "accel/winding/mesh_sense.h"

namespace oktett {
namespace {

/// A crossing of the ray with one solid.
struct Event {
  float t;
  float turn;  ///< 0: it is with CsgOp::surfaces
  std::uint32_t solid, geometry;
  std::uint32_t crossing;
  bool shown =
      false;  ///< of a surface: it is seen as the states are before those that coincide with it count
  bool decisive = false;  ///< see mark_decisive
};

/// Which solids, operands and nodes the ray is inside of. end() resets only what was changed, so that a large
/// expression costs nothing where a ray meets little of it.
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

  /// The ray has entered `solid`, of the given geometry, `turns` times more.
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
  /// Whether a surface of this geometry, of CsgOp::surfaces, is seen here: the ray would be inside of the
  /// whole if it were inside of that.
  bool shows(std::uint32_t geometry) {
    if (whole()) return false;
    const std::uint32_t operand = csg_->operand_of[geometry];
    count(operand, 1), turn(operand, true);
    const bool shown = whole();
    count(operand, -1), turn(operand, false);
    return shown;
  }

 private:
  void count(std::uint32_t node, int change) {
    touched_nodes_.push_back(node);
    inside_[node] += change;
  }
  bool is_inside(std::uint32_t node) const {
    const CsgNode& n = nodes_[node];
    switch (n.op) {
      case CsgOp::operand:
      case CsgOp::surfaces:
      case CsgOp::unite:
        return inside_[node] > 0;
      case CsgOp::intersect:
        return inside_[node] == static_cast<int>(n.children);
      case CsgOp::subtract:
        // Bit 0: inside the first operand; each of the others counts 2.
        return inside_[node] == 1;
    }
    return false;
  }
  /// The ray has come to be inside or outside of `node`: follows the change up the expression.
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
  std::vector<int> inside_;  ///< per node: how many children are, weighted as the node's kind requires
  std::vector<int> depth_;   ///< per solid
  std::vector<std::uint32_t> touched_nodes_, touched_solids_;
};

/// What the crossings of one solid tell about where the ray begins.
struct Begin {
  int sum = 0, least = 0;  ///< sum of the turns so far, and the least sum
  bool met = false;
};

/// Memory for one ray's sweep, kept between rays.
struct Scratch {
  std::vector<Event> events;
  std::vector<Begin> begin;  ///< per solid; reset between rays
  States states;
};

/// One past the last of the events that coincide with event `first`.
std::size_t group_end(const std::vector<Event>& events, std::size_t first, float slack) {
  const float limit = events[first].t + coincidence(events[first].t, slack);
  std::size_t end = first + 1;
  while (end < events.size() && events[end].t <= limit) ++end;
  return end;
}

/// Sets the states at the beginning of the ray. It begins inside a primitive if the first crossing leaves it.
/// It begins inside a mesh, instance or combination as many times as the crossings up to some distance leave
/// it more often than they enter; coincident crossings have no order there. Unbounded solids without a
/// crossing are evaluated.
void start_states(const CsgItem& csg, const Ray& ray, float slack, Scratch& s) {
  const Accel& solids = *csg.solids;
  if (s.begin.size() < csg.first_solid.back()) s.begin.resize(csg.first_solid.back());
  const auto is_primitive = [&](const Event& e) {
    return is_shape(static_cast<Kind>(solids.kinds[e.geometry]));
  };
  for (std::size_t i = 0; i < s.events.size();) {
    const std::size_t first = i, end = group_end(s.events, first, slack);
    for (; i < end; ++i) {
      const Event& e = s.events[i];
      if (e.turn == 0) continue;
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

/// Whether a geometry has a surface.
bool is_seen(const CsgItem& csg, std::uint32_t geometry, bool with_unseen) {
  return with_unseen || csg.unseen.empty() || csg.unseen[geometry] == 0;
}

/// Marks those of the events from `first` to `end` that turn as told and decide whether the ray is inside of
/// the combination: alone they would, or all others would not. `states` are those behind all. Returns whether
/// there are any.
bool mark_decisive(States& states, std::vector<Event>& events, std::size_t first, std::size_t end,
                   float turn) {
  const auto add = [&](const Event& e, int times) {
    if (e.turn != 0) states.add(e.solid, e.geometry, e.turn < 0 ? times : -times);
  };
  const auto turns = [&](const Event& e, int times) {
    const bool before = states.whole();
    add(e, times);
    const bool changed = states.whole() != before;
    add(e, -times);
    return e.turn == turn && changed;
  };
  bool any = false;
  for (std::size_t k = first; k < end; ++k) any |= events[k].decisive = turns(events[k], -1);
  for (std::size_t k = first; k < end; ++k) add(events[k], -1);
  for (std::size_t k = first; k < end; ++k) any |= events[k].decisive |= turns(events[k], 1);
  for (std::size_t k = first; k < end; ++k) add(events[k], 1);
  return any;
}

/// Which of the events from `first` to `end` is the hit where the ray enters (-1) or leaves (1) the
/// combination: one with a solid that is entered or left likewise, if there is one, as its normal is right,
/// and of several one that decides; `end` if only what has no surface is.
std::size_t seen_event(const CsgItem& csg, States& states, std::vector<Event>& events, std::size_t first,
                       std::size_t end, float turn, bool with_unseen) {
  const auto likewise = std::count_if(events.begin() + static_cast<std::ptrdiff_t>(first),
                                      events.begin() + static_cast<std::ptrdiff_t>(end),
                                      [&](const Event& e) { return e.turn == turn; });
  const bool some_decide = likewise > 1 && mark_decisive(states, events, first, end, turn);
  for (std::size_t k = first; k < end; ++k)
    if (events[k].turn == turn && (!some_decide || events[k].decisive) &&
        is_seen(csg, events[k].geometry, with_unseen))
      return k;
  if (likewise > 0) return end;
  for (std::size_t k = first; k < end && events[k].t == events[first].t; ++k)
    if (events[k].turn != 0 && is_seen(csg, events[k].geometry, with_unseen)) return k;
  return end;
}

/// Calls f(crossing) for each crossing of the combination until it returns false.
template <class Function>
void sweep(const CsgItem& csg, const Ray& ray, const std::vector<Crossing>& crossings, bool with_unseen,
           Function&& f) {
  static thread_local Scratch scratch;
  Scratch& s = scratch;
  s.events.clear();
  const Accel& solids = *csg.solids;
  std::span<const float> turns;
  if (csg.has_meshes) turns = solid_turns(solids, crossings);
  for (std::uint32_t i = 0; i < crossings.size(); ++i) {
    const float turn = turns.empty() ? crossings[i].turn : turns[i];
    const Hit& hit = crossings[i].hit;
    const std::uint32_t item = hit.instance == kNoId ? hit.item : top_item(solids, hit.instance);
    const std::uint32_t geometry = solids.geometry_of(item);
    const bool is_surface = csg.has_surfaces && csg.nodes[csg.operand_of[geometry]].op == CsgOp::surfaces;
    if (is_surface ? !is_seen(csg, geometry, with_unseen) : turn == 0) continue;
    std::uint32_t solid = csg.first_solid[geometry];
    if (csg.first_solid[geometry + 1] > solid + 1) solid += item - solids.first_item[geometry];
    s.events.push_back({hit.t, is_surface ? 0 : turn, solid, geometry, i});
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
  // Event k is a hit at which the ray turns as told, or meets one of the surfaces.
  const auto report = [&](std::size_t k, float turn) {
    // found.turn follows the winding, as the normal does, also for meshes wound inside out.
    Crossing found = crossings[s.events[k].crossing];
    found.hit.instance = csg_path(csg, found.hit.instance, turn != 0 && found.turn != turn);
    found.turn = turn;
    return f(found);
  };
  bool inside = s.states.whole(), goes_on = true;
  for (std::size_t i = 0; goes_on && i < s.events.size();) {
    const std::size_t first = i, end = group_end(s.events, first, slack);
    for (std::size_t k = first; csg.has_surfaces && k < end; ++k)
      s.events[k].shown = s.events[k].turn == 0 && s.states.shows(s.events[k].geometry);
    for (; i < end; ++i)
      if (s.events[i].turn != 0)
        s.states.add(s.events[i].solid, s.events[i].geometry, s.events[i].turn < 0 ? 1 : -1);
    const bool now = s.states.whole();
    const float turn = now ? -1.0f : 1.0f;
    const std::size_t seen =
        now == inside ? end : seen_event(csg, s.states, s.events, first, end, turn, with_unseen);
    inside = now;
    if (!csg.has_surfaces) {
      goes_on = seen == end || report(seen, turn);
      continue;
    }
    for (std::size_t k = first; goes_on && k < end; ++k) {
      if (k == seen)
        goes_on = report(k, turn);
      else if (s.events[k].turn == 0 && (s.events[k].shown || s.states.shows(s.events[k].geometry)))
        goes_on = report(k, 0);
    }
  }
  s.states.end();
}

/// Lists of crossings, one per level of combinations inside combinations, kept between rays.
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

CsgSweep::CsgSweep() : list_(borrow_list()) { list_.keeps_unseen = true; }
CsgSweep::~CsgSweep() { --free_lists.used; }

bool CsgSweep::first(const CsgItem& csg, const Ray& ray, Crossing& found) {
  bool any = false;
  sweep(csg, ray, list_.crossings(), false, [&](const Crossing& c) {
    found = c, any = true;
    return false;
  });
  return any;
}

void CsgSweep::all(const CsgItem& csg, const Ray& ray, HitList& out) {
  sweep(csg, ray, list_.crossings(), out.keeps_unseen, [&](const Crossing& c) {
    if (c.hit.t <= ray.tmax) out.push(c.hit, c.turn);
    return c.hit.t <= ray.tmax;
  });
}

}  // namespace oktett
