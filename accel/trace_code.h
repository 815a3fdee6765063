#pragma once
/// \file The queries of accel/accel.h as they are compiled for each instruction set, in accel/isa.

#include "accel/accel.h"
#include "accel/hit_list.h"
#include "accel/hit_sink.h"
#include "accel/trace_mode.h"
#include "core/isa.h"

namespace oktett {

struct TraceCode {
  Hit (*closest_hit_one)(const Accel&, const Ray&);
  bool (*any_hit_one)(const Accel&, const Ray&);
  void (*closest_hit)(const Accel&, const RaySpan&, const HitSink<Query::closest>&, TraceMode);
  void (*any_hit)(const Accel&, const RaySpan&, const HitSink<Query::any>&, TraceMode);
  void (*all_hits_one)(const Accel&, const Ray&, HitList&);
  void (*all_hits)(const Accel&, const RaySpan&, RayHitList&);
};

template <class A>
const TraceCode& trace_code();

/// Throws Error if this build holds no code for the set.
const TraceCode& trace_code(Isa isa);

}  // namespace oktett
