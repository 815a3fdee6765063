#!/usr/bin/env bash
# A box that only the program knows takes more of Embree's memory than a triangle.
#
# One would guess: of a user primitive Embree keeps two numbers, those of its geometry and itself, and of a triangle nine coordinates besides;
# so a tree of half a million user primitives is smaller than one of as many triangles.
# What happens: by Embree's own memory monitor, one thread, a user primitive takes 132 bytes, a triangle 77 and a sphere point 30, in compact
# scenes 77, 42 and 21. With two threads and a million of each the first two were 94 and 77.
# Why a user of a ray tracer meets it: who replaces millions of triangles by exact shapes of his own to save memory pays more for the tree.
#
# Needs Debian 12, g++ and the network. Debian 12: libembree-dev 3.13.5+dfsg-2. Debian 13: libembree-dev 4.3.3+dfsg-1. About a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"

cat >bytes.cpp <<'CPP'
#if EMBREE == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <cmath>
#include <cstdio>
#include <initializer_list>

const unsigned n = 700, count = n * n;

static ssize_t held = 0;
static bool monitor(void*, ssize_t bytes, bool) {
  held += bytes;
  return true;
}

// The unit box at column x of row y of a field.
static void bounds(const RTCBoundsFunctionArguments* a) {
  const float x = a->primID % n, y = a->primID / n;
  *a->bounds_o = {x, y, 0, 0, x + 1, y + 1, 1, 0};
}

// Bytes of the tree over `count` primitives of a kind, each.
static double tree(RTCDevice device, RTCGeometryType type, RTCSceneFlags flags) {
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, flags);
  RTCGeometry g = rtcNewGeometry(device, type);
  if (type == RTC_GEOMETRY_TYPE_USER) {
    rtcSetGeometryUserPrimitiveCount(g, count);
    rtcSetGeometryBoundsFunction(g, bounds, nullptr);
  } else {
    const bool triangles = type == RTC_GEOMETRY_TYPE_TRIANGLE;
    const size_t size = triangles ? 3 : 4;
    auto* v = static_cast<float*>(rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, triangles ? RTC_FORMAT_FLOAT3 : RTC_FORMAT_FLOAT4,
                                                          4 * size, count + n + 1));
    for (unsigned i = 0; i < count + n + 1; ++i) {
      v[size * i] = i % n, v[size * i + 1] = i / n, v[size * i + 2] = std::sin(.1f * i);
      if (!triangles) v[4 * i + 3] = .3f;
    }
    if (triangles) {
      auto* index = static_cast<unsigned*>(rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, count));
      for (unsigned i = 0; i < count; ++i) index[3 * i] = i, index[3 * i + 1] = i + 1, index[3 * i + 2] = i + n;
    }
  }
  const ssize_t before = held;
  rtcCommitGeometry(g);
  rtcAttachGeometry(scene, g);
  rtcCommitScene(scene);
  const double bytes = double(held - before) / count;
  rtcReleaseGeometry(g);
  rtcReleaseScene(scene);
  return bytes;
}

int main() {
  RTCDevice device = rtcNewDevice("threads=1");
  rtcSetDeviceMemoryMonitorFunction(device, monitor, nullptr);
  const RTCGeometryType types[] = {RTC_GEOMETRY_TYPE_TRIANGLE, RTC_GEOMETRY_TYPE_USER, RTC_GEOMETRY_TYPE_SPHERE_POINT};
  double plain[3], compact[3];
  for (int k = 0; k < 3; ++k) {
    plain[k] = tree(device, types[k], RTC_SCENE_FLAG_NONE);
    compact[k] = tree(device, types[k], RTC_SCENE_FLAG_COMPACT);
    std::fprintf(stderr, "bytes per primitive %.1f, compact %.1f\n", plain[k], compact[k]);
  }
  for (const double* bytes : {plain, compact})
    std::printf("%s, %s\n", bytes[1] > 1.1 * bytes[0] ? "more than a triangle" : "not more than a triangle",
                bytes[1] > 2 * bytes[2] ? "more than two points" : "not more than two points");
}
CPP

# try_embree SUITE VERSION NUMBER
try_embree() {
  unpack "$1" amd64 "libembree-dev=$2"
  g++ -O2 "-DEMBREE=$3" -I"$root/usr/include" bytes.cpp -o "bytes$3" -L"$libraries" "-lembree$3" \
    -Wl,-rpath-link,"$libraries" -Wl,--allow-shlib-undefined
  run "$work/bytes$3" >out
  guess "a user primitive takes less memory than a triangle"
  seen "Embree $3, a user primitive takes" "more than a triangle, more than two points" "$(sed -n 1p out)"
  seen "Embree $3, in a compact scene" "more than a triangle, more than two points" "$(sed -n 2p out)"
}
try_embree bookworm 3.13.5+dfsg-2 3
try_embree trixie 4.3.3+dfsg-1 4
finish
