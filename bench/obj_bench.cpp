/// \file Reading OBJ meshes, against tinyobjloader if it is installed. The mesh is the one that
/// OKTETT_BENCH_MESH names, or a generated one of about 100,000 triangles.

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "bench/program.h"
#include "io/obj/obj.h"

#ifdef OKTETT_HAVE_TINYOBJLOADER
#include <tiny_obj_loader.h>
#endif

namespace oktett::bench {
namespace {

namespace fs = std::filesystem;

/// A wavy sheet of 224 x 224 squares.
std::string sheet_text() {
  constexpr int n = 225;
  std::string text;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x)
      text += fmt::format("v {:.6f} {:.6f} {:.6f}\n", 0.731 * x, 0.617 * y,
                          5 * std::sin(0.11 * x) * std::cos(0.07 * y));
  for (int y = 0; y + 1 < n; ++y)
    for (int x = 0; x + 1 < n; ++x) {
      const int i = y * n + x + 1;
      text += fmt::format("f {0} {1} {2}\nf {0} {2} {3}\n", i, i + 1, i + n + 1, i + n);
    }
  return text;
}

/// The file to read. A generated file is removed at the end of the program.
struct Mesh {
  const char* given = std::getenv("OKTETT_BENCH_MESH");
  std::string path =
      given != nullptr ? given
                       : (fs::temp_directory_path() / fmt::format("oktett-bench-{}.obj", getpid())).string();
  Mesh() {
    if (given == nullptr) write_text(path, sheet_text());
  }
  ~Mesh() {
    std::error_code ignored;
    if (given == nullptr) fs::remove(path, ignored);
  }
};

const std::string& mesh_path() {
  static const Mesh mesh;
  return mesh.path;
}

void report(benchmark::State& state, std::size_t triangles) {
  const auto bytes = static_cast<double>(fs::file_size(mesh_path()));
  state.counters["MB/s"] = benchmark::Counter(bytes / 1e6, benchmark::Counter::kIsIterationInvariantRate);
  state.counters["Mtri/s"] =
      benchmark::Counter(static_cast<double>(triangles) / 1e6, benchmark::Counter::kIsIterationInvariantRate);
}

void load_with_oktett(benchmark::State& state) {
  std::size_t triangles = 0;
  try {
    for (auto _ : state) {
      const ObjFile file = load_obj(mesh_path());
      triangles = file.mesh.triangle_count();
      benchmark::DoNotOptimize(file.mesh.indices.data());
    }
    report(state, triangles);
  } catch (const std::exception& error) {
    state.SkipWithError(error.what());
  }
}
BENCHMARK(load_with_oktett)->Unit(benchmark::kMillisecond)->UseRealTime();

#ifdef OKTETT_HAVE_TINYOBJLOADER
void load_with_tinyobjloader(benchmark::State& state) {
  std::size_t triangles = 0;
  for (auto _ : state) {
    tinyobj::ObjReader reader;
    if (!reader.ParseFromFile(mesh_path())) {
      state.SkipWithError(reader.Error().c_str());
      return;
    }
    triangles = 0;
    for (const tinyobj::shape_t& shape : reader.GetShapes()) triangles += shape.mesh.num_face_vertices.size();
  }
  report(state, triangles);
}
BENCHMARK(load_with_tinyobjloader)->Unit(benchmark::kMillisecond)->UseRealTime();
#endif

}  // namespace
}  // namespace oktett::bench
