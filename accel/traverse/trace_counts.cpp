#include "accel/traverse/trace_counts.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <vector>

#include "accel/traverse/all_hits.h"

namespace oktett {
namespace {

/// Rays counted by one task.
constexpr std::size_t kChunk = 1024;

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
  std::vector<TraceCounts> parts((rays.size + kChunk - 1) / kChunk);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t c) {
    const std::size_t end = std::min((c + 1) * kChunk, rays.size);
    for (std::size_t i = c * kChunk; i < end; ++i) count_ray(accel, rays[i], parts[c]);
  });
  TraceCounts sum;
  for (const TraceCounts& c : parts) add(sum, c);
  return sum;
}

}  // namespace oktett
