#include "embree/device.h"

#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace oktett::embree {
namespace {

thread_local RTCError error_without_device = RTC_ERROR_NONE;
thread_local std::string message_without_device;

/// Calls f(name, value) for the settings `name=value` of a configuration.
template <class Function>
void each_setting(std::string_view config, Function&& f) {
  while (!config.empty()) {
    const std::size_t end = std::min(config.find_first_of(",; \t\n"), config.size());
    const std::string_view setting = config.substr(0, end);
    const std::size_t equals = setting.find('=');
    if (equals != std::string_view::npos) f(setting.substr(0, equals), setting.substr(equals + 1));
    config.remove_prefix(std::min(end + 1, config.size()));
  }
}

/// The widest set of this build and processor that is no wider than the one that Embree calls `name`.
Isa isa_named(std::string_view word) {
  std::string name(word);
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  Isa most = Isa::scalar;
  if (name == "avx512" || name == "avx512skx")
    most = Isa::avx512;
  else if (name == "avx2")
    most = Isa::avx2;
  else if (name.starts_with("avx") || name.starts_with("sse") || name.starts_with("ssse"))
    most = Isa::sse42;
  else if (name == "neon" || name == "neon2x")
    most = Isa::neon;
  else
    fail(RTC_ERROR_INVALID_ARGUMENT, "unknown instruction set '" + name + "'");
  Isa widest = Isa::scalar;
  for (const Isa isa : available_isas())
    if (isa <= most) widest = isa;
  if (widest == Isa::scalar) fail(RTC_ERROR_UNSUPPORTED_CPU, "this processor has no '" + name + "'");
  return widest;
}

}  // namespace

Device::Device(const char* config) : isa_(default_isa()) {
  each_setting(config != nullptr ? config : "", [&](std::string_view name, std::string_view value) {
    if (name == "isa") isa_ = isa_named(value);
    if (name == "verbose") verbose_ = std::atoi(std::string(value).c_str());
  });
  if (verbose_ > 0)
    std::fprintf(stderr, "Oktett " OKTETT_VERSION " as Embree " RTC_VERSION_STRING ", %s\n", to_string(isa_));
}

void Device::report(Device* device, RTCError code, const std::string& message) noexcept {
  if (device == nullptr) {
    if (error_without_device == RTC_ERROR_NONE) error_without_device = code;
    message_without_device = message;
    return;
  }
  RTCErrorFunction function;
  void* user;
  {
    const std::lock_guard lock(device->mutex_);
    RTCError& error = device->errors_[std::this_thread::get_id()];
    if (error == RTC_ERROR_NONE) error = code;
    device->message_ = message;
    function = device->error_function_, user = device->error_user_;
  }
  if (device->verbose_ > 0) std::fprintf(stderr, "Oktett: %s\n", message.c_str());
  if (function != nullptr) function(user, code, message.c_str());
}

RTCError Device::take_error(Device* device) {
  if (device == nullptr) return std::exchange(error_without_device, RTC_ERROR_NONE);
  const std::lock_guard lock(device->mutex_);
  const auto found = device->errors_.find(std::this_thread::get_id());
  if (found == device->errors_.end()) return RTC_ERROR_NONE;
  const RTCError error = found->second;
  device->errors_.erase(found);
  return error;
}

const char* Device::last_message(Device* device) {
  if (device == nullptr) return message_without_device.c_str();
  const std::lock_guard lock(device->mutex_);
  return device->message_.c_str();
}

void Device::set_error_function(RTCErrorFunction function, void* user) {
  const std::lock_guard lock(mutex_);
  error_function_ = function, error_user_ = user;
}

void Device::set_memory_monitor(RTCMemoryMonitorFunction function, void* user) {
  memory_user_ = user;
  memory_function_ = function;
}

void Device::count_memory(ssize_t bytes, bool post) {
  const RTCMemoryMonitorFunction function = memory_function_;
  if (function == nullptr || bytes == 0) return;
  if (!function(memory_user_, bytes, post) && bytes > 0)
    fail(RTC_ERROR_OUT_OF_MEMORY, "the memory monitor forbids to take " + std::to_string(bytes) + " bytes");
}

