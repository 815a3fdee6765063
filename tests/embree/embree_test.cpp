/// \file The C interface as programs call it, against Oktett's own queries and plain arithmetic.

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "accel/accel.h"
#include "core/random.h"
#include "embree/version.h"

namespace oktett::embree_test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr unsigned kNone = RTC_INVALID_GEOMETRY_ID;

/// A device that keeps the last message.
class Device {
 public:
  Device() : device_(rtcNewDevice(nullptr)) {
    rtcSetDeviceErrorFunction(
        device_, [](void* user, RTCError, const char* text) { static_cast<Device*>(user)->message = text; },
        this);
  }
  ~Device() { rtcReleaseDevice(device_); }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  operator RTCDevice() const { return device_; }
  RTCError error() const { return rtcGetDeviceError(device_); }

  std::string message;

 private:
  RTCDevice device_;
};

class Scene {
 public:
  explicit Scene(RTCDevice device) : scene_(rtcNewScene(device)) {}
  ~Scene() { rtcReleaseScene(scene_); }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;
  operator RTCScene() const { return scene_; }

  unsigned add(RTCGeometry geometry) {
    rtcCommitGeometry(geometry);
    const unsigned number = rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    return number;
  }
  RTCRayHit closest(const Vec3f& o, const Vec3f& d, float time = 0, unsigned mask = ~0u) const {
    RTCRayHit r = ray(o, d, time, mask);
#if OKTETT_EMBREE == 3
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_, &context, &r);
#else
    rtcIntersect1(scene_, &r, nullptr);
#endif
    return r;
  }
  bool occluded(const Vec3f& o, const Vec3f& d, float time = 0, unsigned mask = ~0u) const {
    RTCRayHit r = ray(o, d, time, mask);
#if OKTETT_EMBREE == 3
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene_, &context, &r.ray);
#else
    rtcOccluded1(scene_, &r.ray, nullptr);
#endif
    return r.ray.tfar == -kInf;
  }

 private:
  static RTCRayHit ray(const Vec3f& o, const Vec3f& d, float time, unsigned mask) {
    RTCRayHit r{};
    r.ray.org_x = o.x, r.ray.org_y = o.y, r.ray.org_z = o.z;
    r.ray.dir_x = d.x, r.ray.dir_y = d.y, r.ray.dir_z = d.z;
    r.ray.tfar = kInf, r.ray.time = time, r.ray.mask = mask;
    r.hit.geomID = r.hit.primID = r.hit.instID[0] = kNone;
    return r;
  }
  RTCScene scene_;
};

/// A square at height z of side 2, as two triangles.
RTCGeometry square(RTCDevice device, float z, float later = std::numeric_limits<float>::quiet_NaN()) {
  const RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  const bool moves = !std::isnan(later);
  if (moves) rtcSetGeometryTimeStepCount(g, 2);
  for (unsigned step = 0; step < (moves ? 2u : 1u); ++step) {
    auto* const v = static_cast<float*>(
        rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, step, RTC_FORMAT_FLOAT3, 12, 4));
    const float at = step == 0 ? z : later;
    const float all[12] = {-1, -1, at, 1, -1, at, 1, 1, at, -1, 1, at};
    std::copy_n(all, 12, v);
  }
  auto* const i =
      static_cast<unsigned*>(rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, 2));
  const unsigned both[6] = {0, 1, 2, 0, 2, 3};
  std::copy_n(both, 6, i);
  rtcSetGeometryMask(g, ~0u);
  return g;
}

