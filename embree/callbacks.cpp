#include "embree/callbacks.h"

#include "embree/columns.h"

#include <algorithm>
#include <limits>

namespace oktett::embree {

std::uint32_t instance_count(const QueryContext& context) {
  std::uint32_t count = 0;
  while (count < RTC_MAX_INSTANCE_LEVEL_COUNT && context.instID[count] != RTC_INVALID_GEOMETRY_ID) ++count;
  return count;
}

namespace {

/// Shows the program's ray and context as they are at a place in a scene, while it lives. Outside of
/// instances no more than the end of the ray is another.
class Shown {
 public:
  Shown(RayQuery& query, const Ray& ray, const InstanceChain& chain)
      : query_(query), is_inside_(chain.count > 0) {
    RTCRay& shown = *query.ray;
    tfar_ = shown.tfar;
    if (is_inside_) {
      ray_ = shown, context_ = *query.context;
      shown.org_x = ray.origin.x, shown.org_y = ray.origin.y, shown.org_z = ray.origin.z;
      shown.dir_x = ray.direction.x, shown.dir_y = ray.direction.y, shown.dir_z = ray.direction.z;
      set_instances(*query.context, chain, instance_count(context_));
    }
    shown.tfar = ray.tmax;
  }
  ~Shown() {
    if (is_inside_) *query_.ray = ray_, *query_.context = context_;
    query_.ray->tfar = tfar_;
  }
  Shown(const Shown&) = delete;
  Shown& operator=(const Shown&) = delete;

 private:
  RayQuery& query_;
  const bool is_inside_;
  float tfar_;
  RTCRay ray_;            ///< as the program has it; set inside of instances
  QueryContext context_;  ///< likewise
};

/// The ray of a query and a hit as functions of the program are given them: themselves, or as one lane of a
/// packet in which nothing else is valid.
class Lane {
 public:
  Lane(RTCRay& ray, RTCHit* hit, unsigned packet, unsigned lane)
      : ray_(ray), hit_(hit), n_(packet), lane_(lane) {
    std::fill_n(valid_, n_, 0);
    valid_[lane_] = -1;
    if (n_ == 1) return;
    store(ray_, rays(), n_, lane_);
    if (hit_ != nullptr) store(*hit_, hits(), n_, lane_);
  }
  /// Takes over what the function has changed.
  void finish() {
    if (n_ == 1) return;
    load(rays(), n_, lane_, ray_);
    if (hit_ != nullptr) load(hits(), n_, lane_, *hit_);
  }

  int* valid() { return valid_; }
  bool is_valid() const { return valid_[lane_] == -1; }
  unsigned n() const { return n_; }
  RTCRayN* rays() {
    return n_ == 1 ? reinterpret_cast<RTCRayN*>(&ray_) : reinterpret_cast<RTCRayN*>(columns_);
  }
  RTCHitN* hits() {
    return n_ == 1 ? reinterpret_cast<RTCHitN*>(hit_)
                   : reinterpret_cast<RTCHitN*>(columns_ + n_ * sizeof(RTCRay));
  }
  /// Both; the hit is that of the RTCRayHit whose ray it is.
  RTCRayHitN* both() { return reinterpret_cast<RTCRayHitN*>(rays()); }

 private:
  static_assert(sizeof(RTCRay) == 48 && sizeof(RTCRayHit) == sizeof(RTCRay) + sizeof(RTCHit));

