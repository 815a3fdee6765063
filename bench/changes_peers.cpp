/// \file Scenes that change against Embree, in turn: trees that are refitted to moved vertices, trees that
/// are built, and instances that all move.
///
///   changes_peers [OPTION...] MESH...

#if defined(OKTETT_EMBREE4)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "accel/dynamic_accel.h"
#include "bench/peer_timing.h"
#include "bench/program.h"
#include "core/mesh_geometry.h"
#include "core/random.h"
#include "io/mesh/load/load_mesh.h"

namespace oktett::bench {
namespace {

struct ChangesOptions {
  std::vector<std::string> meshes;
  std::vector<int> threads{1, 2};
  int instances = 10000, runs = 15;
};

/// The positions of a mesh in frame `frame`: waves run through it.
std::vector<Vec3f> waving(const TriangleMesh& mesh, float size, int frame) {
  std::vector<Vec3f> all(mesh.positions.begin(), mesh.positions.end());
  for (Vec3f& p : all) p.y += 0.02f * size * std::sin(9 * p.x / size + 0.3f * static_cast<float>(frame));
  return all;
}

/// Where the instances stand in a frame.
std::vector<Affine> places(int count, int frame) {
  std::vector<Affine> all;
  const std::uint64_t key = mix_bits(7);
  std::uint32_t drawn = 0;
  const auto random = [&] { return 2.0 * random_float(key, 0, drawn++) - 1; };
  for (int i = 0; i < count; ++i) {
    const Vec3d at{random(), random(), random()}, angles{random(), random(), random()};
    all.push_back(Affine::translation(at * 50.0 + Vec3d{0, 0.1 * frame, 0}) *
                  Affine::rotation(angles * (180.0 + frame)));
  }
  return all;
}

/// A scene of Embree's.
class Rival {
 public:
  Rival(RTCDevice device, RTCBuildQuality quality, bool dynamic)
      : device_(device), scene_(rtcNewScene(device)), quality_(quality) {
    rtcSetSceneBuildQuality(scene_, dynamic ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_MEDIUM);
    if (dynamic) rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_DYNAMIC);
  }
  ~Rival() { rtcReleaseScene(scene_); }
  Rival(const Rival&) = delete;
  Rival& operator=(const Rival&) = delete;

  void add(const TriangleMesh& mesh) {
    geometry_ = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryBuildQuality(geometry_, quality_);
    vertices_ = rtcSetNewGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12,
                                        mesh.positions.size());
    std::memcpy(vertices_, mesh.positions.data(), mesh.positions.size() * 12);
    void* indices = rtcSetNewGeometryBuffer(geometry_, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12,
                                            mesh.triangle_count());
    std::memcpy(indices, mesh.indices.data(), mesh.triangle_count() * 12);
    attach(geometry_);
  }
  void move(const std::vector<Vec3f>& positions) {
    std::memcpy(vertices_, positions.data(), positions.size() * 12);
    rtcUpdateGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(geometry_);
  }
  void add(const Rival& child, const std::vector<Affine>& at) {
    for (const Affine& place : at) {
      RTCGeometry g = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
      rtcSetGeometryInstancedScene(g, child.scene_);
      set(g, place);
      attach(g);
      instances_.push_back(g);
    }
  }
  void move(const std::vector<Affine>& at) {
    for (std::size_t i = 0; i < at.size(); ++i) set(instances_[i], at[i]), rtcCommitGeometry(instances_[i]);
  }
  void commit() { rtcCommitScene(scene_); }

 private:
  void attach(RTCGeometry g) {
    rtcCommitGeometry(g);
    rtcAttachGeometry(scene_, g);
    rtcReleaseGeometry(g);
  }
  static void set(RTCGeometry g, const Affine& place) {
    double rows[12];
    place.to_rows(rows);
    float numbers[12];
    std::copy(rows, rows + 12, numbers);
    rtcSetGeometryTransform(g, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, numbers);
  }

  RTCDevice device_;
  RTCScene scene_;
  RTCBuildQuality quality_;
  RTCGeometry geometry_ = nullptr;
  void* vertices_ = nullptr;
  std::vector<RTCGeometry> instances_;
};

/// Times of both, in turn.
struct Row {
  std::vector<double> ours, theirs;

  void print(const std::string& what, int threads) const {
    const Quartiles a = quartiles(ours), b = quartiles(theirs);
    fmt::print("{:<34}{:>8}{:>12.3f}{:>12.3f}{:>10.2f}\n", what, threads, 1e3 * a.median, 1e3 * b.median,
               b.median / a.median);
  }
};

