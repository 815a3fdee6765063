/// \file Queries for the nearest point, which the program's functions find.

#include <algorithm>
#include <cmath>

#include "accel/time/near_primitives.h"
#include "embree/callbacks.h"
#include "embree/scene.h"

namespace oktett::embree {
namespace {

class PointQuery final : public NearVisitor {
 public:
  PointQuery(RTCPointQuery& query, RTCPointQueryContext& context, RTCPointQueryFunction function, void* user)
      : query_(query), context_(context), function_(function), user_(user), begin_(context.instStackSize) {
    if (begin_ > 0) {
      maps_.push_back(load(context.inst2world[begin_ - 1]));
      scale_ = scale_of(maps_.back().inverse());
    }
  }

  bool changed() const { return changed_; }

  float radius() const override { return query_.radius; }

  void visit(const SceneGeometry& scene_geometry, std::uint32_t primitive) override {
    const auto& geometry = *static_cast<const Geometry*>(scene_geometry.user);
    // As Embree's documentation has it, points and curves are left out.
    if (!geometry.is_mesh() && geometry.type != RTC_GEOMETRY_TYPE_USER) return;
    RTCPointQueryFunctionArguments arguments;
    arguments.query = &query_;
    arguments.userPtr = user_;
    arguments.primID = primitive, arguments.geomID = scene_geometry.number;
    arguments.context = &context_;
    arguments.similarityScale = static_cast<float>(scale_);
    if (geometry.point_query != nullptr) changed_ |= geometry.point_query(&arguments);
    if (function_ != nullptr) changed_ |= function_(&arguments);
  }

  bool enter(const SceneGeometry& instance, std::uint32_t index, const Affine& to_scene) override {
    const unsigned level = context_.instStackSize;
    if (level >= RTC_MAX_INSTANCE_LEVEL_COUNT) return false;
    maps_.push_back(maps_.empty() ? to_scene : maps_.back() * to_scene);
    context_.instID[level] = instance.number;
#if defined(RTC_GEOMETRY_INSTANCE_ARRAY)
    context_.instPrimID[level] = index;
#else
    static_cast<void>(index);
#endif
    write_transform(maps_.back(), RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, context_.inst2world[level]);
    write_transform(maps_.back().inverse(), RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, context_.world2inst[level]);
    ++context_.instStackSize;
    scale_ = scale_of(maps_.back().inverse());
    return true;
  }

  void leave() override {
    maps_.pop_back();
    context_.instID[--context_.instStackSize] = RTC_INVALID_GEOMETRY_ID;
    scale_ = maps_.empty() ? 1 : scale_of(maps_.back().inverse());
  }

 private:
  static Affine load(const float (&m)[16]) { return read_transform(RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, m); }
  static double scale_of(const Affine& map) { return std::abs(map.uniform_scale()); }

  RTCPointQuery& query_;
  RTCPointQueryContext& context_;
  const RTCPointQueryFunction function_;
  void* const user_;
  const unsigned begin_;
  std::vector<Affine> maps_;  ///< from each scene inside to the outermost one
  double scale_ = 1;
  bool changed_ = false;
};

bool find_nearest(RTCScene handle, RTCPointQuery& query, RTCPointQueryContext& context,
                  RTCPointQueryFunction function, void* user) {
  const TraceScene& scene = *object_of(handle).to_trace().scene;
  Affine to_scene;
  if (context.instStackSize > 0)
    to_scene =
        read_transform(RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, context.world2inst[context.instStackSize - 1]);
  PointQuery visitor(query, context, function, user);
  visit_near(scene, {query.x, query.y, query.z}, to_scene, query.time, visitor);
  return visitor.changed();
}

/// Columns of N queries, one after the other.
template <class Queries>
bool find_all(const int* valid, RTCScene scene, Queries& queries, std::size_t count,
              RTCPointQueryContext& context, RTCPointQueryFunction function, void** users) {
  bool changed = false;
  for (std::size_t i = 0; i < count; ++i) {
    if (valid[i] == 0) continue;
    RTCPointQuery one{queries.x[i], queries.y[i], queries.z[i], queries.time[i], queries.radius[i]};
    changed |= find_nearest(scene, one, context, function, users != nullptr ? users[i] : nullptr);
    queries.radius[i] = one.radius;
  }
  return changed;
}

}  // namespace
}  // namespace oktett::embree

using namespace oktett::embree;

RTC_API bool rtcPointQuery(RTCScene scene, RTCPointQuery* query, RTCPointQueryContext* context,
                           RTCPointQueryFunction function, void* user) {
  return guarded(device_of(scene), [&] { return find_nearest(scene, *query, *context, function, user); });
}

#define OKTETT_POINT_QUERIES(n)                                                                     \
  RTC_API bool rtcPointQuery##n(const int* valid, RTCScene scene, RTCPointQuery##n* queries,        \
                                RTCPointQueryContext* context, RTCPointQueryFunction function,      \
                                void** users) {                                                     \
    return guarded(device_of(scene),                                                                \
                   [&] { return find_all(valid, scene, *queries, n, *context, function, users); }); \
  }
OKTETT_POINT_QUERIES(4)
OKTETT_POINT_QUERIES(8)
OKTETT_POINT_QUERIES(16)
