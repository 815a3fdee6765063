#include "bench/embree_peer.h"

#if defined(OKTETT_EMBREE4)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <atomic>
#include <cstring>
#include <limits>

#include "bench/peer_timing.h"

namespace oktett::bench {
namespace {

std::atomic<std::ptrdiff_t> allocated{0};

bool count_memory(void*, ssize_t bytes, bool) {
  allocated += bytes;
  return true;
}

template <int W>
using RayHitPacket = std::conditional_t<W == 8, RTCRayHit8, RTCRayHit16>;

/// Embree 3's context or Embree 4's arguments, with one interface.
struct Context {
#if defined(OKTETT_EMBREE4)
  RTCIntersectArguments intersect;
  RTCOccludedArguments occluded;
  explicit Context(bool coherent) {
    rtcInitIntersectArguments(&intersect);
    rtcInitOccludedArguments(&occluded);
    intersect.flags = occluded.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
  }
  void closest(RTCScene s, RTCRayHit* r) { rtcIntersect1(s, r, &intersect); }
  void closest(const int* valid, RTCScene s, RTCRayHit8* r) { rtcIntersect8(valid, s, r, &intersect); }
  void closest(const int* valid, RTCScene s, RTCRayHit16* r) { rtcIntersect16(valid, s, r, &intersect); }
  void any(RTCScene s, RTCRay* r) { rtcOccluded1(s, r, &occluded); }
  void any(const int* valid, RTCScene s, RTCRay8* r) { rtcOccluded8(valid, s, r, &occluded); }
  void any(const int* valid, RTCScene s, RTCRay16* r) { rtcOccluded16(valid, s, r, &occluded); }
#else
  RTCIntersectContext context;
  explicit Context(bool coherent) {
    rtcInitIntersectContext(&context);
    context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  }
  void closest(RTCScene s, RTCRayHit* r) { rtcIntersect1(s, &context, r); }
  void closest(const int* valid, RTCScene s, RTCRayHit8* r) { rtcIntersect8(valid, s, &context, r); }
  void closest(const int* valid, RTCScene s, RTCRayHit16* r) { rtcIntersect16(valid, s, &context, r); }
  void any(RTCScene s, RTCRay* r) { rtcOccluded1(s, &context, r); }
  void any(const int* valid, RTCScene s, RTCRay8* r) { rtcOccluded8(valid, s, &context, r); }
  void any(const int* valid, RTCScene s, RTCRay16* r) { rtcOccluded16(valid, s, &context, r); }
#endif
};

/// Copies W rays into Embree's packet; idle lanes repeat the first.
template <int W, class Packet>
void fill(Packet& p, int* valid, const RaySpan& rays, std::size_t b) {
  const int count = static_cast<int>(std::min<std::size_t>(W, rays.size - b));
  for (int i = 0; i < W; ++i) {
    const std::size_t k = b + (i < count ? i : 0);
    valid[i] = i < count ? -1 : 0;
    p.org_x[i] = rays.origin[0][k], p.org_y[i] = rays.origin[1][k], p.org_z[i] = rays.origin[2][k];
    p.dir_x[i] = rays.direction[0][k], p.dir_y[i] = rays.direction[1][k], p.dir_z[i] = rays.direction[2][k];
    p.tnear[i] = rays.tmin[k], p.tfar[i] = rays.tmax[k];
    p.mask[i] = ~0u, p.time[i] = 0, p.id[i] = 0, p.flags[i] = 0;
  }
}

template <int W>
void closest_packets(RTCScene scene, const RaySpan& rays, const HitSpan& hits, bool coherent) {
  Context context(coherent);
  alignas(64) int valid[W];
  for (std::size_t b = 0; b < rays.size; b += W) {
    alignas(64) RayHitPacket<W> p;
    fill<W>(p.ray, valid, rays, b);
    for (int i = 0; i < W; ++i) p.hit.geomID[i] = p.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    context.closest(valid, scene, &p);
    for (int i = 0; i < W && b + i < rays.size; ++i) {
      const bool hit = p.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
      hits.t[b + i] = hit ? p.ray.tfar[i] : std::numeric_limits<float>::infinity();
      hits.u[b + i] = p.hit.u[i], hits.v[b + i] = p.hit.v[i];
      hits.item[b + i] = hit ? p.hit.primID[i] : kNoId;
    }
  }
}

template <int W>
void any_packets(RTCScene scene, const RaySpan& rays, std::uint8_t* occluded, bool coherent) {
  Context context(coherent);
  alignas(64) int valid[W];
  for (std::size_t b = 0; b < rays.size; b += W) {
    alignas(64) decltype(RayHitPacket<W>::ray) p;
    fill<W>(p, valid, rays, b);
    context.any(valid, scene, &p);
    for (int i = 0; i < W && b + i < rays.size; ++i) occluded[b + i] = p.tfar[i] < 0;
  }
}

RTCRay one_ray(const RaySpan& rays, std::size_t i) {
  RTCRay r{};
  r.org_x = rays.origin[0][i], r.org_y = rays.origin[1][i], r.org_z = rays.origin[2][i];
  r.dir_x = rays.direction[0][i], r.dir_y = rays.direction[1][i], r.dir_z = rays.direction[2][i];
  r.tnear = rays.tmin[i], r.tfar = rays.tmax[i], r.mask = ~0u;
  return r;
}

}  // namespace

const std::vector<EmbreeMode>& embree_modes() {
  static const std::vector<EmbreeMode> modes = {{1, true},  {1, false}, {8, true},
                                                {8, false}, {16, true}, {16, false}};
  return modes;
}

EmbreeScene::EmbreeScene(const TriangleMesh& mesh, int quality, const char* config) {
  device_ = rtcNewDevice(config);
  rtcSetDeviceMemoryMonitorFunction(device_, count_memory, nullptr);
  const std::ptrdiff_t before = allocated;
  scene_ = rtcNewScene(device_);
  RTCGeometry g = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* v =
      rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, mesh.positions.size());
  std::memcpy(v, mesh.positions.data(), mesh.positions.size() * 12);
  void* i = rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, mesh.triangle_count());
  std::memcpy(i, mesh.indices.data(), mesh.triangle_count() * 12);
  rtcSetGeometryBuildQuality(g, static_cast<RTCBuildQuality>(quality));
  rtcCommitGeometry(g);
  rtcAttachGeometry(scene_, g);
  rtcReleaseGeometry(g);
  rtcSetSceneBuildQuality(scene_, static_cast<RTCBuildQuality>(quality));
  build_seconds_ = seconds([&] { rtcCommitScene(scene_); });
  bytes_ = static_cast<std::size_t>(allocated - before);
}

