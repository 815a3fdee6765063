#include "embree/buffer.h"

#include <cstring>
#include <new>

namespace oktett::embree {

namespace {
/// Programs may read the last item of a buffer as four floats.
constexpr std::size_t kAlignment = 64, kPadding = 16;
}  // namespace

Buffer::Buffer(Ref<RTCDeviceTy> owner, std::size_t bytes)
    : device(std::move(owner)), bytes_(bytes), is_owned_(true) {
  if (bytes > static_cast<std::size_t>(PTRDIFF_MAX) - kPadding) throw std::bad_alloc();
  device->count_memory(static_cast<ssize_t>(bytes), false);
  data_ =
      static_cast<std::byte*>(::operator new (bytes + kPadding, std::align_val_t{kAlignment}, std::nothrow));
  if (data_ == nullptr) {
    device->count_memory(-static_cast<ssize_t>(bytes), true);
    throw std::bad_alloc();
  }
  std::memset(data_, 0, bytes + kPadding);
}

Buffer::Buffer(Ref<RTCDeviceTy> owner, void* data, std::size_t bytes)
    : device(std::move(owner)), data_(static_cast<std::byte*>(data)), bytes_(bytes), is_owned_(false) {}

Buffer::~Buffer() {
  if (!is_owned_) return;
  ::operator delete (data_, std::align_val_t{kAlignment});
  device->count_memory(-static_cast<ssize_t>(bytes_), true);
}

std::size_t size_of(RTCFormat format) {
  const auto f = static_cast<unsigned>(format);
  const unsigned items = (f & 0xff) + 0;
  switch (f & 0xff00) {
    case 0x1000:
    case 0x2000:
      return items;
    case 0x3000:
    case 0x4000:
      return 2 * items;
    case 0x5000:
    case 0x6000:
    case 0x9000:
      return 4 * items;
    case 0x7000:
    case 0x8000:
      return 8 * items;
    case 0x9100:
    case 0x9200:
      return 4 * (f >> 4 & 15) * (f & 15);
    case 0xa000:
      return sizeof(RTCGrid);
    case 0xb000:
      return sizeof(RTCQuaternionDecomposition);
    default:
      return 0;
  }
}

std::uint32_t float_count(RTCFormat format) {
  return format >= RTC_FORMAT_FLOAT && format <= RTC_FORMAT_FLOAT16
             ? static_cast<std::uint32_t>(format - RTC_FORMAT_FLOAT + 1)
             : 0;
}

}  // namespace oktett::embree

using namespace oktett::embree;

RTC_API RTCBuffer rtcNewBuffer(RTCDevice device, size_t bytes) {
  return guarded(device_of(device), [&] {
    object_of(device);
    return Shells<RTCBufferTy>::make(std::make_unique<Buffer>(Ref<RTCDeviceTy>(device), bytes));
  });
}

RTC_API RTCBuffer rtcNewSharedBuffer(RTCDevice device, void* data, size_t bytes) {
  return guarded(device_of(device), [&] {
    object_of(device);
    return Shells<RTCBufferTy>::make(std::make_unique<Buffer>(Ref<RTCDeviceTy>(device), data, bytes));
  });
}

RTC_API void* rtcGetBufferData(RTCBuffer buffer) {
  return guarded(device_of(buffer), [&] { return static_cast<void*>(object_of(buffer).data()); });
}

RTC_API void rtcRetainBuffer(RTCBuffer buffer) {
  guarded(device_of(buffer), [&] { object_of(buffer), Shells<RTCBufferTy>::retain(buffer); });
}

RTC_API void rtcReleaseBuffer(RTCBuffer buffer) {
  guarded(device_of(buffer), [&] { object_of(buffer), Shells<RTCBufferTy>::release(buffer); });
}
