/// \file The queries of accel/accel.h with rays.

#include "accel/query.h"

#include <algorithm>
#include <span>
#include <type_traits>

#include "accel/accel_data.h"
#include "accel/batch_pieces.h"
#include "accel/code.h"
#include "accel/hit_sink.h"
#include "kernels/exact_ops.h"

namespace oktett {

// ---- The nearest hit, and whether there is any.

void closest_hit(const Accel& accel, const RaySpan& rays, const HitSpan& hits, Isa isa, TraceMode mode) {
  const TraceCode& code = trace_code(isa);
  for_each_piece(rays, [&](std::size_t begin, const RaySpan& piece) {
    code.closest_hit(accel, piece, {hits.part(begin, piece.size)}, mode);
  });
}

void any_hit(const Accel& accel, const RaySpan& rays, std::uint8_t* occluded, Isa isa, TraceMode mode) {
  const TraceCode& code = trace_code(isa);
  for_each_piece(rays, [&](std::size_t begin, const RaySpan& piece) {
    code.any_hit(accel, piece, {occluded + begin}, mode);
  });
}

void closest_hit(const Accel& accel, const RaySpan& rays, const HitSpan& hits, Isa isa) {
  require_same_size(rays.size, hits.size, "closest_hit");
  if (rays.size == 1) return hits.set(0, closest_hit(accel, rays[0], isa));
  closest_hit(accel, rays, hits, isa, TraceMode::automatic);
}

void any_hit(const Accel& accel, const RaySpan& rays, std::span<std::uint8_t> occluded, Isa isa) {
  require_same_size(rays.size, occluded.size(), "any_hit");
  if (rays.size == 1) return void(occluded[0] = any_hit(accel, rays[0], isa));
  any_hit(accel, rays, occluded.data(), isa, TraceMode::automatic);
}

void closest_hit(const Accel& accel, std::span<const Ray> rays, std::span<Hit> hits, Isa isa) {
  require_same_size(rays.size(), hits.size(), "closest_hit");
  if (rays.size() == 1) return void(hits[0] = closest_hit(accel, rays[0], isa));
  const TraceCode& code = trace_code(isa);
  for_each_piece(rays, [&](std::size_t begin, const RaySpan& piece) {
    static thread_local HitBatch columns;
    columns.resize_uninitialized(piece.size);
    code.closest_hit(accel, piece, {columns.span()}, TraceMode::automatic);
    for (std::size_t i = 0; i < piece.size; ++i) hits[begin + i] = columns[i];
  });
}

void any_hit(const Accel& accel, std::span<const Ray> rays, std::span<std::uint8_t> occluded, Isa isa) {
  require_same_size(rays.size(), occluded.size(), "any_hit");
  if (rays.size() == 1) return void(occluded[0] = any_hit(accel, rays[0], isa));
  const TraceCode& code = trace_code(isa);
  for_each_piece(rays, [&](std::size_t begin, const RaySpan& piece) {
    code.any_hit(accel, piece, {occluded.data() + begin}, TraceMode::automatic);
  });
}

Hit closest_hit(const Accel& accel, const Ray& ray, Isa isa) {
  return trace_code(isa).closest_hit_one(accel, ray);
}

bool any_hit(const Accel& accel, const Ray& ray, Isa isa) { return trace_code(isa).any_hit_one(accel, ray); }

HitJudge::~HitJudge() = default;

// ---- All hits.

void HitList::push(const Hit& hit, float turn) { hits_.push_back({hit, turn}); }
std::size_t HitList::size() const { return hits_.size(); }
Crossing& HitList::operator[](std::size_t i) { return hits_[i]; }
void HitList::shrink(std::size_t size) { hits_.resize(size); }

void RayHitList::append(const RayHit* hits, int count) { hits_.insert(hits_.end(), hits, hits + count); }
void RayHitList::take_scratch(std::size_t ray) {
  for (const Crossing& c : scratch_hits_) hits_.push_back({c, static_cast<std::uint32_t>(ray)});
  scratch_hits_.clear();
}

bool is_triangle(const Accel& accel, std::uint32_t item) {
  return static_cast<Kind>(accel.kinds[accel.geometry_of(item)]) == Kind::triangle;
}

bool is_mirrored(const Accel& accel, std::uint32_t item) {
  return accel.frames[accel.geometry_of(item)].mirrored;
}

/// Orders the crossings of one surface, which are sorted by t and then by turn, so that they alternate where
/// several have the same t: a ray that is inside leaves first, one that is outside enters first. Through a
/// gap thinner than the spacing of floats a ray leaves and enters again at one t; through one between two
/// sides that coincide with a third, it leaves, enters and leaves.
static void order_equal_crossings(std::span<Crossing> crossings) {
  struct Group {
    std::size_t end, entering, leaving;
  };
  const auto group_at = [&](std::size_t begin) {
    Group group{begin, 0, 0};
    for (; group.end < crossings.size() && crossings[group.end].hit.t == crossings[begin].hit.t; ++group.end)
      ++(crossings[group.end].turn > 0 ? group.leaving : group.entering);
    return group;
  };
  // A group with as many crossings either way ends on the side where it began, so the first other group tells
  // where the ray begins.
  bool inside = false;
  for (std::size_t i = 0; i < crossings.size();) {
    const Group group = group_at(i);
    i = group.end;
    if (group.leaving == group.entering) continue;
    inside = group.leaving > group.entering;
    break;
  }
  static thread_local std::vector<Crossing> ordered;
  for (std::size_t begin = 0; begin < crossings.size();) {
    const Group group = group_at(begin);
    if (group.leaving != group.entering) inside = group.leaving > group.entering;
    std::size_t enters = begin, leaves = begin + group.entering;
    ordered.clear();
    for (bool now = inside; enters < begin + group.entering || leaves < group.end; now = !now) {
      if (now && leaves < group.end) ordered.push_back(crossings[leaves++]);
      if (!now && enters < begin + group.entering) ordered.push_back(crossings[enters++]);
    }
    std::ranges::copy(ordered, crossings.begin() + static_cast<std::ptrdiff_t>(begin));
    inside ^= group.leaving != group.entering;
    begin = group.end;
  }
}

void merge_crossings(const Accel& accel, HitList& list, std::size_t first) {
  // Surfaces of one cell list their crossings correctly by themselves.
  const auto own_exact = [&](const Hit& h) {
    if (h.instance != kNoId) return false;
    const auto kind = static_cast<Kind>(accel.kinds[accel.geometry_of(h.item)]);
    return is_exact(kind) && !exact_ops(kind).one_cell;
  };
  static thread_local std::vector<Crossing> crossings;
  crossings.clear();
  std::size_t kept = first;
  for (std::size_t i = first; i < list.size(); ++i) {
    if (own_exact(list[i].hit))
      crossings.push_back(list[i]);
    else
      list[kept++] = list[i];
  }
  list.shrink(kept);
  std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) {
    if (a.hit.item != b.hit.item) return a.hit.item < b.hit.item;
    if (a.hit.t != b.hit.t) return a.hit.t < b.hit.t;
    return a.turn != b.turn ? a.turn < b.turn : a.hit.u < b.hit.u;
  });
  for (std::size_t begin = 0, end; begin < crossings.size(); begin = end) {
    end = begin + 1;
    while (end < crossings.size() && crossings[end].hit.item == crossings[begin].hit.item) ++end;
    order_equal_crossings({&crossings[begin], end - begin});
  }
  const auto is_of_sheet = [&](const Crossing& c) {
    return exact_ops(static_cast<Kind>(accel.kinds[accel.geometry_of(c.hit.item)])).sheets;
  };
  // Of several crossings inwards in a row the first counts, of several outwards the last. Those of sheets are
  // one only where they are in one place, as at a border of two cells; the first counts.
  for (std::size_t i = 0; i < crossings.size(); ++i) {
    const auto same = [&](std::size_t k) {
      if (!(k < crossings.size() && crossings[k].hit.item == crossings[i].hit.item &&
            crossings[k].turn == crossings[i].turn))
        return false;
      const float t = crossings[i].hit.t, apart = std::abs(t - crossings[k].hit.t);
      return apart <= 0x1p-21f * t || !is_of_sheet(crossings[i]);
    };
    const bool first_counts = crossings[i].turn < 0 || is_of_sheet(crossings[i]);
    if (first_counts ? !(i > 0 && same(i - 1)) : !same(i + 1)) list.push(crossings[i].hit, crossings[i].turn);
  }
}

