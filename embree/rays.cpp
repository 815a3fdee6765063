/// \file Rays: one at a time, in packets and in streams.

#include <algorithm>
#include <limits>
#include <span>

#include "embree/callbacks.h"
#include "embree/columns.h"
#include "embree/scene.h"

namespace oktett::embree {

namespace {

/// Settings of the rays of one call.
struct Settings {
  QueryContext* context = nullptr;
  RTCFilterFunctionN filter = nullptr;
  bool filter_all = true;
  RTCIntersectFunctionN intersect = nullptr;
  RTCOccludedFunctionN occluded = nullptr;
};

/// A ray of the program. The range begins behind tnear, where Embree's begins with it; places behind the
/// origin are never hit.
Ray to_ray(const RTCRay& r) {
  return {{r.org_x, r.org_y, r.org_z}, r.tnear < 0 ? 0.0f : r.tnear, {r.dir_x, r.dir_y, r.dir_z}, r.tfar};
}

/// Traces rays of one call through one scene.
class Call {
 public:
  Call(const Scene& scene, const Settings& settings)
      : traced_(*scene.to_trace().scene),
        is_plain_(oktett::needs_no_contexts(traced_)),
        isa_(scene.device->isa()),
        settings_(settings) {
    if (settings_.context == nullptr) {
#if OKTETT_EMBREE == 4
      rtcInitRayQueryContext(&own_context_);
#else
      rtcInitIntersectContext(&own_context_);
#endif
      settings_.context = &own_context_;
    }
  }
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

  /// Whether the rays alone say what they hit.
  bool needs_no_contexts() const { return settings_.filter == nullptr && oktett::needs_no_contexts(traced_); }

  void closest(RTCRayHit& rayhit, unsigned packet = 1, unsigned lane = 0) {
    RTCRay& ray = rayhit.ray;
    if (!(ray.tnear <= ray.tfar)) return;
    if (needs_no_contexts()) {
      if (ray.mask != 0) keep(closest_hit(traced_, to_ray(ray), {}, isa_), rayhit);
      return;
    }
    RayQuery query = query_for(ray, &rayhit);
    query.packet = packet, query.lane = lane;
    keep(closest_hit(traced_, to_ray(ray), context_for(ray, query), isa_), rayhit);
  }

  void any(RTCRay& ray, unsigned packet = 1, unsigned lane = 0) {
    if (!(ray.tnear <= ray.tfar)) return;
    if (needs_no_contexts()) {
      if (ray.mask != 0) keep(any_hit(traced_, to_ray(ray), {}, isa_), ray);
      return;
    }
    RayQuery query = query_for(ray, nullptr);
    query.packet = packet, query.lane = lane;
    keep(any_hit(traced_, to_ray(ray), context_for(ray, query), isa_), ray);
  }

  /// Rays side by side. Those of a packet of `packet` have the numbers `lanes` in it.
  void closest(std::span<RTCRayHit> rays, unsigned packet = 1, const unsigned* lanes = nullptr) {
    if (rays.size() <= kMostPacket) return closest<kMostPacket>(rays, packet, lanes);
    for (std::size_t begin = 0; begin < rays.size(); begin += kBatch)
      closest<kBatch>(rays.subspan(begin, std::min(kBatch, rays.size() - begin)), 1, nullptr);
  }

  void any(std::span<RTCRay> rays, unsigned packet = 1, const unsigned* lanes = nullptr) {
    if (rays.size() <= kMostPacket) return any<kMostPacket>(rays, packet, lanes);
    for (std::size_t begin = 0; begin < rays.size(); begin += kBatch)
      any<kBatch>(rays.subspan(begin, std::min(kBatch, rays.size() - begin)), 1, nullptr);
  }