  RTCRay& ray_;
  RTCHit* const hit_;
  const unsigned n_, lane_;
  int valid_[kMostPacket];
  alignas(64) std::byte columns_[kMostPacket * sizeof(RTCRayHit)];
};

/// Whether a filter function lets a hit pass, which it may change.
bool passes(RTCFilterFunctionN filter, const Geometry& geometry, RayQuery& query, SceneHit& hit) {
  RTCHit shown;
  shown.Ng_x = hit.normal.x, shown.Ng_y = hit.normal.y, shown.Ng_z = hit.normal.z;
  shown.u = hit.u, shown.v = hit.v;
  shown.primID = hit.primitive, shown.geomID = hit.geometry;
  for (std::uint32_t level = 0; level < RTC_MAX_INSTANCE_LEVEL_COUNT; ++level) {
    shown.instID[level] = query.context->instID[level];
#if defined(RTC_GEOMETRY_INSTANCE_ARRAY)
    shown.instPrimID[level] = query.context->instPrimID[level];
#endif
  }
  query.ray->tfar = hit.t;
  Lane lane(*query.ray, &shown, query.packet, query.lane);
  RTCFilterFunctionNArguments arguments{lane.valid(), geometry.user, query.context,
                                        lane.rays(),  lane.hits(),   lane.n()};
  filter(&arguments);
  if (!lane.is_valid()) return false;
  lane.finish();
  hit.normal = {shown.Ng_x, shown.Ng_y, shown.Ng_z};
  hit.u = shown.u, hit.v = shown.v;
  hit.primitive = shown.primID, hit.geometry = shown.geomID;
  hit.t = std::min(hit.t, query.ray->tfar);
  return true;
}

/// The first hit that a filter function lets pass.
template <class FilterOf>
std::size_t first_passing(const Ray& ray, const RayContext& context, std::span<SceneHit> hits,
                          const FilterOf& filter_of) {
  RayQuery& query = query_of(context);
  const Shown shown(query, ray, hits[0].chain);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const auto& geometry = *static_cast<const Geometry*>(hits[i].user);
    const RTCFilterFunctionN filter = filter_of(query, geometry);
    if (filter == nullptr || passes(filter, geometry, query, hits[i])) return i;
  }
  return hits.size();
}

}  // namespace

const HitFilter* GeometryFilter::instance(bool any) {
  static const GeometryFilter closest_hit(false), any_hit(true);
  return any ? &any_hit : &closest_hit;
}

std::size_t GeometryFilter::judge(const Ray& ray, const RayContext& context, std::span<SceneHit> hits) const {
  return first_passing(ray, context, hits, [&](const RayQuery&, const Geometry& geometry) {
    return any_ ? geometry.any_filter : geometry.closest_filter;
  });
}

const HitFilter* QueryFilter::instance() {
  static const QueryFilter filter;
  return &filter;
}

std::size_t QueryFilter::judge(const Ray& ray, const RayContext& context, std::span<SceneHit> hits) const {
  return first_passing(ray, context, hits, [](const RayQuery& query, const Geometry& geometry) {
    // User geometries call filters themselves.
    const bool judged =
        geometry.type != RTC_GEOMETRY_TYPE_USER && (query.filter_all || geometry.takes_filter_of_query);
    return judged ? query.filter : nullptr;
  });
}

// ---- User geometries.

UserCallbacks::UserCallbacks(const Geometry& geometry)
    : geometry_(geometry),
      count_(geometry.bounds != nullptr ? geometry.user_primitives : 0),
      keys_(geometry.time_steps) {}

Box UserCallbacks::bounds(std::uint32_t primitive, std::uint32_t key) const {
  RTCBounds b{};
  const RTCBoundsFunctionArguments arguments{geometry_.user, primitive, key, &b};
  geometry_.bounds(&arguments);
  return {{b.lower_x, b.lower_y, b.lower_z}, {b.upper_x, b.upper_y, b.upper_z}};
}