TEST(Embree, TrianglesHaveTheHitsOfTheLibrary) {
  Device device;
  Scene scene(device);
  TriangleMesh mesh;
  const std::uint64_t key = mix_bits(5);
  std::uint32_t drawn = 0;
  const auto draw = [&] { return 2 * random_float(key, 0, drawn++) - 1; };
  for (int i = 0; i < 300; ++i) mesh.positions.push_back({draw(), draw(), draw()});
  for (std::uint32_t i = 0; i < 600; ++i) mesh.indices.push_back(mix_bits(i) % 300);
  const RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  std::vector<float> positions(4 * 300);
  for (std::size_t i = 0; i < 300; ++i)
    for (int k = 0; k < 3; ++k) positions[4 * i + static_cast<std::size_t>(k)] = mesh.positions[i][k];
  rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, positions.data(), 0, 16, 300);
  rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.indices.data(), 0, 12, 200);
  rtcSetGeometryMask(g, ~0u);
  scene.add(g);
  rtcCommitScene(scene);
  ASSERT_EQ(device.error(), RTC_ERROR_NONE);
  Geometry own;
  own.shape = MeshGeometry{&mesh, false};
  const auto accel = build_accel({own});
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3f o{draw(), draw(), 3}, d{draw(), draw(), -3};
    const Hit expected = closest_hit(*accel, Ray{o, 0, d, kInf});
    const RTCRayHit found = scene.closest(o, d);
    ASSERT_EQ(found.hit.geomID, expected.valid() ? 0 : kNone);
    ASSERT_EQ(scene.occluded(o, d), expected.valid());
    if (!expected.valid()) continue;
    ++hits;
    EXPECT_EQ(found.ray.tfar, expected.t);
    EXPECT_EQ(found.hit.primID, expected.item);
    EXPECT_EQ(found.hit.u, expected.u);
    EXPECT_EQ(found.hit.v, expected.v);
  }
  EXPECT_GT(hits, 500);
}

TEST(Embree, QuadsAndGridsNameFacesAndCoordinates) {
  Device device;
  for (const bool grid : {false, true}) {
    Scene scene(device);
    const RTCGeometry g = rtcNewGeometry(device, grid ? RTC_GEOMETRY_TYPE_GRID : RTC_GEOMETRY_TYPE_QUAD);
    // Three by two quads over [0, 3] x [0, 2].
    auto* const v =
        static_cast<float*>(rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, 12));
    for (int i = 0; i < 12; ++i)
      v[3 * i] = static_cast<float>(i % 4), v[3 * i + 1] = static_cast<float>(i / 4), v[3 * i + 2] = 0;
    if (grid) {
      auto* const all = static_cast<RTCGrid*>(
          rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_GRID, 0, RTC_FORMAT_GRID, sizeof(RTCGrid), 1));
      *all = {0, 4, 4, 3};
    } else {
      auto* const i = static_cast<unsigned*>(
          rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, 16, 6));
      for (unsigned q = 0; q < 6; ++q) {
        const unsigned a = q / 3 * 4 + q % 3, corners[4] = {a, a + 1, a + 5, a + 4};
        std::copy_n(corners, 4, i + 4 * q);
      }
    }
    rtcSetGeometryMask(g, ~0u);
    scene.add(g);
    rtcCommitScene(scene);
    ASSERT_EQ(device.error(), RTC_ERROR_NONE);
    for (float x = 0.125f; x < 3; x += 0.25f)
      for (float y = 0.0625f; y < 2; y += 0.125f) {
        const RTCRayHit r = scene.closest({x, y, 1}, {0, 0, -1});
        ASSERT_EQ(r.hit.geomID, 0u);
        const float cell_x = std::floor(x), cell_y = std::floor(y);
        EXPECT_EQ(r.hit.primID, grid ? 0u : static_cast<unsigned>(3 * cell_y + cell_x));
        EXPECT_NEAR(r.hit.u, grid ? x / 3 : x - cell_x, 1e-6f);
        EXPECT_NEAR(r.hit.v, grid ? y / 2 : y - cell_y, 1e-6f);
        EXPECT_GT(r.hit.Ng_z, 0);
        EXPECT_FLOAT_EQ(r.ray.tfar, 1);
        float p[3];
        rtcInterpolate0(rtcGetGeometry(scene, 0), r.hit.primID, r.hit.u, r.hit.v, RTC_BUFFER_TYPE_VERTEX, 0,
                        p, 3);
        EXPECT_NEAR(p[0], x, 1e-6f);
        EXPECT_NEAR(p[1], y, 1e-6f);
      }
    EXPECT_EQ(device.error(), RTC_ERROR_NONE);
  }
}