  /// `n` rays in columns, at most kMostPacket, where needs_no_contexts(); those whose `valid` is -1, or all
  /// if there is none.
  void closest_columns(const int* valid, RTCRayHitN* rayhits, unsigned n) const {
    const Columns columns(valid, RTCRayHitN_RayN(rayhits, n), n);
    SceneHit found[kMostPacket];
    closest_hit(traced_, columns.rays(), std::span(found, n), isa_);
    RTCHitN* const hits = RTCRayHitN_HitN(rayhits, n);
    for (unsigned i = 0; i < n; ++i) {
      if (!found[i].valid()) continue;
      RTCRayN_tfar(RTCRayHitN_RayN(rayhits, n), n, i) = found[i].t;
      RTCHit hit;
      set(found[i], hit);
      store(hit, hits, n, i);
    }
  }
  void any_columns(const int* valid, RTCRayN* rays, unsigned n) const {
    const Columns columns(valid, rays, n);
    std::uint8_t occluded[kMostPacket];
    any_hit(traced_, columns.rays(), std::span(occluded, n), isa_);
    for (unsigned i = 0; i < n; ++i)
      if (occluded[i] != 0) RTCRayN_tfar(rays, n, i) = -std::numeric_limits<float>::infinity();
  }

  /// So many rays of a stream go side by side.
  static constexpr std::size_t kBatch = 64;

 private:
  /// The columns of a packet of the program, and where its rays begin and end.
  class Columns {
   public:
    Columns(const int* valid, RTCRayN* rays, unsigned n) {
      for (unsigned i = 0; i < n; ++i) {
        const float tnear = RTCRayN_tnear(rays, n, i), tfar = RTCRayN_tfar(rays, n, i);
        const bool is_traced =
            (valid == nullptr || valid[i] == -1) && tnear <= tfar && RTCRayN_mask(rays, n, i) != 0;
        tmin_[i] = tnear < 0 ? 0.0f : tnear, tmax_[i] = is_traced ? tfar : -1.0f;
      }
      rays_ = {{&RTCRayN_org_x(rays, n, 0), &RTCRayN_org_y(rays, n, 0), &RTCRayN_org_z(rays, n, 0)},
               {&RTCRayN_dir_x(rays, n, 0), &RTCRayN_dir_y(rays, n, 0), &RTCRayN_dir_z(rays, n, 0)},
               tmin_,
               tmax_,
               n};
    }
    Columns(const Columns&) = delete;
    Columns& operator=(const Columns&) = delete;
    const RaySpan& rays() const { return rays_; }

   private:
    float tmin_[kMostPacket], tmax_[kMostPacket];
    RaySpan rays_;
  };

  /// Up to N rays.
  template <std::size_t N>
  class Batch {
   public:
    void set(std::size_t i, const Call& call, RTCRay& ray, RTCRayHit* rayhit, unsigned packet,
             const unsigned* lanes) {
      queries_[i] = call.query_for(ray, rayhit);
      queries_[i].packet = packet, queries_[i].lane = packet > 1 ? lanes[i] : 0;
      contexts_[i] = call.context_for(ray, queries_[i]);
      rays_[i] = to_ray(ray);
      // The ray that hits nothing.
      if (!(ray.tnear <= ray.tfar)) rays_[i].tmax = -1;
    }
    std::span<const Ray> rays(std::size_t count) const { return {rays_, count}; }
    std::span<const RayContext> contexts(std::size_t count) const { return {contexts_, count}; }

   private:
    Ray rays_[N];
    RayContext contexts_[N];
    RayQuery queries_[N];
  };

  template <std::size_t N>
  void closest(std::span<RTCRayHit> rays, unsigned packet, const unsigned* lanes) {
    Batch<N> batch;
    SceneHit hits[N];
    const std::size_t count = rays.size();
    for (std::size_t i = 0; i < count; ++i) batch.set(i, *this, rays[i].ray, &rays[i], packet, lanes);
    closest_hit(traced_, batch.rays(count), batch.contexts(count), std::span(hits, count), isa_);
    for (std::size_t i = 0; i < count; ++i) keep(hits[i], rays[i]);
  }

  template <std::size_t N>
  void any(std::span<RTCRay> rays, unsigned packet, const unsigned* lanes) {
    Batch<N> batch;
    std::uint8_t occluded[N];
    const std::size_t count = rays.size();
    for (std::size_t i = 0; i < count; ++i) batch.set(i, *this, rays[i], nullptr, packet, lanes);
    any_hit(traced_, batch.rays(count), batch.contexts(count), std::span(occluded, count), isa_);
    for (std::size_t i = 0; i < count; ++i) keep(occluded[i] != 0, rays[i]);
  }

  static void keep(bool occluded, RTCRay& ray) {
    if (occluded) ray.tfar = -std::numeric_limits<float>::infinity();
  }

