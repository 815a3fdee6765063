#include "io/mesh/polygon_sweep.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "core/mesh.h"

namespace oktett {

bool PolygonSweep::run(const std::vector<PlanePoint>& points) {
  const std::size_t count = points.size();
  crosses_ = false;
  triangles_.clear(), triangles_.reserve(3 * count);
  links_.clear(), links_.reserve(count + count / 2);
  unused_.clear();
  stretches_.reserve(count / 2 + 1), stretches_.assign(1, {});
  insides_.reserve(count / 2 + 1), insides_.assign(1, {});
  sort_corners(points);
  cut_what_encloses_nothing();
  set_kinds();
  for (std::size_t begin = 0, end; begin < by_place_.size() && !crosses_; begin = end) {
    for (end = begin; end < by_place_.size() && by_place_[end].key == by_place_[begin].key; ++end)
      if (end + kAhead < by_place_.size()) __builtin_prefetch(&corners_[by_place_[end + kAhead].corner]);
    add_place({&by_place_[begin], end - begin});
  }
  return !crosses_ && triangles_.size() == 3 * (count - 2);
}

// ---- Corners in the order of the sweep.

/// Numbers of floats in their order; both zeros are one.
static std::uint32_t ordered_bits(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x + 0.0f);
  return (bits & 0x80000000u) != 0 ? ~bits : bits | 0x80000000u;
}

void PolygonSweep::sort_corners(const std::vector<PlanePoint>& points) {
  const auto count = static_cast<std::uint32_t>(points.size());
  corners_.resize(count), by_place_.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    Corner& c = corners_[i];
    c.x = static_cast<float>(points[i].x), c.y = static_cast<float>(points[i].y);
    c.next = i + 1 < count ? i + 1 : 0, c.previous = i > 0 ? i - 1 : count - 1;
    c.kind = Kind::begins;
    by_place_[i] = {std::uint64_t{ordered_bits(c.x)} << 32 | ordered_bits(c.y), i};
  }
  std::sort(by_place_.begin(), by_place_.end(), [](const Place& a, const Place& b) {
    return a.key != b.key ? a.key < b.key : a.corner < b.corner;
  });
  std::uint32_t rank = 0;
  for (std::size_t i = 0; i < count; ++i) {
    rank += i > 0 && by_place_[i].key != by_place_[i - 1].key;
    corners_[by_place_[i].corner].rank = rank;
  }
}

/// An edge without length, or one that is walked back over the one before.
bool PolygonSweep::encloses_nothing(std::uint32_t corner) const {
  const Corner& c = corners_[corner];
  const std::uint32_t before = corners_[c.previous].rank, after = corners_[c.next].rank;
  if (c.rank == after || before == after) return true;
  return (before < c.rank) == (after < c.rank) && turn(c.previous, corner, c.next) == 0;
}

void PolygonSweep::cut_what_encloses_nothing() {
  std::size_t left = corners_.size();
  for (std::uint32_t i = 0; i < corners_.size(); ++i) {
    waiting_.assign(1, i);
    while (!waiting_.empty() && left > 3) {
      const std::uint32_t corner = waiting_.back();
      waiting_.pop_back();
      Corner& c = corners_[corner];
      if (c.kind == Kind::gone || !encloses_nothing(corner)) continue;
      cut(c.previous, corner, c.next);
      c.kind = Kind::gone, --left;
      corners_[c.previous].next = c.next, corners_[c.next].previous = c.previous;
      waiting_.push_back(c.next), waiting_.push_back(c.previous);
    }
  }
  if (left < corners_.size())
    std::erase_if(by_place_,
                  [this](const Place& place) { return corners_[place.corner].kind == Kind::gone; });
  if (left > 3) return;
  const std::uint32_t first = by_place_[0].corner, second = corners_[first].next;
  crosses_ = turn(first, second, corners_[second].next) < 0;
  cut(first, second, corners_[second].next);
  by_place_.clear();
}