bool listed_before(const Hit& a, const Hit& b) {
  if (a.t != b.t) return a.t < b.t;
  // Adding one puts "no instance" first.
  if (a.instance != b.instance) return a.instance + 1 < b.instance + 1;
  return a.item < b.item;
}

/// Hits, or crossings.
inline const Hit& hit_of(const Hit& hit) { return hit; }
inline const Hit& hit_of(const Crossing& crossing) { return crossing.hit; }

template <class Element>
static void sort_hits(Element* begin, Element* end) {
  const auto before = [](const Element& a, const Element& b) { return listed_before(hit_of(a), hit_of(b)); };
  if (end - begin > 32) return std::stable_sort(begin, end, before);
  for (Element* at = begin; at < end; ++at) {
    const Element hit = *at;
    Element* to = at;
    for (; to > begin && before(hit, to[-1]); --to) *to = to[-1];
    *to = hit;
  }
}

void all_hits(const Accel& accel, const Ray& ray, std::vector<Hit>& hits, Isa isa) {
  static thread_local std::vector<Crossing> crossings;
  crossings.clear();
  hits.clear();
  HitList list(crossings);
  trace_code(isa).all_hits_one(accel, ray, list);
  for (const Crossing& c : crossings) hits.push_back(c.hit);
  sort_hits(hits.data(), hits.data() + hits.size());
}

