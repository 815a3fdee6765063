/// \file Embree's builder of trees for the program's own use, which does not exist here.

#include "embree/device.h"

using namespace oktett::embree;

/// Reports that there is none.
static void no_builder(RTCDevice device) {
  guarded(device_of(device), [&] {
    object_of(device);
    fail(RTC_ERROR_INVALID_OPERATION, "Oktett builds no trees for the program's own use");
  });
}

RTC_API RTCBVH rtcNewBVH(RTCDevice device) {
  no_builder(device);
  return nullptr;
}
RTC_API void* rtcBuildBVH(const RTCBuildArguments*) {
  no_builder(nullptr);
  return nullptr;
}
RTC_API void* rtcThreadLocalAlloc(RTCThreadLocalAllocator, size_t, size_t) {
  no_builder(nullptr);
  return nullptr;
}
RTC_API void rtcRetainBVH(RTCBVH) { no_builder(nullptr); }
RTC_API void rtcReleaseBVH(RTCBVH) { no_builder(nullptr); }
/// Its header does not have it in all versions.
RTC_API void rtcMakeStaticBVH(RTCBVH) { no_builder(nullptr); }