EmbreeScene::~EmbreeScene() {
  rtcReleaseScene(scene_);
  rtcReleaseDevice(device_);
}

void EmbreeScene::closest_hit(const RaySpan& rays, const HitSpan& hits, EmbreeMode mode) const {
  if (mode.width == 8) return closest_packets<8>(scene_, rays, hits, mode.coherent);
  if (mode.width == 16) return closest_packets<16>(scene_, rays, hits, mode.coherent);
  Context context(mode.coherent);
  for (std::size_t i = 0; i < rays.size; ++i) {
    RTCRayHit r;
    r.ray = one_ray(rays, i);
    r.hit.geomID = r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    context.closest(scene_, &r);
    const bool hit = r.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    hits.t[i] = hit ? r.ray.tfar : std::numeric_limits<float>::infinity();
    hits.u[i] = r.hit.u, hits.v[i] = r.hit.v, hits.item[i] = hit ? r.hit.primID : kNoId;
  }
}

void EmbreeScene::any_hit(const RaySpan& rays, std::uint8_t* occluded, EmbreeMode mode) const {
  if (mode.width == 8) return any_packets<8>(scene_, rays, occluded, mode.coherent);
  if (mode.width == 16) return any_packets<16>(scene_, rays, occluded, mode.coherent);
  Context context(mode.coherent);
  for (std::size_t i = 0; i < rays.size; ++i) {
    RTCRay r = one_ray(rays, i);
    context.any(scene_, &r);
    occluded[i] = r.tfar < 0;
  }
}

const char* embree_version() { return RTC_VERSION_STRING; }

}  // namespace oktett::bench