TEST(Embree, PointsAndRoundLinesMeetRaysWhereTheyAre) {
  Device device;
  Scene scene(device);
  const auto points = [&](RTCGeometryType type, const std::vector<float>& xyzr) {
    const RTCGeometry g = rtcNewGeometry(device, type);
    auto* const v = static_cast<float*>(
        rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 16, xyzr.size() / 4));
    std::copy(xyzr.begin(), xyzr.end(), v);
    rtcSetGeometryMask(g, ~0u);
    return g;
  };
  scene.add(points(RTC_GEOMETRY_TYPE_SPHERE_POINT, {0, 0, 0, 1, 10, 0, 0, 2}));
  scene.add(points(RTC_GEOMETRY_TYPE_DISC_POINT, {20, 0, 0, 1}));
  const RTCGeometry disc = points(RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT, {30, 0, 0, 1});
  auto* const n =
      static_cast<float*>(rtcSetNewGeometryBuffer(disc, RTC_BUFFER_TYPE_NORMAL, 0, RTC_FORMAT_FLOAT3, 12, 1));
  n[0] = 0, n[1] = 3, n[2] = 4;
  scene.add(disc);
  const RTCGeometry line =
      points(RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE, {40, 0, 0, 1, 44, 0, 0, 0.5f, 48, 0, 0, 0.5f});
  auto* const i =
      static_cast<unsigned*>(rtcSetNewGeometryBuffer(line, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, 4, 2));
  i[0] = 0, i[1] = 1;
  scene.add(line);
  rtcCommitScene(scene);
  ASSERT_EQ(device.error(), RTC_ERROR_NONE);

  RTCRayHit r = scene.closest({10.5f, 0, 5}, {0, 0, -1});
  EXPECT_EQ(r.hit.geomID, 0u);
  EXPECT_EQ(r.hit.primID, 1u);
  EXPECT_NEAR(r.ray.tfar, 5 - std::sqrt(4 - 0.25f), 1e-5f);
  r = scene.closest({20, 0.9f, 5}, {0, 0, -2});
  EXPECT_EQ(r.hit.geomID, 1u);
  EXPECT_FLOAT_EQ(r.ray.tfar, 2.5f);
  EXPECT_EQ(scene.closest({20, 1.1f, 5}, {0, 0, -2}).hit.geomID, kNone);
  r = scene.closest({30, 0.4f, 5}, {0, 0, -1});
  EXPECT_EQ(r.hit.geomID, 2u);
  EXPECT_NEAR(r.ray.tfar, 5.3f, 1e-5f);
  EXPECT_EQ(r.hit.Ng_z, 4);
  // The second segment is a cylinder of radius 1/2.
  r = scene.closest({46, 0, 5}, {0, 0, -1});
  EXPECT_EQ(r.hit.geomID, 3u);
  EXPECT_EQ(r.hit.primID, 1u);
  EXPECT_NEAR(r.ray.tfar, 4.5f, 1e-6f);
  EXPECT_NEAR(r.hit.u, 0.5f, 1e-6f);
  // The first is a cone that touches both spheres: its radius at a place is (r - h sin) / cos.
  r = scene.closest({42, 0, 5}, {0, 0, -1});
  const float sine = 0.125f, cosine = std::sqrt(1 - sine * sine);
  EXPECT_EQ(r.hit.primID, 0u);
  EXPECT_NEAR(r.ray.tfar, 5 - (1 - 2 * sine) / cosine, 1e-6f);
  EXPECT_NEAR(r.hit.Ng_x / std::hypot(r.hit.Ng_x, r.hit.Ng_z), sine, 1e-6f);
  // Along the axis, where curves are easily missed.
  r = scene.closest({60, 0, 0}, {-1, 0, 0});
  EXPECT_EQ(r.hit.geomID, 3u);
  EXPECT_FLOAT_EQ(r.ray.tfar, 11.5f);
}

