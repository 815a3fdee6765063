#pragma once
/// \file Buffers, and views of them with a format.

#include <cstddef>
#include <cstdint>
#include <memory>

#include "core/vec3.h"
#include "embree/device.h"

namespace oktett::embree {

class Buffer {
 public:
  /// Of its own memory, which is zero.
  Buffer(Ref<RTCDeviceTy> owner, std::size_t bytes);
  /// Of memory that the program keeps.
  Buffer(Ref<RTCDeviceTy> owner, void* data, std::size_t bytes);
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;
  ~Buffer();

  std::byte* data() const { return data_; }
  std::size_t bytes() const { return bytes_; }

  const Ref<RTCDeviceTy> device;

 private:
  std::byte* data_;
  const std::size_t bytes_;
  const bool is_owned_;
};

}  // namespace oktett::embree

struct RTCBufferTy : oktett::embree::Shell<oktett::embree::Buffer> {};

namespace oktett::embree {

/// Part of a buffer as items of a format.
struct View {
  Ref<RTCBufferTy> buffer;
  std::byte* data = nullptr;
  std::size_t stride = 0, count = 0;
  RTCFormat format = RTC_FORMAT_UNDEFINED;

  explicit operator bool() const { return data != nullptr || count == 0; }
  template <class T>
  const T* item(std::size_t i) const {
    return reinterpret_cast<const T*>(data + i * stride);
  }
  Vec3f vec3(std::size_t i) const {
    const float* const p = item<float>(i);
    return {p[0], p[1], p[2]};
  }
};

/// Bytes of an item.
std::size_t size_of(RTCFormat format);
/// How many floats an item has; 0 if it is none of floats.
std::uint32_t float_count(RTCFormat format);

}  // namespace oktett::embree
