#pragma once
/// \file The functions of a program that judge hits and test user geometries.

#include "accel/trace_scene.h"
#include "embree/geometry.h"

namespace oktett::embree {

/// A ray of the program that is being traced. Functions of the program see it at the place where the program
/// has it, as it is there: in the space of the scene that it is in, ending at its nearest hit.
struct RayQuery {
  RTCRay* ray;
  RTCRayHit* rayhit;  ///< null if any hit will do
  QueryContext* context;
  RTCFilterFunctionN filter = nullptr;
  bool filter_all = true;                     ///< `filter` judges hits of all geometries
  RTCIntersectFunctionN intersect = nullptr;  ///< of user geometries that have none of their own
  RTCOccludedFunctionN occluded = nullptr;
  /// Functions are called for a packet of so many rays, of which this one alone is valid.
  unsigned packet = 1, lane = 0;
};

/// The largest packet.
inline constexpr unsigned kMostPacket = 16;

/// The query that a context belongs to.
inline RayQuery& query_of(const RayContext& context) { return *static_cast<RayQuery*>(context.user); }

/// The filter function of a geometry: `user` of hits is the Geometry.
class GeometryFilter final : public HitFilter {
 public:
  /// The one for closest_hit, or that for any_hit.
  static const HitFilter* instance(bool any);
  std::size_t judge(const Ray& ray, const RayContext& context, std::span<SceneHit> hits) const override;

 private:
  explicit GeometryFilter(bool any) : any_(any) {}
  const bool any_;
};

/// The filter function of a query.
class QueryFilter final : public HitFilter {
 public:
  static const HitFilter* instance();
  std::size_t judge(const Ray& ray, const RayContext& context, std::span<SceneHit> hits) const override;
};

/// A user geometry.
class UserCallbacks final : public UserShape {
 public:
  explicit UserCallbacks(const Geometry& geometry);
  std::uint32_t primitive_count() const override { return count_; }
  std::uint32_t key_count() const override { return keys_; }
  /// Embree takes over what a program writes: where a ray begins on its surface, t = tnear, or inside.
  bool may_leave_range() const override { return true; }
  Box bounds(std::uint32_t primitive, std::uint32_t key) const override;
  bool closest_hit(std::uint32_t primitive, const Ray& ray, const RayContext& context,
                   SceneHit& hit) const override;
  bool any_hit(std::uint32_t primitive, const Ray& ray, const RayContext& context,
               SceneHit& hit) const override;

 private:
  const Geometry& geometry_;
  const std::uint32_t count_, keys_;
};

/// What functions of user geometries are given; what they pass on to the filter functions is behind it.
struct IntersectArguments : RTCIntersectFunctionNArguments {
  const Geometry* geometry;
  RayQuery* query;
};
struct OccludedArguments : RTCOccludedFunctionNArguments {
  const Geometry* geometry;
  RayQuery* query;
};

/// Sets the numbers of instances in a context or a hit: those that a chain leads through, behind the first
/// `begin` ones.
template <class To>
void set_instances(To& to, const InstanceChain& chain, std::uint32_t begin = 0) {
  for (std::uint32_t level = begin; level < RTC_MAX_INSTANCE_LEVEL_COUNT; ++level) {
    const bool has = level - begin < chain.count;
    to.instID[level] = has ? chain.geometry[level - begin] : RTC_INVALID_GEOMETRY_ID;
#if defined(RTC_GEOMETRY_INSTANCE_ARRAY)
    to.instPrimID[level] = has ? chain.primitive[level - begin] : RTC_INVALID_GEOMETRY_ID;
#endif
  }
}

/// How many instances a context already leads through, where a program traces on from inside a user geometry.
std::uint32_t instance_count(const QueryContext& context);

}  // namespace oktett::embree