bool UserCallbacks::closest_hit(std::uint32_t primitive, const Ray& ray, const RayContext& context,
                                SceneHit& hit) const {
  RayQuery& query = query_of(context);
  const RTCIntersectFunctionN intersect =
      geometry_.intersect != nullptr ? geometry_.intersect : query.intersect;
  if (intersect == nullptr) return false;
  const Shown shown(query, ray, hit.chain);
  RTCHit& out = query.rayhit->hit;
  const RTCHit before = out;
  out.geomID = RTC_INVALID_GEOMETRY_ID;
  Lane lane(*query.ray, &out, query.packet, query.lane);
  IntersectArguments arguments;
  static_cast<RTCIntersectFunctionNArguments&>(arguments) = {
      lane.valid(), geometry_.user, primitive, query.context, lane.both(), lane.n(), hit.geometry};
  arguments.geometry = &geometry_, arguments.query = &query;
  intersect(&arguments);
  lane.finish();
  const bool found = out.geomID != RTC_INVALID_GEOMETRY_ID;
  if (found) {
    hit.t = query.ray->tfar, hit.u = out.u, hit.v = out.v;
    hit.normal = {out.Ng_x, out.Ng_y, out.Ng_z};
    hit.geometry = out.geomID, hit.primitive = out.primID;
    // A program that traces on in another scene names its instances itself.
    const std::uint32_t own = instance_count(*query.context);
    for (std::uint32_t level = own; level < RTC_MAX_INSTANCE_LEVEL_COUNT; ++level)
      if (out.instID[level] != RTC_INVALID_GEOMETRY_ID && hit.chain.count < InstanceChain::kMost)
        hit.chain.push(out.instID[level], 0);
  }
  out = before;
  return found;
}

bool UserCallbacks::any_hit(std::uint32_t primitive, const Ray& ray, const RayContext& context,
                            SceneHit& hit) const {
  RayQuery& query = query_of(context);
  const RTCOccludedFunctionN occluded = geometry_.occluded != nullptr ? geometry_.occluded : query.occluded;
  if (occluded == nullptr) return false;
  const Shown shown(query, ray, hit.chain);
  Lane lane(*query.ray, nullptr, query.packet, query.lane);
  OccludedArguments arguments;
  static_cast<RTCOccludedFunctionNArguments&>(arguments) = {
      lane.valid(), geometry_.user, primitive, query.context, lane.rays(), lane.n(), hit.geometry};
  arguments.geometry = &geometry_, arguments.query = &query;
  occluded(&arguments);
  lane.finish();
  // Where on the ray it is is not told.
  hit.t = std::min(ray.tmax, std::numeric_limits<float>::max());
  return query.ray->tfar < 0;
}

namespace {

/// Lets the filters of a geometry and of the query judge a hit that a user geometry found.
template <class Arguments>
void filter_from_callback(const Arguments* arguments, const RTCFilterFunctionNArguments* filtered, bool any) {
  const Geometry& geometry = *arguments->geometry;
  const RTCFilterFunctionN own = any ? geometry.any_filter : geometry.closest_filter;
  if (own != nullptr) own(filtered);
  if (std::none_of(filtered->valid, filtered->valid + filtered->N, [](int valid) { return valid == -1; }))
    return;
  const RayQuery& query = *arguments->query;
  if (query.filter != nullptr && (query.filter_all || geometry.takes_filter_of_query)) query.filter(filtered);
}

}  // namespace
}  // namespace oktett::embree

using namespace oktett::embree;

#if OKTETT_EMBREE == 3
#define OKTETT_FILTER_CLOSEST rtcFilterIntersection
#define OKTETT_FILTER_ANY rtcFilterOcclusion
#else
#define OKTETT_FILTER_CLOSEST rtcInvokeIntersectFilterFromGeometry
#define OKTETT_FILTER_ANY rtcInvokeOccludedFilterFromGeometry
#endif

RTC_API void OKTETT_FILTER_CLOSEST(const RTCIntersectFunctionNArguments* arguments,
                                   const RTCFilterFunctionNArguments* filtered) {
  filter_from_callback(static_cast<const IntersectArguments*>(arguments), filtered, false);
}

RTC_API void OKTETT_FILTER_ANY(const RTCOccludedFunctionNArguments* arguments,
                               const RTCFilterFunctionNArguments* filtered) {
  filter_from_callback(static_cast<const OccludedArguments*>(arguments), filtered, true);
}