  void keep(const SceneHit& hit, RTCRayHit& rayhit) const {
    if (!hit.valid()) return;
    rayhit.ray.tfar = hit.t;
    set(hit, rayhit.hit);
  }

  void set(const SceneHit& hit, RTCHit& out) const {
    out.Ng_x = hit.normal.x, out.Ng_y = hit.normal.y, out.Ng_z = hit.normal.z;
    out.u = hit.u, out.v = hit.v;
    out.primID = hit.primitive, out.geomID = hit.geometry;
    std::copy_n(settings_.context->instID, RTC_MAX_INSTANCE_LEVEL_COUNT, out.instID);
#if defined(RTC_GEOMETRY_INSTANCE_ARRAY)
    std::copy_n(settings_.context->instPrimID, RTC_MAX_INSTANCE_LEVEL_COUNT, out.instPrimID);
#endif
    if (hit.chain.count > 0) set_instances(out, hit.chain, instance_count(*settings_.context));
  }

  RayQuery query_for(RTCRay& ray, RTCRayHit* rayhit) const {
    RayQuery query{&ray, rayhit, settings_.context};
    query.filter = settings_.filter, query.filter_all = settings_.filter_all;
    query.intersect = settings_.intersect, query.occluded = settings_.occluded;
    return query;
  }
  RayContext context_for(const RTCRay& ray, RayQuery& query) const {
    return {ray.time, ray.mask, query.filter != nullptr ? QueryFilter::instance() : nullptr, &query};
  }

  const TraceScene& traced_;
  const bool is_plain_;
  const Isa isa_;
  Settings settings_;
  QueryContext own_context_;
};

/// The size of packets in which functions of the program are called for `n` rays.
unsigned packet_of(unsigned n) { return n <= kMostPacket ? n : 1; }

/// `n` rays in columns; those whose `valid` is -1, or all if there is none.
void closest_columns(Call& call, const int* valid, RTCRayHitN* rayhits, unsigned n) {
  if (n <= kMostPacket && call.needs_no_contexts()) return call.closest_columns(valid, rayhits, n);
  RTCRayN* const rays = RTCRayHitN_RayN(rayhits, n);
  RTCHitN* const hits = RTCRayHitN_HitN(rayhits, n);
  RTCRayHit batch[kMostPacket];
  unsigned number[kMostPacket];
  for (unsigned next = 0; next < n;) {
    std::size_t count = 0;
    for (; next < n && count < kMostPacket; ++next) {
      if (valid != nullptr && valid[next] != -1) continue;
      load(rays, n, next, batch[count].ray), load(hits, n, next, batch[count].hit);
      number[count++] = next;
    }
    call.closest(std::span(batch, count), packet_of(n), number);
    for (std::size_t k = 0; k < count; ++k) {
      RTCRayN_tfar(rays, n, number[k]) = batch[k].ray.tfar;
      store(batch[k].hit, hits, n, number[k]);
    }
  }
}

void any_columns(Call& call, const int* valid, RTCRayN* rays, unsigned n) {
  if (n <= kMostPacket && call.needs_no_contexts()) return call.any_columns(valid, rays, n);
  RTCRay batch[kMostPacket];
  unsigned number[kMostPacket];
  for (unsigned next = 0; next < n;) {
    std::size_t count = 0;
    for (; next < n && count < kMostPacket; ++next) {
      if (valid != nullptr && valid[next] != -1) continue;
      load(rays, n, next, batch[count]);
      number[count++] = next;
    }
    call.any(std::span(batch, count), packet_of(n), number);
    for (std::size_t k = 0; k < count; ++k) RTCRayN_tfar(rays, n, number[k]) = batch[k].tfar;
  }
}

#if OKTETT_EMBREE == 3
using ClosestArguments = RTCIntersectContext;
using AnyArguments = RTCIntersectContext;

Settings settings_of(const Scene& scene, RTCIntersectContext* context) {
  Settings settings;
  settings.context = context;
  if (context != nullptr && (scene.flags & RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION) != 0)
    settings.filter = context->filter;
  return settings;
}
#else
using ClosestArguments = RTCIntersectArguments;
using AnyArguments = RTCOccludedArguments;

template <class Arguments>
Settings settings_of(const Scene&, Arguments* arguments) {
  Settings settings;
  if (arguments == nullptr) return settings;
  settings.context = arguments->context, settings.filter = arguments->filter;
  settings.filter_all = (arguments->flags & RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER) != 0;
  if constexpr (std::is_same_v<Arguments, RTCIntersectArguments>)
    settings.intersect = arguments->intersect;
  else
    settings.occluded = arguments->occluded;
  return settings;
}
#endif

/// Calls f(call) for a scene of the program, and reports its errors.
template <class Arguments, class Function>
void trace(RTCScene handle, Arguments* arguments, Function&& f) {
  guarded(device_of(handle), [&] {
    const Scene& scene = object_of(handle);
    Call call(scene, settings_of(scene, arguments));
    f(call);
  });
}

}  // namespace
}  // namespace oktett::embree

