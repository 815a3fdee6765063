#!/usr/bin/env bash
# Embree builds a tree anew although its geometry asks for a refit.
#
# One would guess: a geometry with RTC_BUILD_QUALITY_REFIT, whose vertices move and whose triangles stay, is refitted by the next
# commit; or at least in a scene with RTC_SCENE_FLAG_DYNAMIC, whose description says that it is for frequent changes.
# What happens: Embree 3.13.5 and 4.3.3 refit only if the scene has that flag and RTC_BUILD_QUALITY_LOW as well. With one of the two, or with
# neither, every commit takes as long as the first one, about 17 times as long as a refit here; no error is reported.
# Why a user of a ray tracer meets it: cloth, skins and waves move every frame. The hits are right, so that only a clock tells.
#
# Needs Debian 12, g++ and the network. Debian 12: libembree-dev 3.13.5+dfsg-2. Debian 13: libembree-dev 4.3.3+dfsg-1. About a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"

cat >refit.cpp <<'CPP'
#if EMBREE == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <vector>

const int n = 400;

// A square of waves, in frame `frame`.
static void wave(float* v, int frame) {
  for (int i = 0; i < n * n; ++i) v[3 * i] = i % n, v[3 * i + 1] = i / n, v[3 * i + 2] = std::sin(.1f * i + frame);
}

static double commit(RTCScene scene) {
  const auto begin = std::chrono::steady_clock::now();
  rtcCommitScene(scene);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

static void try_scene(RTCDevice device, RTCSceneFlags flags, RTCBuildQuality quality) {
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, flags);
  rtcSetSceneBuildQuality(scene, quality);
  RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryBuildQuality(mesh, RTC_BUILD_QUALITY_REFIT);
  auto* v = static_cast<float*>(rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, n * n));
  wave(v, 0);
  auto* index =
      static_cast<unsigned*>(rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, 2 * (n - 1) * (n - 1)));
  for (unsigned y = 0; y + 1 < n; ++y)
    for (unsigned x = 0; x + 1 < n; ++x) {
      const unsigned k = y * n + x, corners[6] = {k, k + 1, k + n, k + 1, k + n + 1, k + n};
      index = std::copy(corners, corners + 6, index);
    }
  rtcCommitGeometry(mesh);
  rtcAttachGeometry(scene, mesh);
  const double first = commit(scene);
  std::vector<double> later;
  for (int frame = 1; frame < 8; ++frame) {
    wave(v, frame);
    rtcUpdateGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(mesh);
    later.push_back(commit(scene));
  }
  std::sort(later.begin(), later.end());
  std::printf("%s, error %d\n", later[3] < first / 4 ? "a fraction of the first commit" : "as long as the first commit",
              rtcGetDeviceError(device));
}

int main() {
  RTCDevice device = rtcNewDevice("threads=1");
  try_scene(device, RTC_SCENE_FLAG_NONE, RTC_BUILD_QUALITY_MEDIUM);
  try_scene(device, RTC_SCENE_FLAG_DYNAMIC, RTC_BUILD_QUALITY_MEDIUM);
  try_scene(device, RTC_SCENE_FLAG_NONE, RTC_BUILD_QUALITY_LOW);
  try_scene(device, RTC_SCENE_FLAG_DYNAMIC, RTC_BUILD_QUALITY_LOW);
}
CPP

# try_embree SUITE VERSION NUMBER
try_embree() {
  unpack "$1" amd64 "libembree-dev=$2"
  g++ -O2 "-DEMBREE=$3" -I"$root/usr/include" refit.cpp -o "refit$3" -L"$libraries" "-lembree$3" \
    -Wl,-rpath-link,"$libraries" -Wl,--allow-shlib-undefined
  run "$work/refit$3" >out
  guess "a commit after vertices moved takes a fraction of the first one, in each kind of scene"
  seen "Embree $3, scene without flags, medium quality" "as long as the first commit, error 0" "$(sed -n 1p out)"
  seen "Embree $3, dynamic scene, medium quality" "as long as the first commit, error 0" "$(sed -n 2p out)"
  seen "Embree $3, scene without flags, low quality" "as long as the first commit, error 0" "$(sed -n 3p out)"
  seen "Embree $3, dynamic scene, low quality" "a fraction of the first commit, error 0" "$(sed -n 4p out)"
}
try_embree bookworm 3.13.5+dfsg-2 3
try_embree trixie 4.3.3+dfsg-1 4
finish
