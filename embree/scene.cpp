#include "embree/scene.h"

#include <string>

#include "embree/callbacks.h"

namespace oktett::embree {

Traced::~Traced() {
  if (bytes > 0) device->count_memory(-static_cast<ssize_t>(bytes), true);
}

// ---- Numbers.

unsigned Scene::attach(RTCGeometry geometry) {
  object_of(geometry);
  const std::lock_guard lock(numbers_);
  std::size_t number = 0;
  while (number < geometries_.size() && geometries_[number]) ++number;
  if (number == geometries_.size()) geometries_.emplace_back();
  geometries_[number] = Ref<RTCGeometryTy>(geometry);
  changed_ = true;
  return static_cast<unsigned>(number);
}

void Scene::attach(RTCGeometry geometry, unsigned number) {
  object_of(geometry);
  if (number == RTC_INVALID_GEOMETRY_ID)
    fail(RTC_ERROR_INVALID_ARGUMENT, "this is the number of no geometry");
  const std::lock_guard lock(numbers_);
  if (number >= geometries_.size()) geometries_.resize(std::size_t{number} + 1);
  if (geometries_[number])
    fail(RTC_ERROR_INVALID_OPERATION, "there is a geometry " + std::to_string(number) + " already");
  geometries_[number] = Ref<RTCGeometryTy>(geometry);
  changed_ = true;
}

void Scene::detach(unsigned number) {
  const std::lock_guard lock(numbers_);
  geometry(number);
  geometries_[number] = {};
  changed_ = true;
}

RTCGeometry Scene::geometry_locked(unsigned number) const {
  const std::lock_guard lock(numbers_);
  return geometry(number);
}

RTCGeometry Scene::geometry(unsigned number) const {
  if (number >= geometries_.size() || !geometries_[number])
    fail(RTC_ERROR_INVALID_ARGUMENT, "there is no geometry " + std::to_string(number));
  return geometries_[number].handle();
}

// ---- Commits.

Scene::Seen Scene::look_at(const Geometry& geometry) {
  Seen seen{geometry.version(), {}};
  for (const Ref<RTCSceneTy>& child : geometry.scenes) seen.children.push_back(child->traced().get());
  return seen;
}

bool Scene::is_committed() const {
  const std::lock_guard lock(commits_);
  return traced_ != nullptr && !changed_;
}

std::shared_ptr<const Traced> Scene::traced() const {
  const std::lock_guard lock(commits_);
  return traced_;
}

void Scene::report_progress(double part) const {
  if (progress != nullptr && !progress(progress_user, part))
    fail(RTC_ERROR_CANCELLED, "the progress monitor cancelled the build");
}

void Scene::commit() {
  const std::lock_guard lock(commits_);
  std::vector<Ref<RTCGeometryTy>> geometries;
  {
    const std::lock_guard numbers(numbers_);
    geometries = geometries_;
  }
  std::vector<Seen> seen(geometries.size());
  for (std::size_t i = 0; i < geometries.size(); ++i)
    if (geometries[i]) seen[i] = look_at(*geometries[i]);
  if (traced_ != nullptr && !changed_ && seen == seen_) return;

  report_progress(0);
  const auto traced = std::make_shared<Traced>();
  traced->device = device;
  std::vector<SceneGeometry> shapes;
  std::size_t bytes = 0;
  // Scenes that are not said to change are read anew, as by Embree: programs change shared memory without a
  // word.
  const bool keep = (flags & RTC_SCENE_FLAG_DYNAMIC) != 0;
  for (std::size_t i = 0; i < geometries.size(); ++i) {
    if (!geometries[i] || !geometries[i]->is_enabled) continue;
    Geometry& own = *geometries[i];
    if (!own.is_committed)
      fail(RTC_ERROR_INVALID_OPERATION, "geometry " + std::to_string(i) + " was not committed");
    traced->geometries.push_back(geometries[i]);
    const Made& made = traced->made.emplace_back(own.made(keep));
    SceneGeometry& shape = shapes.emplace_back();
    shape.shape = made.shape, shape.faces = made.faces, shape.tree = made.tree;
    shape.number = static_cast<std::uint32_t>(i), shape.mask = own.mask, shape.user = &own;
    shape.begin = own.begin, shape.end = own.end;
    if (own.type != RTC_GEOMETRY_TYPE_USER && !own.is_instance()) {
      if (own.closest_filter != nullptr) shape.closest_filter = GeometryFilter::instance(false);
      if (own.any_filter != nullptr) shape.any_filter = GeometryFilter::instance(true);
    }
    if (made.mesh != nullptr) bytes += made.mesh->bytes();
  }
  BuildOptions options;
  if ((flags & RTC_SCENE_FLAG_COMPACT) != 0) options.quality = BuildQuality::compact;
  if (quality == RTC_BUILD_QUALITY_LOW || (flags & RTC_SCENE_FLAG_DYNAMIC) != 0)
    options.quality = BuildQuality::fast;
  if (quality == RTC_BUILD_QUALITY_HIGH) options.quality = BuildQuality::best;
  device->count_memory(static_cast<ssize_t>(bytes), false);
  traced->bytes = bytes;
  traced->scene = build_trace_scene(std::move(shapes), options);
  report_progress(1);
  current_.store(traced.get(), std::memory_order_release);
  traced_ = traced;
  seen_ = std::move(seen);
  changed_ = false;
}

}  // namespace oktett::embree