using namespace oktett::embree;

// Embree 4 has the arguments behind the rays.
#if OKTETT_EMBREE == 3
#define OKTETT_SIGNATURE(Arguments, Rays) RTCScene scene, Arguments *arguments, Rays *rays
#else
#define OKTETT_SIGNATURE(Arguments, Rays) RTCScene scene, Rays *rays, Arguments *arguments
#endif

RTC_API void rtcIntersect1(OKTETT_SIGNATURE(ClosestArguments, RTCRayHit)) {
  trace(scene, arguments, [&](Call& call) { call.closest(*rays); });
}

RTC_API void rtcOccluded1(OKTETT_SIGNATURE(AnyArguments, RTCRay)) {
  trace(scene, arguments, [&](Call& call) { call.any(*rays); });
}

#define OKTETT_PACKET(n)                                                                              \
  RTC_API void rtcIntersect##n(const int* valid, OKTETT_SIGNATURE(ClosestArguments, RTCRayHit##n)) {  \
    trace(scene, arguments,                                                                           \
          [&](Call& call) { closest_columns(call, valid, reinterpret_cast<RTCRayHitN*>(rays), n); }); \
  }                                                                                                   \
  RTC_API void rtcOccluded##n(const int* valid, OKTETT_SIGNATURE(AnyArguments, RTCRay##n)) {          \
    trace(scene, arguments,                                                                           \
          [&](Call& call) { any_columns(call, valid, reinterpret_cast<RTCRayN*>(rays), n); });        \
  }
OKTETT_PACKET(4)
OKTETT_PACKET(8)
OKTETT_PACKET(16)

#if OKTETT_EMBREE == 3

// ---- Streams.

template <class T>
static T* at(T* first, unsigned i, std::size_t stride) {
  return reinterpret_cast<T*>(reinterpret_cast<std::byte*>(first) + i * stride);
}

RTC_API void rtcIntersect1M(RTCScene scene, RTCIntersectContext* context, RTCRayHit* rays, unsigned count,
                            size_t stride) {
  trace(scene, context, [&](Call& call) {
    if (stride == sizeof(RTCRayHit)) return call.closest(std::span(rays, count));
    for (unsigned i = 0; i < count; ++i) call.closest(*at(rays, i, stride));
  });
}

RTC_API void rtcOccluded1M(RTCScene scene, RTCIntersectContext* context, RTCRay* rays, unsigned count,
                           size_t stride) {
  trace(scene, context, [&](Call& call) {
    if (stride == sizeof(RTCRay)) return call.any(std::span(rays, count));
    for (unsigned i = 0; i < count; ++i) call.any(*at(rays, i, stride));
  });
}

RTC_API void rtcIntersect1Mp(RTCScene scene, RTCIntersectContext* context, RTCRayHit** rays, unsigned count) {
  trace(scene, context, [&](Call& call) {
    for (unsigned i = 0; i < count; ++i) call.closest(*rays[i]);
  });
}

RTC_API void rtcOccluded1Mp(RTCScene scene, RTCIntersectContext* context, RTCRay** rays, unsigned count) {
  trace(scene, context, [&](Call& call) {
    for (unsigned i = 0; i < count; ++i) call.any(*rays[i]);
  });
}

RTC_API void rtcIntersectNM(RTCScene scene, RTCIntersectContext* context, RTCRayHitN* rays, unsigned n,
                            unsigned count, size_t stride) {
  trace(scene, context, [&](Call& call) {
    for (unsigned i = 0; i < count; ++i) closest_columns(call, nullptr, at(rays, i, stride), n);
  });
}

