/// \file Building the tree: triangles per second, by threads. The mesh is OKTETT_BENCH_MESH or a generated
/// one.

#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include "accel/accel.h"
#include "bench/bench_mesh.h"

namespace oktett::bench {
namespace {

void build(benchmark::State& state) {
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(state.range(0)));
  Geometry g;
  g.shape = MeshGeometry{&bench_mesh()};
  AccelStats s;
  for (auto _ : state) s = stats(*build_accel({g}));
  const auto triangles = static_cast<double>(bench_mesh().triangle_count());
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(triangles));
  state.counters["tree_bytes_per_triangle"] = static_cast<double>(s.bytes()) / triangles;
  state.counters["sah_cost"] = s.sah_cost;
}

BENCHMARK(build)->ArgName("threads")->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace oktett::bench

BENCHMARK_MAIN();
