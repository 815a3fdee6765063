/// \file A whole picture: a mesh with mirrors on a plane, one sample per pixel, all threads.

#include <benchmark/benchmark.h>

#include <memory>

#include "bench/bench_mesh.h"
#include "bench/bench_object.h"
#include "render/picture/render.h"

namespace oktett::bench {
namespace {

/// The scene shares ownership of its mesh; that of the benchmark lives until the program ends.
Scene make_scene() {
  Scene s;
  s.materials.resize(2);
  s.materials[1].reflection = 0.5f;
  MeshShape mesh;
  mesh.mesh = std::shared_ptr<const TriangleMesh>(&bench_mesh(), [](const TriangleMesh*) {});
  s.objects = {make_object(mesh, 0), make_object(SphereShape{{1.5, -0.5, 0.5}, 0.5}, 1),
               make_object(PlaneShape{{0, 1, 0}, -1.1}, 0)};
  s.film = {960, 540, {0, 1, 0, 1}};
  s.integrator.samples = 1;
  return s;
}

void whitted(benchmark::State& state) {
  RenderOptions options;
  options.isa = default_isa();
  options.data_layers = false;
  std::uint64_t rays = 0;
  double build = 0;
  for (auto _ : state) {
    const RenderReport r = render(make_scene(), options).report;
    rays += r.camera_rays + r.shadow_rays + r.reflected_rays + r.refracted_rays;
    build += r.build_seconds;
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(rays));
  state.counters["build_seconds"] = benchmark::Counter(build, benchmark::Counter::kAvgIterations);
}

BENCHMARK(whitted)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace oktett::bench