RTC_API void rtcOccludedNM(RTCScene scene, RTCIntersectContext* context, RTCRayN* rays, unsigned n,
                           unsigned count, size_t stride) {
  trace(scene, context, [&](Call& call) {
    for (unsigned i = 0; i < count; ++i) any_columns(call, nullptr, at(rays, i, stride), n);
  });
}

/// Ray i of columns of the program; those that may be left out are null.
static RTCRay ray_of(const RTCRayNp& rays, unsigned i) {
  RTCRay ray;
  ray.org_x = rays.org_x[i], ray.org_y = rays.org_y[i], ray.org_z = rays.org_z[i];
  ray.dir_x = rays.dir_x[i], ray.dir_y = rays.dir_y[i], ray.dir_z = rays.dir_z[i];
  ray.tnear = rays.tnear != nullptr ? rays.tnear[i] : 0, ray.tfar = rays.tfar[i];
  ray.time = rays.time != nullptr ? rays.time[i] : 0, ray.mask = rays.mask != nullptr ? rays.mask[i] : ~0u;
  ray.id = rays.id != nullptr ? rays.id[i] : i, ray.flags = rays.flags != nullptr ? rays.flags[i] : 0;
  return ray;
}

RTC_API void rtcIntersectNp(RTCScene scene, RTCIntersectContext* context, const RTCRayHitNp* rays,
                            unsigned count) {
  trace(scene, context, [&](Call& call) {
    for (unsigned i = 0; i < count; ++i) {
      RTCRayHit one;
      one.ray = ray_of(rays->ray, i);
      one.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      call.closest(one);
      if (one.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
      const RTCHitNp& out = rays->hit;
      const auto set = [i](auto* column, auto value) {
        if (column != nullptr) column[i] = value;
      };
      rays->ray.tfar[i] = one.ray.tfar;
      set(out.Ng_x, one.hit.Ng_x), set(out.Ng_y, one.hit.Ng_y), set(out.Ng_z, one.hit.Ng_z);
      set(out.u, one.hit.u), set(out.v, one.hit.v);
      set(out.primID, one.hit.primID), set(out.geomID, one.hit.geomID);
      for (unsigned level = 0; level < RTC_MAX_INSTANCE_LEVEL_COUNT; ++level)
        set(out.instID[level], one.hit.instID[level]);
    }
  });
}

RTC_API void rtcOccludedNp(RTCScene scene, RTCIntersectContext* context, const RTCRayNp* rays,
                           unsigned count) {
  trace(scene, context, [&](Call& call) {
    for (unsigned i = 0; i < count; ++i) {
      RTCRay one = ray_of(*rays, i);
      call.any(one);
      rays->tfar[i] = one.tfar;
    }
  });
}

#else

// ---- Rays that a user geometry sends on into another scene.

namespace oktett::embree {
namespace {

/// Sets the ray of a query to another one, and names one more instance, while it lives.
class Forwarded {
 public:
  Forwarded(RTCRay& ray, const RTCRay& inner, QueryContext& context, unsigned instance, unsigned index)
      : ray_(ray), before_(ray), context_(context), context_before_(context) {
    ray.org_x = inner.org_x, ray.org_y = inner.org_y, ray.org_z = inner.org_z;
    ray.dir_x = inner.dir_x, ray.dir_y = inner.dir_y, ray.dir_z = inner.dir_z;
    ray.tnear = inner.tnear;
    InstanceChain chain;
    chain.push(instance, index);
    set_instances(context, chain, instance_count(context_before_));
  }
  ~Forwarded() {
    const float tfar = ray_.tfar;
    ray_ = before_, ray_.tfar = tfar;
    context_ = context_before_;
  }
  Forwarded(const Forwarded&) = delete;
  Forwarded& operator=(const Forwarded&) = delete;

 private:
  RTCRay& ray_;
  const RTCRay before_;
  QueryContext& context_;
  const QueryContext context_before_;
};

Settings settings_of(const RayQuery& query) {
  return {query.context, query.filter, query.filter_all, query.intersect, query.occluded};
}

void forward_closest(const RTCIntersectFunctionNArguments* arguments, RTCScene handle, const RTCRay& ray,
                     unsigned instance, unsigned index) {
  guarded(device_of(handle), [&] {
    RayQuery& query = *static_cast<const IntersectArguments*>(arguments)->query;
    {
      Call call(object_of(handle), settings_of(query));
      const Forwarded forwarded(*query.ray, ray, *query.context, instance, index);
      call.closest(*query.rayhit, query.packet, query.lane);
    }
    if (arguments->N == 1) return;
    RTCRayN_tfar(RTCRayHitN_RayN(arguments->rayhit, arguments->N), arguments->N, query.lane) =
        query.ray->tfar;
    store(query.rayhit->hit, RTCRayHitN_HitN(arguments->rayhit, arguments->N), arguments->N, query.lane);
  });
}

void forward_any(const RTCOccludedFunctionNArguments* arguments, RTCScene handle, const RTCRay& ray,
                 unsigned instance, unsigned index) {
  guarded(device_of(handle), [&] {
    RayQuery& query = *static_cast<const OccludedArguments*>(arguments)->query;
    {
      Call call(object_of(handle), settings_of(query));
      const Forwarded forwarded(*query.ray, ray, *query.context, instance, index);
      call.any(*query.ray, query.packet, query.lane);
    }
    if (arguments->N > 1) RTCRayN_tfar(arguments->ray, arguments->N, query.lane) = query.ray->tfar;
  });
}

/// User geometries are asked with one ray at a time, which is the first of a packet.
template <class Rays>
RTCRay first_of(const int* valid, Rays* rays, unsigned n) {
  unsigned i = 0;
  while (i + 1 < n && valid[i] != -1) ++i;
  RTCRay ray;
  load(reinterpret_cast<const RTCRayN*>(rays), n, i, ray);
  return ray;
}

}  // namespace
}  // namespace oktett::embree

RTC_API void rtcForwardIntersect1(const RTCIntersectFunctionNArguments* arguments, RTCScene scene,
                                  RTCRay* ray, unsigned instance) {
  forward_closest(arguments, scene, *ray, instance, 0);
}
RTC_API void rtcForwardIntersect1Ex(const RTCIntersectFunctionNArguments* arguments, RTCScene scene,
                                    RTCRay* ray, unsigned instance, unsigned index) {
  forward_closest(arguments, scene, *ray, instance, index);
}
RTC_API void rtcForwardOccluded1(const RTCOccludedFunctionNArguments* arguments, RTCScene scene, RTCRay* ray,
                                 unsigned instance) {
  forward_any(arguments, scene, *ray, instance, 0);
}
RTC_API void rtcForwardOccluded1Ex(const RTCOccludedFunctionNArguments* arguments, RTCScene scene,
                                   RTCRay* ray, unsigned instance, unsigned index) {
  forward_any(arguments, scene, *ray, instance, index);
}

#define OKTETT_FORWARD(n)                                                                                    \
  RTC_API void rtcForwardIntersect##n(const int* valid, const RTCIntersectFunctionNArguments* arguments,     \
                                      RTCScene scene, RTCRay##n* rays, unsigned instance) {                  \
    forward_closest(arguments, scene, first_of(valid, rays, n), instance, 0);                                \
  }                                                                                                          \
  RTC_API void rtcForwardIntersect##n##Ex(const int* valid, const RTCIntersectFunctionNArguments* arguments, \
                                          RTCScene scene, RTCRay##n* rays, unsigned instance,                \
                                          unsigned index) {                                                  \
    forward_closest(arguments, scene, first_of(valid, rays, n), instance, index);                            \
  }                                                                                                          \
  RTC_API void rtcForwardOccluded##n(const int* valid, const RTCOccludedFunctionNArguments* arguments,       \
                                     RTCScene scene, RTCRay##n* rays, unsigned instance) {                   \
    forward_any(arguments, scene, first_of(valid, rays, n), instance, 0);                                    \
  }                                                                                                          \
  RTC_API void rtcForwardOccluded##n##Ex(const int* valid, const RTCOccludedFunctionNArguments* arguments,   \
                                         RTCScene scene, RTCRay##n* rays, unsigned instance,                 \
                                         unsigned index) {                                                   \
    forward_any(arguments, scene, first_of(valid, rays, n), instance, index);                                \
  }
OKTETT_FORWARD(4)
OKTETT_FORWARD(8)
OKTETT_FORWARD(16)

#endif
