#pragma once
/// \file Devices: errors, callbacks, settings.

#include <atomic>
#include <cstddef>
#include <exception>
#include <map>
#include <mutex>
#include <new>
#include <string>
#include <thread>

#include "core/isa.h"
#include "embree/handle.h"

namespace oktett::embree {

class Device {
 public:
  /// `config` as rtcNewDevice takes it; what is unknown is ignored, as it only tunes Embree. Throws ApiError
  /// for an instruction set that this processor or build does not have.
  explicit Device(const char* config);

  /// Reports an error of the calling thread: the first one since it was last asked for counts. `device` may
  /// be null.
  static void report(Device* device, RTCError code, const std::string& message) noexcept;
  /// The error of the calling thread, which is forgotten.
  static RTCError take_error(Device* device);
  /// What was wrong last, in any thread; without a device, in the calling one.
  static const char* last_message(Device* device);

  void set_error_function(RTCErrorFunction function, void* user);
  void set_memory_monitor(RTCMemoryMonitorFunction function, void* user);
  /// Tells the monitor of memory that is taken, or given back if `bytes` is negative. Throws ApiError if it
  /// forbids to take any.
  void count_memory(ssize_t bytes, bool post);

  ssize_t property(RTCDeviceProperty property) const;

  Isa isa() const { return isa_; }

 private:
  Isa isa_;
  int verbose_ = 0;
  std::mutex mutex_;
  std::map<std::thread::id, RTCError> errors_;
  std::string message_;  ///< the last one
  RTCErrorFunction error_function_ = nullptr;
  void* error_user_ = nullptr;
  std::atomic<RTCMemoryMonitorFunction> memory_function_{nullptr};
  void* memory_user_ = nullptr;
};

/// Calls f(), which may throw; then reports the error and returns the default of what f returns.
template <class Function>
auto guarded(Device* device, Function&& f) noexcept -> decltype(f()) {
  try {
    return f();
  } catch (const ApiError& error) {
    Device::report(device, error.code, error.message);
  } catch (const std::bad_alloc&) {
    Device::report(device, RTC_ERROR_OUT_OF_MEMORY, "out of memory");
  } catch (const std::exception& error) {
    Device::report(device, RTC_ERROR_UNKNOWN, error.what());
  } catch (...) {
    Device::report(device, RTC_ERROR_UNKNOWN, "unknown error");
  }
  return decltype(f())();
}

}  // namespace oktett::embree

struct RTCDeviceTy : oktett::embree::Shell<oktett::embree::Device> {};

namespace oktett::embree {

/// The device of a handle, for guarded(); null if there is none.
inline Device* device_of(RTCDevice handle) {
  return handle != nullptr && handle->is_alive() ? handle->object : nullptr;
}
/// The same for handles of what belongs to a device.
template <class S>
Device* device_of(S* handle) {
  return handle != nullptr && handle->is_alive() ? &*handle->object->device : nullptr;
}

}  // namespace oktett::embree
