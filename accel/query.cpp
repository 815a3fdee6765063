#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <string>

#include "accel/accel_data.h"
#include "accel/hit_list.h"
#include "accel/query.h"
#include "accel/trace_code.h"
#include "core/error.h"
#include "kernels/exact_ops.h"

namespace oktett {

void HitList::push(const Hit& hit, float turn) { hits_.push_back({hit, turn}); }
std::size_t HitList::size() const { return hits_.size(); }
Crossing& HitList::operator[](std::size_t i) { return hits_[i]; }
void HitList::shrink(std::size_t size) { hits_.resize(size); }
bool is_triangle(const Accel& accel, std::uint32_t item) {
  return static_cast<Kind>(accel.kinds[accel.geometry_of(item)]) == Kind::triangle;
}

void merge_crossings(const Accel& accel, HitList& list, std::size_t first) {
  // Surfaces of one cell list their crossings correctly by themselves.
  const auto own_exact = [&](const Hit& h) {
    if (h.instance != kNoId) return false;
    const auto kind = static_cast<Kind>(accel.kinds[accel.geometry_of(h.item)]);
    return is_exact(kind) && !exact_ops(kind).one_cell;
  };
  std::vector<Crossing> crossings;
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
    return a.hit.t != b.hit.t ? a.hit.t < b.hit.t : a.turn < b.turn;
  });
  // Of several crossings inwards in a row the first counts, of several outwards the last.
  for (std::size_t i = 0; i < crossings.size(); ++i) {
    const auto same = [&](std::size_t k) {
      return k < crossings.size() && crossings[k].hit.item == crossings[i].hit.item &&
             crossings[k].turn == crossings[i].turn;
    };
    if (crossings[i].turn < 0 ? !(i > 0 && same(i - 1)) : !same(i + 1))
      list.push(crossings[i].hit, crossings[i].turn);
  }
}

bool is_mirrored(const Accel& accel, std::uint32_t item) {
  return accel.frames[accel.geometry_of(item)].mirrored;
}

/// Larger batches are traced in pieces of this size, each a task.
static constexpr std::size_t kGrain = 4096;

template <class Trace>
static void for_each_piece(std::size_t size, Trace&& trace) {
  if (size <= kGrain) return trace(std::size_t{0}, size);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, (size + kGrain - 1) / kGrain), [&](const auto& r) {
    for (std::size_t k = r.begin(); k < r.end(); ++k) trace(k * kGrain, std::min(kGrain, size - k * kGrain));
  });
}

void closest_hit(const Accel& accel, const RaySpan& rays, const HitSpan& hits, Isa isa, TraceMode mode) {
  const TraceCode& code = trace_code(isa);
  for_each_piece(rays.size, [&](std::size_t begin, std::size_t count) {
    code.closest_hit(accel, rays.part(begin, count), {hits.part(begin, count)}, mode);
  });
}

void any_hit(const Accel& accel, const RaySpan& rays, std::uint8_t* occluded, Isa isa, TraceMode mode) {
  const TraceCode& code = trace_code(isa);
  for_each_piece(rays.size, [&](std::size_t begin, std::size_t count) {
    code.any_hit(accel, rays.part(begin, count), {occluded + begin}, mode);
  });
}

static void require_same_size(std::size_t rays, std::size_t answers, const char* query) {
  if (rays != answers)
    throw Error(std::string(query) + ": " + std::to_string(rays) + " rays, but room for " +
                std::to_string(answers) + " answers");
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

/// The rays as columns.
static RaySpan to_columns(std::span<const Ray> rays, RayBatch& columns) {
  columns.resize_uninitialized(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) columns.set(i, rays[i]);
  return columns.span();
}

void closest_hit(const Accel& accel, std::span<const Ray> rays, std::span<Hit> hits, Isa isa) {
  require_same_size(rays.size(), hits.size(), "closest_hit");
  if (rays.size() == 1) return void(hits[0] = closest_hit(accel, rays[0], isa));
  const TraceCode& code = trace_code(isa);
  for_each_piece(rays.size(), [&](std::size_t begin, std::size_t count) {
    static thread_local RayBatch ray_columns;
    static thread_local HitBatch hit_columns;
    hit_columns.resize_uninitialized(count);
    code.closest_hit(accel, to_columns(rays.subspan(begin, count), ray_columns), {hit_columns.span()},
                     TraceMode::automatic);
    for (std::size_t i = 0; i < count; ++i) hits[begin + i] = hit_columns[i];
  });
}

void any_hit(const Accel& accel, std::span<const Ray> rays, std::span<std::uint8_t> occluded, Isa isa) {
  require_same_size(rays.size(), occluded.size(), "any_hit");
  if (rays.size() == 1) return void(occluded[0] = any_hit(accel, rays[0], isa));
  const TraceCode& code = trace_code(isa);
  for_each_piece(rays.size(), [&](std::size_t begin, std::size_t count) {
    static thread_local RayBatch columns;
    code.any_hit(accel, to_columns(rays.subspan(begin, count), columns), {occluded.data() + begin},
                 TraceMode::automatic);
  });
}

Hit closest_hit(const Accel& accel, const Ray& ray, Isa isa) {
  return trace_code(isa).closest_hit_one(accel, ray);
}

bool any_hit(const Accel& accel, const Ray& ray, Isa isa) { return trace_code(isa).any_hit_one(accel, ray); }

void all_hits(const Accel& accel, const Ray& ray, std::vector<Hit>& hits, Isa isa) {
  hits.clear();
  std::vector<Crossing> crossings;
  HitList list(crossings);
  trace_code(isa).all_hits(accel, ray, list);
  for (const Crossing& c : crossings) hits.push_back(c.hit);
  std::stable_sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) {
    if (a.t != b.t) return a.t < b.t;
    // Adding one puts "no instance" first.
    if (a.instance != b.instance) return a.instance + 1 < b.instance + 1;
    return a.item < b.item;
  });
}

}  // namespace oktett