void PolygonSweep::set_kinds() {
  for (std::uint32_t i = 0; i < corners_.size(); ++i) {
    Corner& c = corners_[i];
    if (c.kind == Kind::gone) continue;
    const bool from_left = corners_[c.previous].rank < c.rank, to_left = corners_[c.next].rank < c.rank;
    if (from_left != to_left) {
      c.kind = from_left ? Kind::goes_on_below : Kind::goes_on_above;
    } else {
      const bool is_left_turn = turn(c.previous, i, c.next) > 0;
      c.kind = from_left ? (is_left_turn ? Kind::ends : Kind::joins)
                         : (is_left_turn ? Kind::begins : Kind::splits);
    }
  }
}

// ---- What happens at a place: first stretches end, then edges go on, then stretches begin.

void PolygonSweep::add_place(std::span<const Place> place) {
  const auto closes = [](Kind kind) { return kind == Kind::ends || kind == Kind::joins; };
  for (const auto& [key, corner] : place)
    if (closes(corners_[corner].kind)) close(corner);
  openings_.clear();
  for (const auto& [key, corner] : place) {
    const Corner& c = corners_[corner];
    crosses_ |= closes(c.kind);
    if (c.kind == Kind::goes_on_below || c.kind == Kind::goes_on_above)
      go_on(corner);
    else if (c.kind == Kind::begins)
      openings_.push_back({corner, c.next, c.previous, true});
    else if (c.kind == Kind::splits)
      openings_.push_back({corner, c.previous, c.next, false});
  }
  if (!crosses_) open_all();
}

/// Ends a stretch or joins two, then others at the same place around them. Does nothing if others lie between
/// the two edges; these come first.
void PolygonSweep::close(std::uint32_t corner) {
  while (true) {
    Corner& c = corners_[corner];
    std::uint32_t low, high;
    if (c.kind == Kind::ends) {
      if (c.low_of != c.high_of) return;
      for (std::uint32_t at = insides_[c.low_of].first, then; (then = links_[at].after) != kNoId; at = then)
        cut(corner, links_[then].corner, links_[at].corner);
      const auto [below, above] = remove(c.low_of);
      c.kind = Kind::gone;
      if (below == 0 || above == 0) return;
      check_below(above);
      high = insides_[below].high, low = corners_[insides_[above].low].next;
    } else if (c.kind == Kind::joins) {
      if (stretches_[c.high_of].above != c.low_of) return;
      join(c.high_of, c.low_of, corner);
      c.kind = Kind::gone;
      check_within(c.high_of);
      high = insides_[c.high_of].high, low = corners_[insides_[c.high_of].low].next;
    } else {
      return;
    }
    if (high != low || corners_[high].rank != c.rank) return;
    corner = high;
  }
}

void PolygonSweep::go_on(std::uint32_t corner) {
  const Corner& c = corners_[corner];
  if (c.kind == Kind::goes_on_below) {
    add_first(insides_[c.low_of], corner);
    set_low(c.low_of, corner);
    check_within(c.low_of), check_below(c.low_of);
  } else {
    add_last(insides_[c.high_of], corner);
    set_high(c.high_of, c.previous);
    check_within(c.high_of), check_below(stretches_[c.high_of].above);
  }
}

/// From below; of those within each other, from the outer to the inner. Where several open the same angle,
/// inside and outside take turns.
void PolygonSweep::open_all() {
  const auto is_first = [this](const Opening& a, const Opening& b) {
    const int low = turn(a.corner, a.low, b.low);
    return low != 0 ? low > 0 : turn(a.corner, a.high, b.high) < 0;
  };
  std::sort(openings_.begin(), openings_.end(), is_first);
  for (std::size_t i = 0; i < openings_.size() && !crosses_; ++i) {
    const auto [stretch, within] = find(openings_[i]);
    for (std::size_t k = i + 1; k < std::min(openings_.size(), i + kMostTried); ++k) {
      if (openings_[i].begins != within || is_first(openings_[i], openings_[k])) break;
      std::swap(openings_[i], openings_[k]);
    }
    if (openings_[i].begins == within)
      crosses_ = true;
    else if (within)
      split(stretch, openings_[i].corner);
    else
      begin(stretch, openings_[i].corner);
  }
}