TEST(Embree, MasksFiltersAndUserGeometriesAreAsked) {
  Device device;
  Scene scene(device);
  const RTCGeometry near = square(device, 2), far = square(device, 1);
  rtcSetGeometryMask(near, 4);
  int asked = 0;
  rtcSetGeometryUserData(far, &asked);
  const auto reject_second = [](const RTCFilterFunctionNArguments* a) {
    ++*static_cast<int*>(a->geometryUserPtr);
    EXPECT_EQ(a->N, 1u);
    EXPECT_FLOAT_EQ(RTCRayN_tfar(a->ray, 1, 0), 4);
    if (RTCHitN_primID(a->hit, 1, 0) == 1) a->valid[0] = 0;
  };
  rtcSetGeometryIntersectFilterFunction(far, reject_second);
  rtcSetGeometryOccludedFilterFunction(far, reject_second);
  scene.add(near), scene.add(far);
  const RTCGeometry user = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(user, 1);
  rtcSetGeometryMask(user, ~0u);
  rtcSetGeometryBoundsFunction(
      user, [](const RTCBoundsFunctionArguments* a) { *a->bounds_o = {-1, -1, 0, 0, 1, 1, 0.5f, 0}; },
      nullptr);
  rtcSetGeometryIntersectFunction(user, [](const RTCIntersectFunctionNArguments* a) {
    auto* const r = reinterpret_cast<RTCRayHit*>(a->rayhit);
    const float t = (0.25f - r->ray.org_z) / r->ray.dir_z;
    if (!(r->ray.tnear < t && t < r->ray.tfar)) return;
    r->ray.tfar = t;
    r->hit.geomID = a->geomID, r->hit.primID = 7, r->hit.u = 0.5f, r->hit.v = 0.25f;
    r->hit.Ng_x = 1, r->hit.Ng_y = 2, r->hit.Ng_z = 3, r->hit.instID[0] = a->context->instID[0];
  });
  rtcSetGeometryOccludedFunction(
      user, [](const RTCOccludedFunctionNArguments* a) { reinterpret_cast<RTCRay*>(a->ray)->tfar = -kInf; });
  scene.add(user);
  rtcCommitScene(scene);
  ASSERT_EQ(device.error(), RTC_ERROR_NONE);

  const Vec3f first{0.5f, -0.5f, 5}, second{-0.5f, 0.5f, 5}, down{0, 0, -1};
  EXPECT_EQ(scene.closest(first, down).hit.geomID, 0u);
  EXPECT_EQ(asked, 0);
  EXPECT_EQ(scene.closest(first, down, 0, ~4u).hit.geomID, 1u);
  EXPECT_EQ(asked, 1);
  const RTCRayHit through = scene.closest(second, down, 0, ~4u);
  EXPECT_EQ(asked, 2);
  EXPECT_EQ(through.hit.geomID, 2u);
  EXPECT_EQ(through.hit.primID, 7u);
  EXPECT_EQ(through.hit.v, 0.25f);
  EXPECT_EQ(through.hit.Ng_z, 3);
  EXPECT_FLOAT_EQ(through.ray.tfar, 4.75f);
  EXPECT_EQ(through.ray.org_z, 5);
  EXPECT_TRUE(scene.occluded(second, down, 0, ~4u));
  EXPECT_EQ(scene.closest(first, down, 0, 0).hit.geomID, kNone);
}

