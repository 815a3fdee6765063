#pragma once
/// \file The interface that is implemented: that of Embree 3 or of Embree 4, as its headers state it. All of
/// this folder is compiled for one of them.

#define RTC_EXPORT_API
#if OKTETT_EMBREE == 3
#include <embree3/rtcore.h>
#else
#include <embree4/rtcore.h>
#endif

namespace oktett::embree {

#if OKTETT_EMBREE == 3
using QueryContext = RTCIntersectContext;
/// The mask of a geometry that was given none.
inline constexpr unsigned kDefaultMask = ~0u;
#else
using QueryContext = RTCRayQueryContext;
inline constexpr unsigned kDefaultMask = 1;
#endif

#if defined(RTC_GEOMETRY_INSTANCE_ARRAY)
inline constexpr bool kHasInstanceArrays = true;
#else
inline constexpr bool kHasInstanceArrays = false;
#endif

}  // namespace oktett::embree
