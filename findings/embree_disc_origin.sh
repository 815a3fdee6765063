#!/usr/bin/env bash
# A ray that begins near a disc of Embree's passes through it.
#
# One would guess: RTC_GEOMETRY_TYPE_DISC_POINT is a disc that faces the ray, without thickness, so a ray meets it if its line comes as near
# to the centre as the radius and the nearest place lies ahead.
# What happens: Embree 3.13.5 and 4.3.3 let every ray pass that begins within the radius of the centre, in front of the disc, too. Discs with
# a normal (RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT) and spheres are met. The manual says nothing of it; no error is reported.
# Why a user of a ray tracer meets it: clouds of points are drawn as overlapping discs, where shadow rays and bounces begin inside of many
# neighbours' radii. Those do not shade them.
#
# Needs Debian 12, g++ and the network. Debian 12: libembree-dev 3.13.5+dfsg-2. Debian 13: libembree-dev 4.3.3+dfsg-1. About a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"

cat >disc.cpp <<'CPP'
#if EMBREE == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <cmath>
#include <cstdio>
#include <initializer_list>

// Rays that begin at several heights above the centre of a shape of radius 1 and look down.
static void look(RTCDevice device, RTCGeometryType type) {
  RTCScene scene = rtcNewScene(device);
  RTCGeometry g = rtcNewGeometry(device, type);
  rtcSetGeometryMask(g, ~0u);
  auto* v = static_cast<float*>(rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 16, 1));
  v[0] = v[1] = v[2] = 0, v[3] = 1;
  if (type == RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT) {
    auto* n = static_cast<float*>(rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_NORMAL, 0, RTC_FORMAT_FLOAT3, 12, 1));
    n[0] = n[1] = 0, n[2] = 1;
  }
  rtcCommitGeometry(g);
  rtcAttachGeometry(scene, g);
  rtcCommitScene(scene);
  for (float height : {2.0f, 1.1f, 0.9f, 0.5f}) {
    alignas(16) RTCRayHit r{};
    r.ray.org_z = height, r.ray.dir_z = -1, r.ray.tfar = INFINITY, r.ray.mask = ~0u;
    r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
#if EMBREE == 4
    rtcIntersect1(scene, &r);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, &r);
#endif
    std::printf("%s ", r.hit.geomID == 0 ? "hit" : "miss");
  }
  std::printf("error %d\n", rtcGetDeviceError(device));
}

int main() {
  RTCDevice device = rtcNewDevice("threads=1");
  look(device, RTC_GEOMETRY_TYPE_DISC_POINT);
  look(device, RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT);
  look(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
}
CPP

# try_embree SUITE VERSION NUMBER
try_embree() {
  unpack "$1" amd64 "libembree-dev=$2"
  g++ -O2 "-DEMBREE=$3" -I"$root/usr/include" disc.cpp -o "disc$3" -L"$libraries" "-lembree$3" \
    -Wl,-rpath-link,"$libraries" -Wl,--allow-shlib-undefined
  run "$work/disc$3" >out
  guess "rays from heights 2, 1.1, 0.9 and 0.5 meet a disc of radius 1 below them"
  seen "Embree $3, a disc that faces the ray" "hit hit miss miss error 0" "$(sed -n 1p out)"
  seen "Embree $3, a disc with a normal" "hit hit hit hit error 0" "$(sed -n 2p out)"
  seen "Embree $3, a sphere" "hit hit hit hit error 0" "$(sed -n 3p out)"
}
try_embree bookworm 3.13.5+dfsg-2 3
try_embree trixie 4.3.3+dfsg-1 4
finish