TEST(Embree, InstancesAndMovingThingsStandWhereTheyAreAtATime) {
  Device device;
  Scene inner(device), scene(device);
  inner.add(square(device, 0, 1));
  rtcCommitScene(inner);
  const RTCGeometry instance = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(instance, inner);
  rtcSetGeometryTimeStepCount(instance, 2);
  rtcSetGeometryMask(instance, ~0u);
  for (unsigned step = 0; step < 2; ++step) {
    const float map[12] = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, step == 0 ? 10.0f : 20.0f};
    rtcSetGeometryTransform(instance, step, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, map);
  }
  scene.add(square(device, 0));
  const unsigned number = scene.add(instance);
  rtcCommitScene(scene);
  ASSERT_EQ(device.error(), RTC_ERROR_NONE);
  for (const float time : {0.0f, 0.25f, 0.5f, 1.0f}) {
    const RTCRayHit r = scene.closest({1.5f, 1, 100}, {0, 0, -1}, time);
    EXPECT_EQ(r.hit.geomID, 0u);
    EXPECT_EQ(r.hit.instID[0], number);
    EXPECT_FLOAT_EQ(r.ray.tfar, 100 - (10 + 10 * time + 2 * time));
    EXPECT_TRUE(scene.occluded({1.5f, 1, 100}, {0, 0, -1}, time));
    float map[16];
    rtcGetGeometryTransform(rtcGetGeometry(scene, number), time, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, map);
    EXPECT_FLOAT_EQ(map[14], 10 + 10 * time);
    EXPECT_EQ(map[15], 1);
  }
  EXPECT_EQ(scene.closest({0.5f, 0.25f, 5}, {0, 0, -1}).hit.instID[0], kNone);
}

TEST(Embree, ChangesCountAfterCommits) {
  Device device;
  for (const RTCSceneFlags flags : {RTC_SCENE_FLAG_NONE, RTC_SCENE_FLAG_DYNAMIC})
    for (const RTCBuildQuality quality : {RTC_BUILD_QUALITY_LOW, RTC_BUILD_QUALITY_REFIT}) {
      Scene scene(device);
      rtcSetSceneFlags(scene, flags);
      const RTCGeometry first = square(device, 1);
      rtcSetGeometryBuildQuality(first, quality);
      rtcRetainGeometry(first);
      scene.add(first), scene.add(square(device, 0));
      rtcCommitScene(scene);
      const Vec3f o{0.25f, 0.5f, 5}, d{0, 0, -1};
      EXPECT_FLOAT_EQ(scene.closest(o, d).ray.tfar, 4);
      auto* const v = static_cast<float*>(rtcGetGeometryBufferData(first, RTC_BUFFER_TYPE_VERTEX, 0));
      for (int i = 0; i < 4; ++i) v[3 * i + 2] = 2;
      rtcUpdateGeometryBuffer(first, RTC_BUFFER_TYPE_VERTEX, 0);
      rtcCommitScene(scene);
      EXPECT_EQ(device.error(), RTC_ERROR_INVALID_OPERATION) << "the geometry was not committed";
      rtcCommitGeometry(first), rtcCommitScene(scene);
      EXPECT_FLOAT_EQ(scene.closest(o, d).ray.tfar, 3);
      RTCBounds b;
      rtcGetSceneBounds(scene, &b);
      EXPECT_EQ(b.upper_z, 2);
      rtcDisableGeometry(first), rtcCommitScene(scene);
      EXPECT_EQ(scene.closest(o, d).hit.geomID, 1u);
      rtcEnableGeometry(first), rtcCommitScene(scene);
      EXPECT_EQ(scene.closest(o, d).hit.geomID, 0u);
      rtcDetachGeometry(scene, 0), rtcCommitScene(scene);
      EXPECT_FLOAT_EQ(scene.closest(o, d).ray.tfar, 5);
      EXPECT_EQ(scene.closest(o, d).hit.geomID, 1u);
      rtcReleaseGeometry(first);
      EXPECT_EQ(device.error(), RTC_ERROR_NONE) << device.message;
    }
}

// ---- Wrong use.