/// The elements of lists of either kind.
inline std::vector<Hit>& elements_of(HitLists& lists) { return lists.hits; }
inline std::vector<Crossing>& elements_of(CrossingLists& lists) { return lists.crossings; }
inline void take_crossing(const Crossing& crossing, Hit& hit) { hit = crossing.hit; }
inline void take_crossing(const Crossing& crossing, Crossing& to) { to = crossing; }

/// Groups the crossings of a batch by ray. The hits of each ray are not sorted.
template <class Lists>
static void group_by_ray(const std::vector<RayHit>& found, std::size_t rays, Lists& out) {
  out.begin.assign(rays + 1, 0);
  for (const RayHit& h : found) ++out.begin[h.ray + 1];
  for (std::size_t i = 0; i < rays; ++i) out.begin[i + 1] += out.begin[i];
  auto& elements = elements_of(out);
  elements.resize(found.size());
  static thread_local std::vector<std::size_t> next;
  next.assign(out.begin.begin(), out.begin.end() - 1);
  for (const RayHit& h : found) take_crossing(h.crossing, elements[next[h.ray]++]);
}

/// The same, and merges the crossings of exact surfaces.
template <class Lists>
static void merge_by_ray(const Accel& accel, const std::vector<RayHit>& found, std::size_t rays, Lists& out) {
  std::vector<std::vector<Crossing>> of_ray(rays);
  for (const RayHit& h : found) of_ray[h.ray].push_back(h.crossing);
  auto& elements = elements_of(out);
  elements.clear();
  out.begin.assign(1, 0);
  for (std::vector<Crossing>& crossings : of_ray) {
    HitList list(crossings);
    merge_crossings(accel, list, 0);
    for (const Crossing& c : crossings) take_crossing(c, elements.emplace_back());
    out.begin.push_back(elements.size());
  }
}

/// Removes the repeated hits of triangles that stand in several leaves. The hits of each ray must be sorted.
template <class Lists>
static void drop_repeated(const Accel& accel, Lists& out) {
  auto& elements = elements_of(out);
  std::size_t kept = 0, at = 0;
  for (std::size_t i = 0; i + 1 < out.begin.size(); ++i) {
    const std::size_t end = out.begin[i + 1], first = kept;
    for (; at < end; ++at) {
      const Hit& h = hit_of(elements[at]);
      if (kept > first && h == hit_of(elements[kept - 1]) && h.instance == kNoId &&
          is_triangle(accel, h.item))
        continue;
      elements[kept++] = elements[at];
    }
    out.begin[i + 1] = kept;
  }
  elements.resize(kept);
}

