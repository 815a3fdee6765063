#pragma once
/// \file The queries over a batch of rays for one instruction set. Each is instantiated in a unit of its own.

#include "accel/accel.h"
#include "accel/hit_list.h"
#include "accel/hit_sink.h"
#include "accel/trace_mode.h"

namespace oktett {

/// What each ray hits. Without vector registers every ray goes alone, whatever the mode.
template <Query Q, class A>
void trace(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out, TraceMode mode);

/// The same for one ray. For Query::any only the hit's validity counts.
template <Query Q, class A>
Hit trace_one(const Accel& accel, const Ray& ray);

/// Appends every hit of one ray to `hits`, in no order.
template <class A>
void trace_all_hits(const Accel& accel, const Ray& ray, HitList& hits);

/// The same for a batch of rays.
template <class A>
void trace_all_hits(const Accel& accel, const RaySpan& rays, RayHitList& hits);

}  // namespace oktett
