#pragma once
/// \file Large arrays that many threads fill.

#include <cstddef>
#include <type_traits>
#include <utility>

#include "core/pages.h"

namespace oktett {

/// Reserves address space for `size` elements; pages are allocated when first written. New elements read as
/// zero bytes.
template <class T>
class VirtualArray {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  VirtualArray() = default;
  explicit VirtualArray(std::size_t size) : bytes_(whole_pages(size * sizeof(T))) {
    if (bytes_ > 0) data_ = static_cast<T*>(reserve_pages(bytes_));
  }
  VirtualArray(VirtualArray&& other) noexcept { swap(other); }
  VirtualArray& operator=(VirtualArray&& other) noexcept {
    VirtualArray(std::move(other)).swap(*this);
    return *this;
  }
  VirtualArray(const VirtualArray&) = delete;
  VirtualArray& operator=(const VirtualArray&) = delete;
  ~VirtualArray() {
    if (data_ != nullptr) release_pages(data_, bytes_);
  }

  T* data() { return data_; }
  const T* data() const { return data_; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }

 private:
  void swap(VirtualArray& other) noexcept { std::swap(data_, other.data_), std::swap(bytes_, other.bytes_); }

  T* data_ = nullptr;
  std::size_t bytes_ = 0;
};

}  // namespace oktett