/// The hits of a batch, not sorted. Those of triangles that stand in several leaves may be repeated.
template <class Lists>
static void find_hits(const Accel& accel, const RaySpan& rays, const TraceCode& code, Lists& out) {
  static thread_local RayHitList found;
  found.clear();
  found.scratch().keeps_unseen = std::is_same_v<Lists, CrossingLists>;
  code.all_hits(accel, rays, found);
  if (accel.has_exact)
    merge_by_ray(accel, found.hits(), rays.size, out);
  else
    group_by_ray(found.hits(), rays.size, out);
}

/// Sorts the hits of each ray and removes repeated ones.
template <class Lists>
static void sort_lists(const Accel& accel, Lists& lists) {
  auto& elements = elements_of(lists);
  for (std::size_t i = 0; i + 1 < lists.begin.size(); ++i)
    sort_hits(elements.data() + lists.begin[i], elements.data() + lists.begin[i + 1]);
  if (accel.pieces) drop_repeated(accel, lists);
}

void all_crossings(const Accel& accel, const RaySpan& rays, CrossingLists& lists, Isa isa) {
  find_hits(accel, rays, trace_code(isa), lists);
  sort_lists(accel, lists);
}

template <class Rays>
static void list_hits(const Accel& accel, const Rays& rays, HitLists& lists, Isa isa) {
  const TraceCode& code = trace_code(isa);
  const auto list_piece = [&](const RaySpan& piece, HitLists& out) {
    find_hits(accel, piece, code, out);
    sort_lists(accel, out);
  };
  const std::size_t size = ray_count(rays);
  if (size <= kPieceRays) return list_piece(piece_columns(rays, 0, size), lists);
  std::vector<HitLists> pieces(piece_count(size));
  for_each_piece(
      rays, [&](std::size_t begin, const RaySpan& piece) { list_piece(piece, pieces[begin / kPieceRays]); });
  lists.hits.clear();
  lists.begin.assign(1, 0);
  for (HitLists& piece : pieces) {
    const std::size_t before = lists.hits.size();
    lists.hits.insert(lists.hits.end(), piece.hits.begin(), piece.hits.end());
    for (std::size_t i = 1; i < piece.begin.size(); ++i) lists.begin.push_back(before + piece.begin[i]);
    piece = {};
  }
}

void all_hits(const Accel& accel, const RaySpan& rays, HitLists& lists, Isa isa) {
  list_hits(accel, rays, lists, isa);
}

void all_hits(const Accel& accel, std::span<const Ray> rays, HitLists& lists, Isa isa) {
  list_hits(accel, rays, lists, isa);
}

template <class Rays>
static void count_lists(const Accel& accel, const Rays& rays, std::span<std::uint32_t> counts, Isa isa) {
  require_same_size(ray_count(rays), counts.size(), "count_hits");
  const TraceCode& code = trace_code(isa);
  for_each_piece(rays, [&](std::size_t begin, const RaySpan& piece) {
    static thread_local HitLists lists;
    find_hits(accel, piece, code, lists);
    // Sorting is only needed to find repeated hits.
    if (accel.pieces) sort_lists(accel, lists);
    for (std::size_t i = 0; i < piece.size; ++i)
      counts[begin + i] = static_cast<std::uint32_t>(lists.of_ray(i).size());
  });
}

void count_hits(const Accel& accel, const RaySpan& rays, std::span<std::uint32_t> counts, Isa isa) {
  count_lists(accel, rays, counts, isa);
}

void count_hits(const Accel& accel, std::span<const Ray> rays, std::span<std::uint32_t> counts, Isa isa) {
  count_lists(accel, rays, counts, isa);
}

}  // namespace oktett
