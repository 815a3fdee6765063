#pragma once
/// \file Large arrays that are filled by many threads before their size is known.

#include <cstddef>
#include <type_traits>
#include <utility>

#include "core/pages.h"

namespace oktett {

/// Reserves address space for `capacity` elements; pages are allocated when first written. `truncate`
/// releases the rest. Neither growing nor shrinking copies elements. New elements read as zero bytes.
template <class T>
class VirtualArray {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  VirtualArray() = default;
  explicit VirtualArray(std::size_t capacity) : bytes_(rounded(capacity * sizeof(T))) {
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

  /// Keeps the first `size` elements and their memory only.
  void truncate(std::size_t size) {
    const std::size_t keep = rounded(size * sizeof(T));
    if (keep >= bytes_) return;
    release_pages(reinterpret_cast<char*>(data_) + keep, bytes_ - keep);
    bytes_ = keep;
    if (keep == 0) data_ = nullptr;
  }

 private:
  static constexpr std::size_t kPage = 4096;
  static std::size_t rounded(std::size_t bytes) { return (bytes + kPage - 1) / kPage * kPage; }
  void swap(VirtualArray& other) noexcept { std::swap(data_, other.data_), std::swap(bytes_, other.bytes_); }

  T* data_ = nullptr;
  std::size_t bytes_ = 0;
};

}  // namespace oktett
