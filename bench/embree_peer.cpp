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
#include <tuple>

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

/// Distance, instance, geometry and triangle of a hit.
using Crossing = std::tuple<float, unsigned, unsigned, unsigned>;
/// Those of each ray of a packet.
using Crossings = std::vector<Crossing>[16];

void collect(const RTCFilterFunctionNArguments* args);

/// Embree 3's context or Embree 4's arguments, with one interface.
struct Context {
#if defined(OKTETT_EMBREE4)
  RTCRayQueryContext context;
  Crossings* crossings;
  RTCIntersectArguments intersect;
  RTCOccludedArguments occluded;
  explicit Context(bool coherent, Crossings* to = nullptr) : crossings(to) {
    rtcInitRayQueryContext(&context);
    rtcInitIntersectArguments(&intersect);
    rtcInitOccludedArguments(&occluded);
    intersect.flags = occluded.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    intersect.context = occluded.context = &context;
    if (to == nullptr) return;
    intersect.filter = collect;
    intersect.flags =
        static_cast<RTCRayQueryFlags>(intersect.flags | RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER);
  }
  void closest(RTCScene s, RTCRayHit* r) { rtcIntersect1(s, r, &intersect); }
  void closest(const int* valid, RTCScene s, RTCRayHit8* r) { rtcIntersect8(valid, s, r, &intersect); }
  void closest(const int* valid, RTCScene s, RTCRayHit16* r) { rtcIntersect16(valid, s, r, &intersect); }
  void any(RTCScene s, RTCRay* r) { rtcOccluded1(s, r, &occluded); }
  void any(const int* valid, RTCScene s, RTCRay8* r) { rtcOccluded8(valid, s, r, &occluded); }
  void any(const int* valid, RTCScene s, RTCRay16* r) { rtcOccluded16(valid, s, r, &occluded); }
#else
  RTCIntersectContext context;
  Crossings* crossings;
  explicit Context(bool coherent, Crossings* to = nullptr) : crossings(to) {
    rtcInitIntersectContext(&context);
    context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    if (to != nullptr) context.filter = collect;
  }
  void closest(RTCScene s, RTCRayHit* r) { rtcIntersect1(s, &context, r); }
  void closest(const int* valid, RTCScene s, RTCRayHit8* r) { rtcIntersect8(valid, s, &context, r); }
  void closest(const int* valid, RTCScene s, RTCRayHit16* r) { rtcIntersect16(valid, s, &context, r); }
  void any(RTCScene s, RTCRay* r) { rtcOccluded1(s, &context, r); }
  void any(const int* valid, RTCScene s, RTCRay8* r) { rtcOccluded8(valid, s, &context, r); }
  void any(const int* valid, RTCScene s, RTCRay16* r) { rtcOccluded16(valid, s, &context, r); }
#endif
};

/// Keeps the hits of a packet and rejects them, so that the rays go on.
void collect(const RTCFilterFunctionNArguments* args) {
  // The context is the first member of ours.
  Crossings& crossings = *reinterpret_cast<const Context*>(args->context)->crossings;
  const unsigned n = args->N;
  for (unsigned i = 0; i < n; ++i) {
    if (args->valid[i] != -1) continue;
    args->valid[i] = 0;
    crossings[RTCRayN_id(args->ray, n, i)].emplace_back(
        RTCRayN_tfar(args->ray, n, i), RTCHitN_instID(args->hit, n, i, 0), RTCHitN_geomID(args->hit, n, i),
        RTCHitN_primID(args->hit, n, i));
  }
}

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
    p.mask[i] = ~0u, p.time[i] = 0, p.id[i] = static_cast<unsigned>(i), p.flags[i] = 0;
  }
}

template <int W, class F>
void closest_packets(RTCScene scene, const RaySpan& rays, Context& context, const F& store) {
  alignas(64) int valid[W];
  for (std::size_t b = 0; b < rays.size; b += W) {
    alignas(64) RayHitPacket<W> p;
    fill<W>(p.ray, valid, rays, b);
    for (int i = 0; i < W; ++i) p.hit.geomID[i] = p.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    context.closest(valid, scene, &p);
    for (int i = 0; i < W && b + i < rays.size; ++i) {
      const bool hit = p.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
      store(b + i, i,
            Hit{hit ? p.ray.tfar[i] : std::numeric_limits<float>::infinity(), p.hit.u[i], p.hit.v[i],
                hit ? p.hit.primID[i] : kNoId});
    }
  }
}

template <int W>
void any_packets(RTCScene scene, const RaySpan& rays, std::uint8_t* occluded, Context& context) {
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

/// Calls store(ray, its lane in the packet, nearest hit) for each ray.
template <class F>
void closest(RTCScene scene, const RaySpan& rays, int width, Context& context, const F& store) {
  if (width == 8) return closest_packets<8>(scene, rays, context, store);
  if (width == 16) return closest_packets<16>(scene, rays, context, store);
  for (std::size_t i = 0; i < rays.size; ++i) {
    RTCRayHit r;
    r.ray = one_ray(rays, i);
    r.hit.geomID = r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    context.closest(scene, &r);
    const bool hit = r.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    store(i, 0,
          Hit{hit ? r.ray.tfar : std::numeric_limits<float>::infinity(), r.hit.u, r.hit.v,
              hit ? r.hit.primID : kNoId});
  }
}

RTCGeometry triangles(RTCDevice device, const TriangleMesh& mesh) {
  RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* v =
      rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, mesh.positions.size());
  std::memcpy(v, mesh.positions.data(), mesh.positions.size() * 12);
  void* i = rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, mesh.triangle_count());
  std::memcpy(i, mesh.indices.data(), mesh.triangle_count() * 12);
  return g;
}

