/// \file Reading binary PLY, STL and GLB files, against reading their bytes block by block and copying them
/// to fresh memory. The files hold a wavy sheet and take about OKTETT_BENCH_MEGABYTES (20) each.

#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "bench/program.h"
#include "core/bytes.h"
#include "io/mesh/load/load_mesh.h"

namespace oktett::bench {
namespace {

namespace fs = std::filesystem;

std::size_t wanted_bytes() {
  const char* const megabytes = std::getenv("OKTETT_BENCH_MEGABYTES");
  return static_cast<std::size_t>(megabytes != nullptr ? std::atoi(megabytes) : 20) * 1000000;
}

/// A sheet of n x n squares.
struct Sheet {
  std::uint32_t n;

  float height(std::uint32_t x, std::uint32_t y) const {
    return static_cast<float>(5 * std::sin(0.11 * x) * std::cos(0.07 * y));
  }
  void append_vertex(std::string& bytes, std::uint32_t i) const {
    const std::uint32_t x = i % (n + 1), y = i / (n + 1);
    for (const float v : {static_cast<float>(x), static_cast<float>(y), height(x, y)})
      append_number(bytes, v);
  }
  /// Calls f(a, b, c) for each triangle.
  template <class F>
  void for_each_triangle(const F& f) const {
    for (std::uint32_t y = 0; y < n; ++y)
      for (std::uint32_t x = 0; x < n; ++x) {
        const std::uint32_t i = y * (n + 1) + x;
        f(i, i + 1, i + n + 2);
        f(i, i + n + 2, i + n + 1);
      }
  }
};

std::string ply_bytes() {
  const Sheet sheet{static_cast<std::uint32_t>(std::sqrt(static_cast<double>(wanted_bytes()) / 38))};
  const std::uint32_t vertices = (sheet.n + 1) * (sheet.n + 1);
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
      "property float z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
      vertices, 2 * sheet.n * sheet.n);
  for (std::uint32_t i = 0; i < vertices; ++i) sheet.append_vertex(bytes, i);
  sheet.for_each_triangle([&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    append_number(bytes, std::uint8_t{3});
    for (const std::uint32_t i : {a, b, c}) append_number(bytes, i);
  });
  return bytes;
}

std::string stl_bytes() {
  const Sheet sheet{static_cast<std::uint32_t>(std::sqrt(static_cast<double>(wanted_bytes()) / 100))};
  std::string bytes(80, ' ');
  append_number(bytes, 2 * sheet.n * sheet.n);
  sheet.for_each_triangle([&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    bytes.append(12, '\0');
    for (const std::uint32_t i : {a, b, c}) sheet.append_vertex(bytes, i);
    bytes.append(2, '\0');
  });
  return bytes;
}

std::string glb_bytes() {
  const Sheet sheet{static_cast<std::uint32_t>(std::sqrt(static_cast<double>(wanted_bytes()) / 36))};
  const std::uint32_t vertices = (sheet.n + 1) * (sheet.n + 1), corners = 6 * sheet.n * sheet.n;
  std::string json = fmt::format(
      R"({{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":{0}}}],"bufferViews":[{{"buffer":0,"byteLength":{1}}},)"
      R"({{"buffer":0,"byteOffset":{1},"byteLength":{2}}}],"accessors":[{{"bufferView":0,"componentType":5126,)"
      R"("count":{3},"type":"VEC3"}},{{"bufferView":1,"componentType":5125,"count":{4},"type":"SCALAR"}}],)"
      R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],"nodes":[{{"mesh":0}}],)"
      R"("scenes":[{{"nodes":[0]}}]}})",
      12 * vertices + 4 * corners, 12 * vertices, 4 * corners, vertices, corners);
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const std::uint32_t data = 12 * vertices + 4 * corners;
  std::string bytes = "glTF";
  append_number(bytes, std::uint32_t{2});
  append_number(bytes, static_cast<std::uint32_t>(28 + json.size() + data));
  append_number(bytes, static_cast<std::uint32_t>(json.size()));
  bytes += "JSON" + json;
  append_number(bytes, data);
  bytes.append("BIN\0", 4);
  for (std::uint32_t i = 0; i < vertices; ++i) sheet.append_vertex(bytes, i);
  sheet.for_each_triangle([&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    for (const std::uint32_t i : {a, b, c}) append_number(bytes, i);
  });
  return bytes;
}

/// A generated file, which is removed at the end of the program.
struct TemporaryFile {
  TemporaryFile(const char* extension, const std::string& bytes)
      : path((fs::temp_directory_path() / fmt::format("oktett-bench-{}{}", getpid(), extension)).string()) {
    write_text(path, bytes);
  }
  ~TemporaryFile() {
    std::error_code ignored;
    fs::remove(path, ignored);
  }
  std::string path;
};

const std::string& file_of(int format) {
  static const TemporaryFile ply(".ply", ply_bytes());
  static const TemporaryFile stl(".stl", stl_bytes());
  static const TemporaryFile glb(".glb", glb_bytes());
  return format == 0 ? ply.path : format == 1 ? stl.path : glb.path;
}

void report(benchmark::State& state, const std::string& path) {
  const auto bytes = static_cast<double>(fs::file_size(path));
  state.counters["MB/s"] = benchmark::Counter(bytes / 1e6, benchmark::Counter::kIsIterationInvariantRate);
  constexpr const char* kNames[] = {"PLY", "STL", "GLB"};
  state.SetLabel(kNames[state.range(0)]);
}

void load(benchmark::State& state) {
  const std::string& path = file_of(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(load_mesh(path).mesh.indices.data());
  report(state, path);
}
BENCHMARK(load)->DenseRange(0, 2)->Unit(benchmark::kMillisecond)->UseRealTime();

/// As `cat` and memcpy do.
void read_and_copy(benchmark::State& state) {
  const std::string& path = file_of(static_cast<int>(state.range(0)));
  const std::size_t size = fs::file_size(path);
  std::vector<char> block(std::size_t{1} << 17);
  for (auto _ : state) {
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    const std::unique_ptr<char[]> copy(new char[size]);
    std::size_t at = 0;
    for (ssize_t got; (got = read(file, block.data(), block.size())) > 0; at += static_cast<std::size_t>(got))
      std::memcpy(copy.get() + at, block.data(), static_cast<std::size_t>(got));
    close(file);
    benchmark::DoNotOptimize(copy.get());
  }
  report(state, path);
}
BENCHMARK(read_and_copy)->DenseRange(0, 2)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace oktett::bench