void PolygonSweep::begin(std::uint32_t below, std::uint32_t corner) {
  const std::uint32_t s = insert_above(below), link = new_link(corner, kNoId, kNoId);
  insides_[s].first = insides_[s].last = insides_[s].newest = link;
  set_low(s, corner), set_high(s, corners_[corner].previous);
  check_below(s), check_below(stretches_[s].above);
}

/// The corner sees the one that was added last.
void PolygonSweep::split(std::uint32_t b, std::uint32_t corner) {
  const std::uint32_t a = insert_above(b);
  Inside &below = insides_[b], &above = insides_[a];
  const std::uint32_t newest = below.newest, after = links_[newest].after;
  above.first = new_link(links_[newest].corner, kNoId, after);
  above.last = after == kNoId ? above.first : below.last;
  if (after != kNoId) links_[after].before = above.first;
  links_[newest].after = kNoId;
  below.last = newest;
  add_last(below, corner), add_first(above, corner);
  set_low(a, corner), set_high(a, below.high), set_high(b, corners_[corner].previous);
  check_within(b), check_within(a);
}

void PolygonSweep::join(std::uint32_t b, std::uint32_t a, std::uint32_t corner) {
  Inside &below = insides_[b], &above = insides_[a];
  add_last(below, corner), add_first(above, corner);
  const std::uint32_t link = below.last, after = links_[above.first].after;
  links_[link].after = after, links_[after].before = link;
  below.last = above.last;
  set_high(b, above.high);
  remove(a);
}

// ---- Chains.

std::uint32_t PolygonSweep::new_link(std::uint32_t corner, std::uint32_t before, std::uint32_t after) {
  links_.push_back({corner, before, after});
  return static_cast<std::uint32_t>(links_.size() - 1);
}

/// The right end of the edge below the inside. Cuts off what it sees of the chain; not what goes straight on,
/// but what runs back along the edge.
void PolygonSweep::add_first(Inside& inside, std::uint32_t corner) {
  std::uint32_t at = inside.first;
  for (std::uint32_t then; (then = links_[at].after) != kNoId; at = then) {
    const std::uint32_t a = links_[at].corner, b = links_[then].corner;
    const int turned = turn(corner, a, b);
    if (turned > 0 || (turned == 0 && corners_[b].rank < corners_[a].rank)) break;
    cut(corner, b, a);
  }
  inside.first = inside.newest = new_link(corner, kNoId, at);
  links_[at].before = inside.first;
}

/// That of the edge above.
void PolygonSweep::add_last(Inside& inside, std::uint32_t corner) {
  std::uint32_t at = inside.last;
  for (std::uint32_t then; (then = links_[at].before) != kNoId; at = then) {
    const std::uint32_t a = links_[at].corner, b = links_[then].corner;
    const int turned = turn(b, a, corner);
    if (turned > 0 || (turned == 0 && corners_[b].rank < corners_[a].rank)) break;
    cut(b, corner, a);
  }
  inside.last = inside.newest = new_link(corner, at, kNoId);
  links_[at].after = inside.last;
}

// ---- The order of edges along the line.

void PolygonSweep::set_low(std::uint32_t s, std::uint32_t e) {
  const std::uint32_t right = corners_[e].next;
  insides_[s].low = e, stretches_[s].low = edge(e, right), corners_[right].low_of = s;
}

void PolygonSweep::set_high(std::uint32_t s, std::uint32_t e) {
  insides_[s].high = e, stretches_[s].high = edge(corners_[e].next, e), corners_[e].high_of = s;
}

/// Up to where the first of the two ends.
void PolygonSweep::check_order(const Edge& lower, const Edge& upper) {
  const bool lower_ends =
      lower.right_x != upper.right_x ? lower.right_x < upper.right_x : lower.right_y <= upper.right_y;
  crosses_ |= lower_ends ? orientation(upper.left(), upper.right(), lower.right()) > 0
                         : orientation(lower.left(), lower.right(), upper.right()) < 0;
}

void PolygonSweep::check_within(std::uint32_t s) { check_order(stretches_[s].low, stretches_[s].high); }

