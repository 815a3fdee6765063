/// \file Building the tree: triangles per second, by threads, and a million instances. The mesh is
/// OKTETT_BENCH_MESH or a generated one.

#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include "accel/accel.h"
#include "bench/bench_mesh.h"
#include "core/random.h"

namespace oktett::bench {
namespace {

void build(benchmark::State& state) {
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(state.range(0)));
  AccelStats s;
  for (auto _ : state) s = stats(*build_accel({{MeshGeometry{&bench_mesh()}, {}}}));
  const auto triangles = static_cast<double>(bench_mesh().triangle_count());
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(triangles));
  state.counters["tree_bytes_per_triangle"] = static_cast<double>(s.bytes()) / triangles;
  state.counters["sah_cost"] = s.sah_cost;
}

/// Instances of one box, turned and scaled, all over a cube.
InstanceList scattered_instances(std::uint32_t count) {
  InstanceList list{{build_accel({{BoxShape{}, {}, 0}})}, std::vector<InstancePlace>(count)};
  const std::uint64_t key = mix_bits(1);
  std::uint32_t drawn = 0;
  const auto random = [&] { return 2.0 * random_float(key, 0, drawn++) - 1; };
  for (InstancePlace& place : list.places) {
    const Vec3d at{random(), random(), random()}, angles{random(), random(), random()};
    const Affine m = Affine::translation(at * 100.0) * Affine::rotation(angles * 180.0) *
                     Affine::scaling({0.5, 0.5 + 0.1 * random(), 0.5});
    m.to_rows(place.to_list);
    place.child = 0;
  }
  return list;
}

void build_instances(benchmark::State& state) {
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(state.range(0)));
  const InstanceList list = scattered_instances(1'000'000);
  AccelStats s;
  for (auto _ : state) s = stats(*build_accel({{list, {}, 0}}));
  const auto count = static_cast<double>(list.places.size());
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(count));
  state.counters["bytes_per_instance"] = static_cast<double>(s.bytes()) / count;
}

BENCHMARK(build_instances)->ArgName("threads")->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(build)->ArgName("threads")->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace oktett::bench
