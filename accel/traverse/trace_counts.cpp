#include "accel/traverse/trace_counts.h"

#include <vector>

#include "accel/traverse/all_hits.h"
#include "core/parallel.h"

namespace oktett {
namespace {

/// Rays counted by one task.
constexpr std::size_t kRaysTogether = 1024;

/// Counts the steps of trace_single().
struct CountSteps {
  TraceCounts* counts;

  void node(unsigned met) const {
    ++counts->nodes;
    counts->boxes += static_cast<std::uint64_t>(__builtin_popcount(met));
  }
  void triangles(int count) const {
    ++counts->blocks;
    counts->triangles += static_cast<std::uint64_t>(count);
  }
  void shapes(int count) const { counts->other += static_cast<std::uint64_t>(count); }
  void instance() const { ++counts->instances; }
};

void count_ray(const Accel& accel, const Ray& ray, TraceCounts& counts) {
  RayState<1, ScalarIsa> state;
  ++counts.rays;
  if (state.set(ray, accel.bounds) == 0) return;
  trace_single<Query::closest>(accel, state, CountSteps{&counts});
  counts.hits += state.item[0] != kNoId;
}

void add(TraceCounts& sum, const TraceCounts& c) {
  sum.rays += c.rays, sum.nodes += c.nodes, sum.boxes += c.boxes, sum.blocks += c.blocks;
  sum.triangles += c.triangles, sum.other += c.other, sum.instances += c.instances, sum.hits += c.hits;
}

}  // namespace

TraceCounts trace_counts(const Accel& accel, const RaySpan& rays) {
  const Chunks chunks(rays.size, kRaysTogether);
  std::vector<TraceCounts> parts(chunks.count);
  chunks.each(true, [&](std::size_t c, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) count_ray(accel, rays[i], parts[c]);
  });
  TraceCounts sum;
  for (const TraceCounts& c : parts) add(sum, c);
  return sum;
}

}  // namespace oktett