using namespace oktett::embree;
using oktett::Affine;
using oktett::Box;
using oktett::SceneBounds;

/// Calls f(scene) and reports its errors.
template <class Function>
static auto with(RTCScene handle, Function&& f) -> decltype(f(*handle->object)) {
  return guarded(device_of(handle), [&] { return f(object_of(handle)); });
}

RTC_API RTCScene rtcNewScene(RTCDevice device) {
  return guarded(device_of(device), [&] {
    object_of(device);
    return Shells<RTCSceneTy>::make(std::make_unique<Scene>(Ref<RTCDeviceTy>(device)));
  });
}

RTC_API RTCDevice rtcGetSceneDevice(RTCScene scene) {
  return with(scene, [](Scene& s) {
    Shells<RTCDeviceTy>::retain(s.device.handle());
    return s.device.handle();
  });
}

RTC_API void rtcRetainScene(RTCScene scene) {
  with(scene, [&](Scene&) { Shells<RTCSceneTy>::retain(scene); });
}

RTC_API void rtcReleaseScene(RTCScene scene) {
  with(scene, [&](Scene&) { Shells<RTCSceneTy>::release(scene); });
}

RTC_API unsigned rtcAttachGeometry(RTCScene scene, RTCGeometry geometry) {
  unsigned number = RTC_INVALID_GEOMETRY_ID;
  with(scene, [&](Scene& s) { number = s.attach(geometry); });
  return number;
}

RTC_API void rtcAttachGeometryByID(RTCScene scene, RTCGeometry geometry, unsigned number) {
  with(scene, [&](Scene& s) { s.attach(geometry, number); });
}

RTC_API void rtcDetachGeometry(RTCScene scene, unsigned number) {
  with(scene, [&](Scene& s) { s.detach(number); });
}

RTC_API RTCGeometry rtcGetGeometry(RTCScene scene, unsigned number) {
  return with(scene, [&](Scene& s) { return s.geometry(number); });
}

RTC_API RTCGeometry rtcGetGeometryThreadSafe(RTCScene scene, unsigned number) {
  return with(scene, [&](Scene& s) { return s.geometry_locked(number); });
}

RTC_API void rtcCommitScene(RTCScene scene) {
  with(scene, [](Scene& s) { s.commit(); });
}

RTC_API void rtcJoinCommitScene(RTCScene scene) {
  with(scene, [](Scene& s) { s.commit(); });
}

RTC_API void rtcSetSceneProgressMonitorFunction(RTCScene scene, RTCProgressMonitorFunction progress,
                                                void* user) {
  with(scene, [&](Scene& s) { s.progress = progress, s.progress_user = user; });
}

RTC_API void rtcSetSceneBuildQuality(RTCScene scene, RTCBuildQuality quality) {
  with(scene, [&](Scene& s) {
    if (quality < RTC_BUILD_QUALITY_LOW || quality > RTC_BUILD_QUALITY_HIGH)
      fail(RTC_ERROR_UNKNOWN, "scenes are built with quality low, medium or high");
    if (s.quality != quality) s.note_change();
    s.quality = quality;
  });
}

RTC_API void rtcSetSceneFlags(RTCScene scene, RTCSceneFlags flags) {
  with(scene, [&](Scene& s) {
    if (s.flags != flags) s.note_change();
    s.flags = flags;
  });
}

RTC_API RTCSceneFlags rtcGetSceneFlags(RTCScene scene) {
  return with(scene, [](Scene& s) { return s.flags; });
}

/// A box as the interface has it; of nothing, the one with lower = inf.
static RTCBounds to_bounds(const Box& b) { return {b.lo.x, b.lo.y, b.lo.z, 0, b.hi.x, b.hi.y, b.hi.z, 0}; }

RTC_API void rtcGetSceneBounds(RTCScene scene, RTCBounds* out) {
  with(scene, [&](Scene& s) {
    if (out == nullptr) fail(RTC_ERROR_INVALID_ARGUMENT, "there is no place for the bounds");
    const SceneBounds b = bounds(*s.to_trace().scene);
    Box all = b.first;
    all.grow(b.last);
    *out = to_bounds(all);
  });
}

RTC_API void rtcGetSceneLinearBounds(RTCScene scene, RTCLinearBounds* out) {
  with(scene, [&](Scene& s) {
    if (out == nullptr) fail(RTC_ERROR_INVALID_ARGUMENT, "there is no place for the bounds");
    const SceneBounds b = bounds(*s.to_trace().scene);
    *out = {to_bounds(b.first), to_bounds(b.last)};
  });
}

#if OKTETT_EMBREE == 4
RTC_API void* rtcGetGeometryUserDataFromScene(RTCScene scene, unsigned number) {
  return with(scene, [&](Scene& s) { return s.geometry(number)->object->user; });
}

RTC_API void rtcGetGeometryTransformFromScene(RTCScene scene, unsigned number, float time, RTCFormat format,
                                              void* data) {
  with(scene,
       [&](Scene& s) { write_transform(transform_at(*s.geometry(number)->object, 0, time), format, data); });
}
#endif

RTC_API void rtcCollide(RTCScene scene, RTCScene, RTCCollideFunc, void*) {
  with(scene, [](Scene&) { fail(RTC_ERROR_INVALID_OPERATION, "Oktett finds no collisions of scenes"); });
}
