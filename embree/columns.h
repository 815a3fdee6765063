#pragma once
/// \file Rays and hits in columns: number i of N.

#include "embree/version.h"

namespace oktett::embree {

inline void load(const RTCRayN* from, unsigned n, unsigned i, RTCRay& to) {
  auto* const rays = const_cast<RTCRayN*>(from);
  to.org_x = RTCRayN_org_x(rays, n, i), to.org_y = RTCRayN_org_y(rays, n, i);
  to.org_z = RTCRayN_org_z(rays, n, i), to.tnear = RTCRayN_tnear(rays, n, i);
  to.dir_x = RTCRayN_dir_x(rays, n, i), to.dir_y = RTCRayN_dir_y(rays, n, i);
  to.dir_z = RTCRayN_dir_z(rays, n, i), to.time = RTCRayN_time(rays, n, i);
  to.tfar = RTCRayN_tfar(rays, n, i), to.mask = RTCRayN_mask(rays, n, i);
  to.id = RTCRayN_id(rays, n, i), to.flags = RTCRayN_flags(rays, n, i);
}

inline void store(const RTCRay& from, RTCRayN* rays, unsigned n, unsigned i) {
  RTCRayN_org_x(rays, n, i) = from.org_x, RTCRayN_org_y(rays, n, i) = from.org_y;
  RTCRayN_org_z(rays, n, i) = from.org_z, RTCRayN_tnear(rays, n, i) = from.tnear;
  RTCRayN_dir_x(rays, n, i) = from.dir_x, RTCRayN_dir_y(rays, n, i) = from.dir_y;
  RTCRayN_dir_z(rays, n, i) = from.dir_z, RTCRayN_time(rays, n, i) = from.time;
  RTCRayN_tfar(rays, n, i) = from.tfar, RTCRayN_mask(rays, n, i) = from.mask;
  RTCRayN_id(rays, n, i) = from.id, RTCRayN_flags(rays, n, i) = from.flags;
}

inline void load(const RTCHitN* from, unsigned n, unsigned i, RTCHit& to) {
  auto* const hits = const_cast<RTCHitN*>(from);
  to.Ng_x = RTCHitN_Ng_x(hits, n, i), to.Ng_y = RTCHitN_Ng_y(hits, n, i), to.Ng_z = RTCHitN_Ng_z(hits, n, i);
  to.u = RTCHitN_u(hits, n, i), to.v = RTCHitN_v(hits, n, i);
  to.primID = RTCHitN_primID(hits, n, i), to.geomID = RTCHitN_geomID(hits, n, i);
  for (unsigned level = 0; level < RTC_MAX_INSTANCE_LEVEL_COUNT; ++level) {
    to.instID[level] = RTCHitN_instID(hits, n, i, level);
#if defined(RTC_GEOMETRY_INSTANCE_ARRAY)
    to.instPrimID[level] = RTCHitN_instPrimID(hits, n, i, level);
#endif
  }
}

inline void store(const RTCHit& from, RTCHitN* hits, unsigned n, unsigned i) {
  RTCHitN_Ng_x(hits, n, i) = from.Ng_x, RTCHitN_Ng_y(hits, n, i) = from.Ng_y;
  RTCHitN_Ng_z(hits, n, i) = from.Ng_z;
  RTCHitN_u(hits, n, i) = from.u, RTCHitN_v(hits, n, i) = from.v;
  RTCHitN_primID(hits, n, i) = from.primID, RTCHitN_geomID(hits, n, i) = from.geomID;
  for (unsigned level = 0; level < RTC_MAX_INSTANCE_LEVEL_COUNT; ++level) {
    RTCHitN_instID(hits, n, i, level) = from.instID[level];
#if defined(RTC_GEOMETRY_INSTANCE_ARRAY)
    RTCHitN_instPrimID(hits, n, i, level) = from.instPrimID[level];
#endif
  }
}

}  // namespace oktett::embree
