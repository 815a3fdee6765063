/// \file Ways to trace a height field: as a mesh of 2 n^2 triangles, cell by cell, by spans, and by the
/// pyramid. One thread; the time of one item is that of one ray.
///
/// - all: from points above the terrain in directions of the whole sphere;
/// - level: horizontal, in all directions, through a field with one high sample. This measures the cost of
///   cells without a hit;
/// - camera: a picture from above one edge.
///
/// The mesh needs about 65 bytes per triangle and twice that while it is built; it is left out above
/// OKTETT_BENCH_MESH_SIDE samples along a side (2048).

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <vector>

#include "accel/accel.h"
#include "bench/terrain.h"
#include "core/random.h"
#include "kernels/heights/height_grid.h"

namespace oktett::bench {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr double kHeight = 0.25;
constexpr std::size_t kRays = 1 << 14;
constexpr std::uint32_t kPicture = 256;

/// As a mesh, or how a height field is walked.
using Method = std::optional<HeightWalk>;
enum class Work { all, level, camera };

std::uint32_t most_mesh_side() {
  const char* given = std::getenv("OKTETT_BENCH_MESH_SIDE");
  return given != nullptr ? static_cast<std::uint32_t>(std::strtoul(given, nullptr, 10)) : 2048;
}

struct Field {
  TriangleMesh mesh;
  std::shared_ptr<const HeightGrid> grid;
  std::shared_ptr<const Accel> accel;
  std::size_t bytes = 0;
};

/// The field that was used last. Only one is in memory at a time.
const Field& field(std::uint32_t n, Method walk, bool level) {
  static std::map<std::tuple<std::uint32_t, Method, bool>, Field> fields;
  const auto key = std::tuple{n, walk, level};
  if (const auto found = fields.find(key); found != fields.end()) return found->second;
  fields.clear();
  Field& f = fields[key];
  Column<std::uint16_t> heights = level ? Column<std::uint16_t>(std::size_t{n} * n, 0) : terrain(n);
  if (level) heights[0] = 65535;
  if (!walk) {
    f.mesh = terrain_mesh(heights, n, kHeight);
    f.accel = build_accel({{MeshGeometry{&f.mesh}, {}}});
    f.bytes = f.mesh.bytes() + stats(*f.accel).bytes();
  } else {
    HeightFieldShape s;
    s.grid = HeightGrid::from_words(n, n, std::move(heights), HeightInterpolation::triangles);
    s.size = {2, kHeight, 2};
    s.walk = *walk;
    f.accel = build_accel({{ExactShape{s}, {}}});
    f.bytes = stats(*f.accel).bytes();
  }
  return f;
}

RayBatch rays_of(Work work) {
  RayBatch rays;
  const auto random = [](std::size_t i, std::uint32_t k) {
    return random_float(23, static_cast<std::uint32_t>(i), k);
  };
  if (work == Work::camera) {
    for (std::uint32_t tile = 0; tile < kPicture * kPicture / 256; ++tile)
      for (std::uint32_t k = 0; k < 256; ++k) {
        // Tiles of 16 x 16, of blocks of 4 x 4.
        const std::uint32_t block = k / 16, in = k % 16, across = kPicture / 16;
        const float x = static_cast<float>(tile % across * 16 + block % 4 * 4 + in % 4),
                    y = static_cast<float>(tile / across * 16 + block / 4 * 4 + in / 4);
        const float u = (x + 0.5f) / kPicture - 0.5f, v = 0.5f - (y + 0.5f) / kPicture;
        rays.push_back({{0, 0.7f, 1.8f}, 0, {u, v - 0.45f, -1}, kInf});
      }
    return rays;
  }
  for (std::size_t i = 0; i < kRays; ++i) {
    const float turn = 2 * std::numbers::pi_v<float> * random(i, 3);
    const float y = work == Work::level ? 0 : 2 * random(i, 4) - 1, r = std::sqrt(1 - y * y);
    const Vec3f from{2 * random(i, 0) - 1, work == Work::level ? 0.1f : 0.26f * random(i, 1),
                     2 * random(i, 2) - 1};
    rays.push_back({from, 0, {r * std::cos(turn), y, r * std::sin(turn)}, kInf});
  }
  return rays;
}

void trace(benchmark::State& state, std::uint32_t n, Method walk, Work work) {
  if (!walk && n > most_mesh_side()) return state.SkipWithError("not run: memory");
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Field& f = field(n, walk, work == Work::level);
  const RayBatch rays = rays_of(work);
  HitBatch hits;
  hits.resize_uninitialized(rays.size());
  for (auto _ : state) {
    closest_hit(*f.accel, rays.span(), hits.span(), default_isa());
    benchmark::ClobberMemory();
  }
  std::size_t met = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) met += hits[i].valid();
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(rays.size()));
  state.counters["ns_per_ray"] =
      benchmark::Counter(static_cast<double>(rays.size()) * 1e-9,
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["MB"] = static_cast<double>(f.bytes) * 1e-6;
  state.counters["hit"] = static_cast<double>(met) / static_cast<double>(rays.size());
}

/// Runs before main().
[[maybe_unused]] const bool registered = [] {
  const std::pair<Work, const char*> works[] = {
      {Work::all, "all"}, {Work::level, "level"}, {Work::camera, "camera"}};
  const std::pair<Method, const char*> methods[] = {{std::nullopt, "mesh"},
                                                    {HeightWalk::cells, "cells"},
                                                    {HeightWalk::spans, "spans"},
                                                    {HeightWalk::pyramid, "pyramid"}};
  for (const std::uint32_t n : {512u, 1024u, 2048u, 4096u, 8192u})
    for (const auto& [method, method_name] : methods)
      for (const auto& [work, work_name] : works)
        benchmark::RegisterBenchmark(
            fmt::format("{}/{}/{}", work_name, n, method_name).c_str(),
            [n, walk = method, rays = work](benchmark::State& s) { trace(s, n, walk, rays); })
            ->Unit(benchmark::kMillisecond);
  return true;
}();

}  // namespace
}  // namespace oktett::bench
