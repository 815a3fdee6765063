/// \file Many lamps: what a picture of a given error costs with 1, 100 and 10 000 lamps of the same power in
/// all.

#include <benchmark/benchmark.h>

#include <cmath>
#include <map>

#include "bench/bench_object.h"
#include "core/random.h"
#include "render/picture/render.h"

namespace oktett::bench {
namespace {

/// Half the edge of the square of ceiling where lamps hang.
constexpr double kReach = 5;

/// Balls on a floor under `count` square lamps of the given edge at random places of a ceiling.
Scene lamps(std::int64_t count, double edge) {
  Scene s;
  s.camera_given = s.lights_given = true;
  s.film = {240, 160, {0, 1, 0, 1}};
  s.camera.from = {0, 3, 9}, s.camera.at = {0, 0.3, 0}, s.camera.fov = 40;
  s.integrator.kind = IntegratorKind::path, s.integrator.depth = 0;
  Material floor, lamp;
  floor.ambient = 0, floor.diffuse = 1;
  lamp.color = {0, 0, 0};
  const auto radiance = static_cast<float>(8 / (static_cast<double>(count) * edge * edge));
  lamp.emission = {radiance, radiance, radiance};
  s.materials = {floor, lamp};
  const auto add = [&](Shape shape, std::uint32_t material) {
    s.objects.push_back(make_object(std::move(shape), material));
  };
  add(PlaneShape{{0, 1, 0}, 0}, 0);
  for (int i = 0; i < 16; ++i) add(SphereShape{{i % 4 * 1.6 - 2.4, 0.5, i / 4 * 1.6 - 2.4}, 0.5}, 0);
  auto mesh = std::make_shared<TriangleMesh>();
  for (std::int64_t i = 0; i < count; ++i) {
    const auto place = [&](std::uint32_t which) {
      const double random =
          count == 1 ? 0.5 : static_cast<double>(random_float(3, static_cast<std::uint32_t>(i), which));
      return (2 * kReach - edge) * (random - 0.5) - edge / 2;
    };
    const double x = place(0), z = place(1);
    const auto first = static_cast<std::uint32_t>(mesh->positions.size());
    for (const Vec3d& p : {Vec3d{x, 4, z}, {x + edge, 4, z}, {x + edge, 4, z + edge}, {x, 4, z + edge}})
      mesh->positions.push_back(Vec3f(p));
    for (const std::uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u}) mesh->indices.push_back(first + k);
  }
  add(MeshShape{mesh, {}, false}, 1);
  return s;
}

struct Measured {
  double seconds = 0, error = 0;
};

/// The relative squared error of a picture with few samples, and the time that it takes.
Measured measure(Scene scene, std::uint32_t samples, const std::vector<float>& reference,
                 std::uint32_t seed) {
  scene.integrator.samples = samples, scene.integrator.seed = seed;
  RenderOptions options;
  options.data_layers = false;
  const RenderResult result = render(scene, options);
  const PicturePlane& plane = *result.picture.find("G");
  Measured m;
  m.seconds = result.report.render_seconds;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const double d = plane.values[i] - reference[i];
    m.error += d * d / (reference[i] * reference[i] + 1e-4) / static_cast<double>(reference.size());
  }
  return m;
}

std::vector<float> long_picture(Scene scene) {
  scene.integrator.samples = 2048, scene.integrator.seed = 9;
  const RenderResult result = render(scene, {});
  const PicturePlane& plane = *result.picture.find("G");
  return {plane.values.begin(), plane.values.end()};
}

/// Counter `to_panel`: seconds times squared error, which is the time for equal error, relative to that of
/// one lamp as large as the ceiling; the picture is the same, so the difference is what choosing among lamps
/// costs. `to_small`: relative to one small lamp, whose shadows have hardly any noise.
void equal_error(benchmark::State& state, std::int64_t count, double edge) {
  constexpr std::uint32_t kSamples = 64;
  static std::map<double, double> of_one;
  const Scene scene = lamps(count, edge);
  const std::vector<float> reference = long_picture(scene);
  double cost = 0, error = 0;
  std::uint32_t seed = 0;
  for (auto _ : state) {
    const Measured m = measure(scene, kSamples, reference, ++seed);
    state.SetIterationTime(m.seconds);
    cost += m.seconds * m.error, error += m.error;
  }
  const auto rounds = static_cast<double>(state.iterations());
  if (count == 1) of_one[edge] = cost / rounds;
  state.counters["squared_error"] = error / rounds;
  state.counters["to_panel"] = cost / rounds / of_one[2 * kReach];
  state.counters["to_small"] = cost / rounds / of_one[0.1];
}

void configure(benchmark::internal::Benchmark* b) {
  b->Unit(benchmark::kMillisecond)->UseManualTime()->MinTime(2);
}

BENCHMARK_CAPTURE(equal_error, panel, 1, 2 * kReach)->Apply(configure);
BENCHMARK_CAPTURE(equal_error, small, 1, 0.1)->Apply(configure);
BENCHMARK_CAPTURE(equal_error, hundred, 100, 0.01)->Apply(configure);
BENCHMARK_CAPTURE(equal_error, ten_thousand, 10000, 0.001)->Apply(configure);

}  // namespace
}  // namespace oktett::bench
