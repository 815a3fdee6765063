/// \file Rays through the tree: primary, shadow and diffuse, by instruction set and by traversal.
/// One thread. The mesh is OKTETT_BENCH_MESH or a generated one; OKTETT_BENCH_BVH=compact makes its tree
/// compact.

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <cstdlib>
#include <limits>
#include <string_view>
#include <vector>

#include "accel/query.h"
#include "bench/bench_mesh.h"
#include "bench/bench_rays.h"

namespace oktett::bench {
namespace {

enum class Work { primary, shadow, diffuse };

/// The mesh's tree and its rays, made once.
struct Scene {
  std::shared_ptr<const Accel> accel;
  RayBatch rays[3];

  Scene() {
    const char* const bvh = std::getenv("OKTETT_BENCH_BVH");
    const bool compact = bvh != nullptr && std::string_view(bvh) == "compact";
    accel = build_accel({{MeshGeometry{&bench_mesh()}, {}}},
                        {compact ? BuildQuality::compact : BuildQuality::balanced});
    const View view{512, false};
    const Box box = bounds(*accel);
    rays[0] = primary_rays(box, view);
    HitBatch hits;
    hits.resize_uninitialized(rays[0].size());
    closest_hit(*accel, rays[0].span(), hits.span(), default_isa());
    rays[1] = shadow_rays(*accel, rays[0], hits, box, view);
    rays[2] = diffuse_rays(*accel, rays[0], hits, box, 1, std::numeric_limits<float>::infinity());
  }
};

const Scene& scene() {
  static const Scene s;
  return s;
}

void trace(benchmark::State& state, Work work, Isa isa, TraceMode mode) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const RayBatch& rays = scene().rays[static_cast<int>(work)];
  HitBatch hits;
  hits.resize_uninitialized(rays.size());
  std::vector<std::uint8_t> occluded(rays.size());
  for (auto _ : state) {
    if (work == Work::shadow)
      any_hit(*scene().accel, rays.span(), occluded.data(), isa, mode);
    else
      closest_hit(*scene().accel, rays.span(), hits.span(), isa, mode);
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(rays.size()));
}

/// Runs before main().
[[maybe_unused]] const bool registered = [] {
  const std::pair<Work, const char*> works[] = {
      {Work::primary, "primary"}, {Work::shadow, "shadow"}, {Work::diffuse, "diffuse"}};
  const std::pair<TraceMode, const char*> modes[] = {{TraceMode::automatic, "automatic"},
                                                     {TraceMode::single, "single"},
                                                     {TraceMode::interleaved, "interleaved"},
                                                     {TraceMode::packet8, "packet8"},
                                                     {TraceMode::packet16, "packet16"}};
  for (const auto& [work, name] : works)
    for (Isa isa : available_isas())
      for (const auto& [mode, mode_name] : modes) {
        if (isa == Isa::scalar && mode != TraceMode::single) continue;
        if (isa != Isa::avx512 && mode == TraceMode::packet16) continue;
        benchmark::RegisterBenchmark(
            fmt::format("{}/{}/{}", name, to_string(isa), mode_name).c_str(),
            [rays = work, isa, by = mode](benchmark::State& s) { trace(s, rays, isa, by); })
            ->Unit(benchmark::kMillisecond);
      }
  return true;
}();

}  // namespace
}  // namespace oktett::bench
