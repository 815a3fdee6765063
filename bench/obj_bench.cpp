/// \file Reading OBJ meshes, against tinyobjloader if it is installed. The mesh is the one that
/// OKTETT_BENCH_MESH names, or a generated one of about 100,000 triangles.

#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "core/error.h"
#include "io/obj/obj.h"

#ifdef OKTETT_HAVE_TINYOBJLOADER
#include <tiny_obj_loader.h>
#endif

namespace oktett::bench {
namespace {

namespace fs = std::filesystem;

/// A wavy sheet of 224 x 224 squares.
void write_sheet(const std::string& path) {
  constexpr int n = 225;
  std::ofstream stream(path);
  char line[128];
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const double height = 5 * std::sin(0.11 * x) * std::cos(0.07 * y);
      std::snprintf(line, sizeof line, "v %.6f %.6f %.6f\n", 0.731 * x, 0.617 * y, height);
      stream << line;
    }
  }
  for (int y = 0; y + 1 < n; ++y) {
    for (int x = 0; x + 1 < n; ++x) {
      const int i = y * n + x + 1;
      std::snprintf(line, sizeof line, "f %d %d %d\nf %d %d %d\n", i, i + 1, i + n + 1, i, i + n + 1, i + n);
      stream << line;
    }
  }
}

/// The file to read. A generated file is removed at the end of the program.
class Mesh {
 public:
  Mesh() {
    if (const char* given = std::getenv("OKTETT_BENCH_MESH")) {
      path_ = given;
      return;
    }
    std::string pattern = (fs::temp_directory_path() / "oktett-bench-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw Error("cannot create a directory for the mesh");
    directory_ = pattern;
    path_ = directory_ + "/sheet.obj";
    write_sheet(path_);
  }
  ~Mesh() {
    std::error_code ignored;
    if (!directory_.empty()) fs::remove_all(directory_, ignored);
  }
  Mesh(const Mesh&) = delete;
  Mesh& operator=(const Mesh&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
  std::string directory_;
};

const std::string& mesh_path() {
  static const Mesh mesh;
  return mesh.path();
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