void PolygonSweep::check_below(std::uint32_t s) {
  const std::uint32_t below = stretches_[s].below;
  if (s != 0 && below != 0) check_order(stretches_[below].high, stretches_[s].low);
}

/// Whether what opens lies above an edge (1) or below (-1). If it is on the edge, its own edges tell.
int PolygonSweep::side(const Edge& e, const Opening& opening) {
  const auto of = [&](std::uint32_t c) { return orientation(e.left(), e.right(), point(c)); };
  if (const int at = of(opening.corner); at != 0) return at;
  const int low = of(opening.low), high = of(opening.high);
  crosses_ |= low < 0 && high > 0;
  return low + high;
}

/// The stretch that what opens lies within, or the one below it.
PolygonSweep::Found PolygonSweep::find(const Opening& opening) {
  std::uint32_t s = stretches_[0].right, below = 0;
  while (s != 0) {
    const Stretch& stretch = stretches_[s];
    __builtin_prefetch(&stretches_[stretch.left]), __builtin_prefetch(&stretches_[stretch.right]);
    if (side(stretch.low, opening) < 0) {
      s = stretch.left;
    } else if (side(stretch.high, opening) > 0) {
      below = s;
      s = stretch.right;
    } else {
      return {s, true};
    }
  }
  return {below, false};
}

// ---- The treap of stretches.

/// As if by chance.
static std::uint32_t treap_priority(std::uint32_t x) {
  x = (x ^ x >> 16) * 0x7feb352du;
  x = (x ^ x >> 15) * 0x846ca68bu;
  return x ^ x >> 16;
}

/// A new stretch, next to another along the line; 0: as the lowest.
std::uint32_t PolygonSweep::insert_above(std::uint32_t below) {
  if (unused_.empty()) {
    unused_.push_back(static_cast<std::uint32_t>(stretches_.size()));
    stretches_.push_back({}), insides_.push_back({});
  }
  const std::uint32_t s = unused_.back(), above = stretches_[below].above;
  unused_.pop_back();
  stretches_[s] = {};
  stretches_[s].below = below, stretches_[s].above = above;
  stretches_[below].above = stretches_[above].below = s;
  if (stretches_[below].right == 0) {
    stretches_[below].right = s;
    stretches_[s].parent = below;
  } else {
    stretches_[above].left = s;
    stretches_[s].parent = above;
  }
  while (stretches_[s].parent != 0 && treap_priority(s) > treap_priority(stretches_[s].parent)) lift(s);
  return s;
}

/// Takes a stretch out; its neighbours.
std::pair<std::uint32_t, std::uint32_t> PolygonSweep::remove(std::uint32_t s) {
  const Stretch& stretch = stretches_[s];
  while (stretch.left != 0 || stretch.right != 0) {
    const bool to_left = stretch.right == 0 ||
                         (stretch.left != 0 && treap_priority(stretch.left) > treap_priority(stretch.right));
    lift(to_left ? stretch.left : stretch.right);
  }
  replace_child(stretch.parent, s, 0);
  stretches_[stretch.below].above = stretch.above;
  stretches_[stretch.above].below = stretch.below;
  unused_.push_back(s);
  return {stretch.below, stretch.above};
}

/// Puts a stretch in the place of its parent.
void PolygonSweep::lift(std::uint32_t s) {
  const std::uint32_t p = stretches_[s].parent;
  Stretch &stretch = stretches_[s], &parent = stretches_[p];
  const std::uint32_t grandparent = parent.parent;
  std::uint32_t& outer = parent.left == s ? parent.left : parent.right;
  std::uint32_t& inner = parent.left == s ? stretch.right : stretch.left;
  outer = inner;
  stretches_[inner].parent = p;
  inner = p;
  parent.parent = s;
  stretch.parent = grandparent;
  replace_child(grandparent, p, s);
}

void PolygonSweep::replace_child(std::uint32_t parent, std::uint32_t from, std::uint32_t to) {
  Stretch& s = stretches_[parent];
  (s.left == from && parent != 0 ? s.left : s.right) = to;
}

}  // namespace oktett