TEST(Embree, WrongUseIsToldApart) {
  Device device;
  const RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  float numbers[64] = {};
  const auto expect = [&](RTCError error) { EXPECT_EQ(device.error(), error) << device.message; };
  rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, numbers, 1, 12, 4);
  expect(RTC_ERROR_INVALID_OPERATION);
  rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, numbers, 0, 16, 4);
  expect(RTC_ERROR_INVALID_OPERATION);
  rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 1, RTC_FORMAT_FLOAT3, numbers, 0, 12, 4);
  expect(RTC_ERROR_INVALID_ARGUMENT);
  rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_GRID, 0, RTC_FORMAT_GRID, numbers, 0, 12, 4);
  expect(RTC_ERROR_INVALID_ARGUMENT);
  const RTCBuffer buffer = rtcNewBuffer(device, 100);
  rtcSetGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, buffer, 0, 12, 9);
  expect(RTC_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(device.message.find("do not fit into a buffer of 100"), std::string::npos) << device.message;
  rtcSetGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, buffer, 0, 12, 8);
  expect(RTC_ERROR_NONE);
  rtcReleaseBuffer(buffer);
  rtcSetGeometryTimeStepCount(g, 130);
  expect(RTC_ERROR_INVALID_ARGUMENT);
  rtcSetGeometryUserPrimitiveCount(g, 1);
  expect(RTC_ERROR_INVALID_OPERATION);
  Scene scene(device);
  RTCBounds bounds;
  rtcGetSceneBounds(scene, &bounds);
  expect(RTC_ERROR_INVALID_OPERATION);
  rtcGetGeometry(scene, 3);
  expect(RTC_ERROR_INVALID_ARGUMENT);
  rtcAttachGeometryByID(scene, g, 5);
  rtcAttachGeometryByID(scene, g, 5);
  expect(RTC_ERROR_INVALID_OPERATION);
  rtcReleaseGeometry(g);
  rtcDetachGeometry(scene, 5);
  expect(RTC_ERROR_NONE);
  // Now the handle is dead.
  rtcCommitGeometry(g);
  EXPECT_EQ(rtcGetDeviceError(nullptr), RTC_ERROR_INVALID_ARGUMENT);
  rtcCommitScene(nullptr);
  EXPECT_EQ(rtcGetDeviceError(nullptr), RTC_ERROR_INVALID_ARGUMENT);
  expect(RTC_ERROR_NONE);
  const RTCGeometry refused = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SUBDIVISION);
  EXPECT_NE(device.message.find("subdivision"), std::string::npos);
  expect(RTC_ERROR_INVALID_OPERATION);
  rtcSetGeometryTessellationRate(refused, 4);
  scene.add(refused);
  rtcCommitScene(scene);
  expect(RTC_ERROR_NONE);
}

TEST(Embree, TrianglesThatAreOutOfRangeOrNotFiniteAreNotThere) {
  Device device;
  Scene scene(device);
  const RTCGeometry g = square(device, 0);
  auto* const i = static_cast<unsigned*>(rtcGetGeometryBufferData(g, RTC_BUFFER_TYPE_INDEX, 0));
  i[5] = 4000000000u;
  scene.add(g);
  const RTCGeometry broken = square(device, 1);
  static_cast<float*>(rtcGetGeometryBufferData(broken, RTC_BUFFER_TYPE_VERTEX, 0))[0] =
      std::numeric_limits<float>::quiet_NaN();
  scene.add(broken);
  rtcCommitScene(scene);
  EXPECT_EQ(device.error(), RTC_ERROR_NONE) << device.message;
  EXPECT_EQ(scene.closest({0.5f, -0.5f, 5}, {0, 0, -1}).hit.geomID, 0u);
  EXPECT_EQ(scene.closest({-0.5f, 0.5f, 5}, {0, 0, -1}).hit.geomID, kNone);
}

TEST(Embree, MonitorsMayForbidMemoryAndTime) {
  Device device;
  static std::atomic<std::ptrdiff_t> used;
  static std::atomic<bool> allow;
  used = 0, allow = true;
  rtcSetDeviceMemoryMonitorFunction(
      device,
      [](void*, ssize_t bytes, bool) {
        if (bytes > 0 && !allow) return false;
        used += bytes;
        return true;
      },
      nullptr);
  {
    Scene scene(device);
    scene.add(square(device, 0));
    rtcCommitScene(scene);
    EXPECT_GT(used, 0);
    allow = false;
    const RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    EXPECT_EQ(rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, 4), nullptr);
    EXPECT_EQ(device.error(), RTC_ERROR_OUT_OF_MEMORY);
    rtcReleaseGeometry(g);
    rtcSetSceneProgressMonitorFunction(
        scene, [](void*, double) { return false; }, nullptr);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_LOW);
    rtcCommitScene(scene);
    EXPECT_EQ(device.error(), RTC_ERROR_CANCELLED);
  }
  EXPECT_EQ(used, 0);
}

