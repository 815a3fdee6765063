#pragma once
/// \file Scenes: geometries by their numbers, and what was last committed.

#include <atomic>
#include <memory>
#include <mutex>
#include <vector>

#include "embree/geometry.h"

namespace oktett::embree {

/// A scene as it was committed, with all that it refers to.
struct Traced {
  std::shared_ptr<const TraceScene> scene;
  std::vector<Ref<RTCGeometryTy>> geometries;
  std::vector<Made> made;
  std::size_t bytes = 0;  ///< that the device was told of
  Ref<RTCDeviceTy> device;

  ~Traced();
};

class Scene {
 public:
  explicit Scene(Ref<RTCDeviceTy> owner) : device(std::move(owner)) {}

  /// The number of the geometry: the lowest free one, or the one that is given. Throws ApiError if that is
  /// taken.
  unsigned attach(RTCGeometry geometry);
  void attach(RTCGeometry geometry, unsigned number);
  void detach(unsigned number);
  /// The geometry of a number, which is not retained. Throws ApiError if there is none. No other thread may
  /// attach or detach one meanwhile: programs ask for each hit, so nothing is locked.
  RTCGeometry geometry(unsigned number) const;
  /// The same beside threads that attach and detach.
  RTCGeometry geometry_locked(unsigned number) const;

  /// Builds what has changed since the last time. Threads that call it at the same time wait for the first.
  void commit();
  /// What was committed; null: nothing was yet.
  std::shared_ptr<const Traced> traced() const;
  /// The same for queries, which may not run beside a commit. Throws ApiError if nothing was committed.
  const Traced& to_trace() const {
    const Traced* const traced = current_.load(std::memory_order_acquire);
    if (traced == nullptr) fail(RTC_ERROR_INVALID_OPERATION, "the scene was not committed");
    return *traced;
  }
  bool is_committed() const;

  const Ref<RTCDeviceTy> device;
  RTCSceneFlags flags = RTC_SCENE_FLAG_NONE;
  RTCBuildQuality quality = RTC_BUILD_QUALITY_MEDIUM;
  RTCProgressMonitorFunction progress = nullptr;
  void* progress_user = nullptr;

  void note_change() { changed_ = true; }

 private:
  /// What the last commit saw of a geometry.
  struct Seen {
    std::uint64_t version;
    std::vector<const Traced*> children;
    bool operator==(const Seen&) const = default;
  };
  static Seen look_at(const Geometry& geometry);
  void report_progress(double part) const;

  mutable std::mutex numbers_, commits_;
  std::vector<Ref<RTCGeometryTy>> geometries_;  ///< by number
  std::vector<Seen> seen_;                      ///< by number
  std::atomic<bool> changed_{true};
  std::shared_ptr<const Traced> traced_;
  std::atomic<const Traced*> current_{nullptr};
};

}  // namespace oktett::embree