RTCGeometry points(RTCDevice device, const std::vector<SphereShape>& spheres) {
  RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
  auto* v = static_cast<float*>(
      rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 16, spheres.size()));
  for (const SphereShape& s : spheres)
    for (const double x : {s.center.x, s.center.y, s.center.z, s.radius}) *v++ = static_cast<float>(x);
  return g;
}

RTCGeometry instance(RTCDevice device, RTCScene child, const InstancePlace& place) {
  RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(g, child);
  rtcSetGeometryTransform(g, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, place.to_list);
  return g;
}

/// A scene without geometries.
RTCScene new_scene(RTCDevice device, EmbreeKind kind) {
  RTCScene scene = rtcNewScene(device);
#if defined(OKTETT_EMBREE4)
  constexpr int kFilter = RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS;
#else
  constexpr int kFilter = RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;
#endif
  const int flags = (kind.robust ? RTC_SCENE_FLAG_ROBUST : 0) | (kind.collects ? kFilter : 0);
  rtcSetSceneFlags(scene, static_cast<RTCSceneFlags>(flags));
  rtcSetSceneBuildQuality(scene, static_cast<RTCBuildQuality>(kind.quality));
  return scene;
}

void add(RTCScene scene, RTCGeometry g, EmbreeKind kind) {
  rtcSetGeometryBuildQuality(g, static_cast<RTCBuildQuality>(kind.quality));
  rtcCommitGeometry(g);
  rtcAttachGeometry(scene, g);
  rtcReleaseGeometry(g);
}

}  // namespace

const std::vector<EmbreeMode>& embree_modes() {
  static const std::vector<EmbreeMode> modes = {{1, true},  {1, false}, {8, true},
                                                {8, false}, {16, true}, {16, false}};
  return modes;
}

EmbreeScene::EmbreeScene(const PeerScene& scene, EmbreeKind kind, const std::string& config)
    : kind_(kind), has_instances_(!scene.places.empty()) {
  device_ = rtcNewDevice(config.c_str());
  rtcSetDeviceMemoryMonitorFunction(device_, count_memory, nullptr);
  const std::ptrdiff_t before = allocated;
  scene_ = new_scene(device_, kind);
  std::vector<RTCScene> models;
  for (const PeerScene::Mesh& mesh : scene.models) {
    models.push_back(new_scene(device_, kind));
    add(models.back(), triangles(device_, *mesh), kind);
  }
  for (const PeerScene::Mesh& mesh : scene.meshes) add(scene_, triangles(device_, *mesh), kind);
  if (!scene.spheres.empty()) add(scene_, points(device_, scene.spheres), kind);
  build_seconds_ = seconds([&] {
    for (RTCScene model : models) rtcCommitScene(model);
    for (const InstancePlace& p : scene.places) add(scene_, instance(device_, models[p.child], p), kind);
    rtcCommitScene(scene_);
  });
  for (RTCScene model : models) rtcReleaseScene(model);
  bytes_ = static_cast<std::size_t>(allocated - before);
}

EmbreeScene::~EmbreeScene() {
  rtcReleaseScene(scene_);
  rtcReleaseDevice(device_);
}

void EmbreeScene::closest_hit(const RaySpan& rays, const HitSpan& hits, EmbreeMode mode) const {
  Context context(mode.coherent);
  closest(scene_, rays, mode.width, context, [&](std::size_t i, int, const Hit& h) {
    hits.t[i] = h.t, hits.u[i] = h.u, hits.v[i] = h.v, hits.item[i] = h.item;
  });
}

void EmbreeScene::any_hit(const RaySpan& rays, std::uint8_t* occluded, EmbreeMode mode) const {
  Context context(mode.coherent);
  if (mode.width == 8) return any_packets<8>(scene_, rays, occluded, context);
  if (mode.width == 16) return any_packets<16>(scene_, rays, occluded, context);
  for (std::size_t i = 0; i < rays.size; ++i) {
    RTCRay r = one_ray(rays, i);
    context.any(scene_, &r);
    occluded[i] = r.tfar < 0;
  }
}

void EmbreeScene::all_hits(const RaySpan& rays, const HitSpan& hits, EmbreeMode mode) const {
  Crossings crossings;
  Context context(mode.coherent, &crossings);
  closest(scene_, rays, mode.width, context, [&](std::size_t i, int lane, const Hit&) {
    std::vector<Crossing>& list = crossings[lane];
    std::sort(list.begin(), list.end());
    const auto end = std::unique(list.begin(), list.end());
    hits.item[i] = static_cast<std::uint32_t>(end - list.begin()), hits.t[i] = 0;
    for (auto crossing = list.begin(); crossing != end; ++crossing) hits.t[i] += std::get<0>(*crossing);
    list.clear();
  });
}

const char* embree_version() { return RTC_VERSION_STRING; }

}  // namespace oktett::bench