void compare_mesh(const std::string& path, const ChangesOptions& options, int threads) {
  const auto mesh = std::make_shared<const TriangleMesh>(load_mesh(path).mesh);
  const float size = max_component(corner_box(*mesh).extent());
  const std::string name = std::filesystem::path(path).stem().string();
  Row build, refit;
  on_threads(threads, [&] {
    RTCDevice device = rtcNewDevice("");
    DynamicAccel ours({.parallel = threads > 1});
    const std::uint32_t number = ours.add(mesh, {MeshGeometry{}, {}, kNoId});
    ours.accel();
    Rival theirs(device, RTC_BUILD_QUALITY_REFIT, true);
    theirs.add(*mesh), theirs.commit();
    for (int run = 0; run < options.runs; ++run) {
      const std::vector<Vec3f> positions = waving(*mesh, size, run);
      refit.ours.push_back(seconds([&] { ours.set_vertices(number, positions), ours.accel(); }));
      refit.theirs.push_back(seconds([&] { theirs.move(positions), theirs.commit(); }));
      if (run % 3 != 0) continue;
      build.ours.push_back(seconds([&] {
        build_accel({{MeshGeometry{mesh.get()}, {}, kNoId}}, {.parallel = threads > 1});
      }));
      Rival fresh(device, RTC_BUILD_QUALITY_MEDIUM, false);
      fresh.add(*mesh);
      build.theirs.push_back(seconds([&] { fresh.commit(); }));
    }
    if (ours.work().builds > 2) fmt::print("{}: the tree was built {} times\n", name, ours.work().builds);
    rtcReleaseDevice(device);
  });
  build.print(name + " build", threads), refit.print(name + " refit", threads);
  fmt::print("{:<34}{:>8}{:>12}{:>12}{:>10.2f}\n", name + " build over refit", threads, "", "",
             quartiles(build.ours).median / quartiles(refit.ours).median);
}

void compare_instances(const ChangesOptions& options, int threads) {
  TriangleMesh box;
  for (int i = 0; i < 8; ++i)
    box.positions.push_back({i & 1 ? 1.0f : 0.0f, i & 2 ? 1.0f : 0.0f, i & 4 ? 1.0f : 0.0f});
  for (const std::uint32_t i : {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5})
    box.indices.push_back(i);
  Row moved;
  on_threads(threads, [&] {
    RTCDevice device = rtcNewDevice("");
    const auto child = build_accel({{MeshGeometry{&box}, {}, kNoId}});
    DynamicAccel ours({.parallel = threads > 1});
    std::vector<std::uint32_t> numbers;
    for (const Affine& place : places(options.instances, 0))
      numbers.push_back(ours.add({InstanceGeometry{child}, place, kNoId}));
    ours.accel();
    Rival box_scene(device, RTC_BUILD_QUALITY_MEDIUM, false);
    box_scene.add(box), box_scene.commit();
    Rival medium(device, RTC_BUILD_QUALITY_MEDIUM, false), low(device, RTC_BUILD_QUALITY_LOW, true);
    for (Rival* rival : {&medium, &low}) rival->add(box_scene, places(options.instances, 0)), rival->commit();
    for (int run = 1; run <= options.runs; ++run) {
      const std::vector<Affine> at = places(options.instances, run);
      moved.ours.push_back(seconds([&] {
        for (std::size_t i = 0; i < at.size(); ++i) ours.set_transform(numbers[i], at[i]);
        ours.accel();
      }));
      const auto commit = [&](Rival& rival) { return seconds([&] { rival.move(at), rival.commit(); }); };
      moved.theirs.push_back(std::min(commit(medium), commit(low)));
    }
    rtcReleaseDevice(device);
  });
  moved.print(fmt::format("{} instances move", options.instances), threads);
}

int run(int argc, char** argv) {
  ChangesOptions options;
  const std::vector<Option> known = {
      {"--threads", "N,...", "numbers of threads (default 1,2)",
       [&](const std::string& value) {
         options.threads = each(value, [](const std::string& word) { return number(word, 1, 1024); });
       }},
      {"--instances", "N", "instances that move (default 10000)",
       [&](const std::string& value) { options.instances = number(value, 1, 10'000'000); }},
      {"--runs", "N", "frames (default 15)",
       [&](const std::string& value) { options.runs = number(value, 1, 100'000); }}};
  options.meshes = parse_options(argc, argv,
                                 "usage: changes_peers [OPTION...] MESH...\n"
                                 "Times of changes, in turn with Embree " RTC_VERSION_STRING "\n",
                                 known);
  fmt::print("{:<34}{:>8}{:>12}{:>12}{:>10}\n", "", "threads", "Oktett ms", "Embree ms", "ratio");
  for (const int threads : options.threads) {
    for (const std::string& mesh : options.meshes) compare_mesh(mesh, options, threads);
    compare_instances(options, threads);
  }
  return 0;
}

}  // namespace
}  // namespace oktett::bench

int main(int argc, char** argv) { return oktett::bench::run_program(oktett::bench::run, argc, argv); }