ssize_t Device::property(RTCDeviceProperty property) const {
  const auto number = static_cast<int>(property);
  // From here on Embree has tests of its own insides, of which there are none.
  if (number >= 2000000 && number < 4000000) return 0;
  // RTC_DEVICE_PROPERTY_CPU_DEVICE and _SYCL_DEVICE, which not all headers of Embree 4 have.
  if (OKTETT_EMBREE == 4 && (number == 140 || number == 141)) return number == 140;
  switch (property) {
    case RTC_DEVICE_PROPERTY_VERSION:
      return RTC_VERSION;
    case RTC_DEVICE_PROPERTY_VERSION_MAJOR:
      return RTC_VERSION_MAJOR;
    case RTC_DEVICE_PROPERTY_VERSION_MINOR:
      return RTC_VERSION_MINOR;
    case RTC_DEVICE_PROPERTY_VERSION_PATCH:
      return RTC_VERSION_PATCH;
    case RTC_DEVICE_PROPERTY_NATIVE_RAY4_SUPPORTED:
      return 1;
    case RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED:
      return isa_ >= Isa::avx2;
    case RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED:
      return isa_ == Isa::avx512;
#if OKTETT_EMBREE == 3
    case RTC_DEVICE_PROPERTY_RAY_STREAM_SUPPORTED:
#endif
    case RTC_DEVICE_PROPERTY_RAY_MASK_SUPPORTED:
    case RTC_DEVICE_PROPERTY_FILTER_FUNCTION_SUPPORTED:
    case RTC_DEVICE_PROPERTY_IGNORE_INVALID_RAYS_ENABLED:
    case RTC_DEVICE_PROPERTY_TRIANGLE_GEOMETRY_SUPPORTED:
    case RTC_DEVICE_PROPERTY_QUAD_GEOMETRY_SUPPORTED:
    case RTC_DEVICE_PROPERTY_USER_GEOMETRY_SUPPORTED:
    case RTC_DEVICE_PROPERTY_POINT_GEOMETRY_SUPPORTED:
    case RTC_DEVICE_PROPERTY_TASKING_SYSTEM:  // TBB
    case RTC_DEVICE_PROPERTY_JOIN_COMMIT_SUPPORTED:
    case RTC_DEVICE_PROPERTY_PARALLEL_COMMIT_SUPPORTED:
      return 1;
#if OKTETT_EMBREE == 4
    case RTC_DEVICE_PROPERTY_BACKFACE_CULLING_SPHERES_ENABLED:
#endif
    case RTC_DEVICE_PROPERTY_BACKFACE_CULLING_CURVES_ENABLED:
    case RTC_DEVICE_PROPERTY_BACKFACE_CULLING_ENABLED:
    case RTC_DEVICE_PROPERTY_COMPACT_POLYS_ENABLED:
    case RTC_DEVICE_PROPERTY_SUBDIVISION_GEOMETRY_SUPPORTED:
    case RTC_DEVICE_PROPERTY_CURVE_GEOMETRY_SUPPORTED:  // round lines alone
      return 0;
    default:
      fail(RTC_ERROR_INVALID_ARGUMENT, "unknown property " + std::to_string(number));
  }
}

}  // namespace oktett::embree

using namespace oktett::embree;

RTC_API RTCDevice rtcNewDevice(const char* config) {
  return guarded(nullptr, [&] { return Shells<RTCDeviceTy>::make(std::make_unique<Device>(config)); });
}

RTC_API void rtcRetainDevice(RTCDevice device) {
  guarded(device_of(device), [&] { object_of(device), Shells<RTCDeviceTy>::retain(device); });
}

RTC_API void rtcReleaseDevice(RTCDevice device) {
  guarded(device_of(device), [&] { object_of(device), Shells<RTCDeviceTy>::release(device); });
}

RTC_API ssize_t rtcGetDeviceProperty(RTCDevice device, RTCDeviceProperty property) {
  return guarded(device_of(device), [&] { return object_of(device).property(property); });
}

RTC_API void rtcSetDeviceProperty(RTCDevice device, const RTCDeviceProperty property, ssize_t) {
  guarded(device_of(device), [&] {
    // Switches for debugging Embree.
    const auto number = static_cast<int>(property);
    if (number >= 1000000 && number < 1000004) return;
    object_of(device);
    fail(RTC_ERROR_INVALID_ARGUMENT, "property " + std::to_string(number) + " cannot be set");
  });
}

RTC_API RTCError rtcGetDeviceError(RTCDevice device) {
  if (device != nullptr && !device->is_alive()) return RTC_ERROR_INVALID_ARGUMENT;
  return Device::take_error(device_of(device));
}

RTC_API void rtcSetDeviceErrorFunction(RTCDevice device, RTCErrorFunction function, void* user) {
  guarded(device_of(device), [&] { object_of(device).set_error_function(function, user); });
}

RTC_API void rtcSetDeviceMemoryMonitorFunction(RTCDevice device, RTCMemoryMonitorFunction function,
                                               void* user) {
  guarded(device_of(device), [&] { object_of(device).set_memory_monitor(function, user); });
}

#if OKTETT_EMBREE == 4

// Later headers of Embree 4 have these two.

RTC_API const char* rtcGetErrorString(RTCError error) {
  switch (error) {
    case RTC_ERROR_NONE:
      return "RTC_ERROR_NONE";
    case RTC_ERROR_UNKNOWN:
      return "RTC_ERROR_UNKNOWN";
    case RTC_ERROR_INVALID_ARGUMENT:
      return "RTC_ERROR_INVALID_ARGUMENT";
    case RTC_ERROR_INVALID_OPERATION:
      return "RTC_ERROR_INVALID_OPERATION";
    case RTC_ERROR_OUT_OF_MEMORY:
      return "RTC_ERROR_OUT_OF_MEMORY";
    case RTC_ERROR_UNSUPPORTED_CPU:
      return "RTC_ERROR_UNSUPPORTED_CPU";
    case RTC_ERROR_CANCELLED:
      return "RTC_ERROR_CANCELLED";
    default:
      return "an error that this version does not know";
  }
}

RTC_API const char* rtcGetDeviceLastErrorMessage(RTCDevice device) {
  return Device::last_message(device_of(device));
}

#endif
