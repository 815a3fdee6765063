/// \file Loading a mesh file and building its tree, with Oktett or with Embree, one program run each: for
/// meshes about as large as the memory of the machine. Prints times and the greatest resident memory.

#include <fmt/core.h>
#include <sys/resource.h>

#include <cstdlib>
#include <string>

#include "accel/accel.h"
#include "bench/peer_timing.h"
#include "bench/program.h"
#include "core/error.h"
#include "io/mesh/load/load_mesh.h"

#ifdef OKTETT_EMBREE4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace oktett::bench {
namespace {

constexpr const char* kUsage =
    "usage: large_peers QUALITY MESH [TOGETHER]\n"
    "  QUALITY: balanced, compact or fast of Oktett; embree or embree-compact\n"
    "  TOGETHER: BuildOptions::together\n";

/// In 10^9 bytes.
double peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024e-9 * static_cast<double>(usage.ru_maxrss);
}

void report(const char* what, double seconds) {
  fmt::print("{:8} {:8.2f} s, peak {:6.2f} GB\n", what, seconds, peak_memory());
  std::fflush(stdout);
}

void build_embree(const TriangleMesh& mesh, bool compact) {
  RTCDevice device = rtcNewDevice(nullptr);
  RTCScene scene = rtcNewScene(device);
  if (compact) rtcSetSceneFlags(scene, RTC_SCENE_FLAG_COMPACT);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.positions.data(), 0,
                             sizeof(Vec3f), mesh.positions.size());
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.indices.data(), 0,
                             3 * sizeof(std::uint32_t), mesh.triangle_count());
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcCommitScene(scene);
  if (const RTCError error = rtcGetDeviceError(device); error != RTC_ERROR_NONE)
    throw Error(fmt::format("Embree cannot build the tree: error {}", static_cast<int>(error)),
                ErrorKind::io);
  rtcReleaseGeometry(geometry), rtcReleaseScene(scene), rtcReleaseDevice(device);
}

int run(int argc, char** argv) {
  if (argc < 3 || argc > 4) throw Error(kUsage);
  const std::string quality = argv[1];
  MeshFile file;
  report("load", seconds([&] { file = load_mesh(argv[2]); }));
  fmt::print("{} triangles\n", file.mesh.triangle_count());
  if (quality == "embree" || quality == "embree-compact") {
    report("build", seconds([&] { build_embree(file.mesh, quality == "embree-compact"); }));
    return 0;
  }
  BuildOptions options;
  if (argc == 4) options.together = std::strtoull(argv[3], nullptr, 10);
  if (quality == "compact")
    options.quality = BuildQuality::compact;
  else if (quality == "fast")
    options.quality = BuildQuality::fast;
  else if (quality != "balanced")
    throw Error(kUsage);
  std::shared_ptr<const Accel> accel;
  report("build", seconds([&] { accel = build_accel({{MeshGeometry{&file.mesh}, {}}}, options); }));
  const AccelStats all = stats(*accel);
  fmt::print("tree {:.2f} bytes per triangle, cost {:.2f}\n",
             static_cast<double>(all.bytes()) / static_cast<double>(all.triangles), all.sah_cost);
  return 0;
}

}  // namespace
}  // namespace oktett::bench

int main(int argc, char** argv) { return oktett::bench::run_program(oktett::bench::run, argc, argv); }