TEST(Embree, ThreadsCommitTogetherAndHaveErrorsOfTheirOwn) {
  Device device;
  Scene scene(device);
  for (int i = 0; i < 50; ++i) scene.add(square(device, static_cast<float>(i)));
  std::vector<std::thread> threads;
  std::atomic<int> right = 0;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      rtcJoinCommitScene(scene);
      right += scene.closest({0.5f, 0.25f, 100}, {0, 0, -1}).hit.geomID == 49;
      if (t == 0) rtcGetGeometry(scene, 1000);
      right += rtcGetDeviceError(device) == (t == 0 ? RTC_ERROR_INVALID_ARGUMENT : RTC_ERROR_NONE);
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(right, 8);
  EXPECT_EQ(device.error(), RTC_ERROR_NONE);
}

/// What a callback writes as the end of its ray, if it is no NaN; it always names its geometry.
float written = 0;

TEST(Embree, HitsOfCallbacksCountWhereverTheyAre) {
  Device device;
  Scene scene(device);
  const RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(g, 1);
  rtcSetGeometryMask(g, ~0u);
  rtcSetGeometryBoundsFunction(
      g, [](const RTCBoundsFunctionArguments* a) { *a->bounds_o = {-2, -2, -2, 0, 2, 2, 2, 0}; }, nullptr);
  rtcSetGeometryIntersectFunction(g, [](const RTCIntersectFunctionNArguments* a) {
    if (!std::isnan(written)) RTCRayN_tfar(RTCRayHitN_RayN(a->rayhit, a->N), a->N, 0) = written;
    RTCHitN* const hit = RTCRayHitN_HitN(a->rayhit, a->N);
    RTCHitN_geomID(hit, a->N, 0) = a->geomID, RTCHitN_primID(hit, a->N, 0) = a->primID;
  });
  scene.add(g);
  rtcCommitScene(scene);
  // On the surface where the ray begins, behind its origin, without an end, and as it was.
  for (const float t : {1.0f, 0.0f, -1.0f, kInf, std::numeric_limits<float>::quiet_NaN()}) {
    written = t;
    const RTCRayHit r = scene.closest({0, 0, 0}, {0, 0, 1});
    EXPECT_EQ(r.hit.geomID, 0u) << t;
    EXPECT_EQ(r.ray.tfar, std::isnan(t) ? kInf : t);
  }
}

TEST(Embree, ThreadsTraceAndCommitSideBySide) {
  Device device;
  Scene shared(device), growing(device);
  const auto reject_even = [](const RTCFilterFunctionNArguments* a) {
    if (RTCHitN_geomID(a->hit, a->N, 0) % 2 == 0) a->valid[0] = 0;
  };
  for (int i = 0; i < 40; ++i) {
    const RTCGeometry g = square(device, static_cast<float>(i), i % 3 == 0 ? static_cast<float>(i) : NAN);
    rtcSetGeometryIntersectFilterFunction(g, reject_even);
    shared.add(g);
  }
  rtcCommitScene(shared);
  std::atomic<int> right = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      Scene own(device);
      for (int i = 0; i < 25; ++i) {
        // Rejected hits, in one scene of all threads.
        right += shared.closest({0.5f, 0.25f, 100}, {0, 0, -1}, 0.5f).hit.geomID == 39;
        right += shared.occluded({0.5f, 0.25f, 100}, {0, 0, -1});
        // A scene of the thread's own, of the same device.
        own.add(square(device, static_cast<float>(i)));
        rtcCommitScene(own);
        right += own.closest({0.5f, 0.25f, 100}, {0, 0, -1}).hit.geomID == static_cast<unsigned>(i);
        // Geometries found while others are attached.
        const unsigned number = growing.add(square(device, static_cast<float>(t)));
        right += rtcGetGeometryThreadSafe(growing, number) != nullptr;
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(right, 4 * 25 * 4);
  EXPECT_EQ(device.error(), RTC_ERROR_NONE);
}

}  // namespace
}  // namespace oktett::embree_test
