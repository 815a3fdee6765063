#pragma once
/// \file Storage for structures of arrays: one aligned, padded column per member.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>

namespace oktett {

/// Alignment of every column and block, in bytes: one cache line, one 512-bit register.
inline constexpr std::size_t kAlignment = 64;

/// Storage for a column of so many bytes, aligned to kAlignment. Large columns have pages of their own, see
/// reserve_pages. Throws std::bad_alloc.
void* allocate_column(std::size_t bytes);
void free_column(void* storage, std::size_t bytes);

/// An owning array of trivially copyable elements. The storage is aligned to and padded up to a multiple of
/// 64 bytes, so full-width loads that start inside the array never leave it. New elements are not
/// initialised: the pages of a large column are first touched by the thread that fills it.
template <class T>
class Column {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  Column() = default;
  explicit Column(std::size_t size) { resize_uninitialized(size); }
  Column(std::size_t size, const T& value) : Column(size) {
    for (T& element : *this) element = value;
  }
  Column(const Column& other) { *this = other; }
  Column(Column&&) noexcept = default;
  Column& operator=(Column&&) noexcept = default;
  Column& operator=(const Column& other) {
    if (this == &other) return *this;
    resize_uninitialized(other.size_);
    if (size_ > 0) std::memcpy(data_.get(), other.data_.get(), size_ * sizeof(T));
    return *this;
  }
  ~Column() = default;

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  /// Bytes held, padding included.
  std::size_t bytes() const { return capacity_ * sizeof(T); }

  T* data() { return data_.get(); }
  const T* data() const { return data_.get(); }
  T* begin() { return data(); }
  T* end() { return data() + size_; }
  const T* begin() const { return data(); }
  const T* end() const { return data() + size_; }
  T& operator[](std::size_t i) { return data_.get()[i]; }
  const T& operator[](std::size_t i) const { return data_.get()[i]; }
  T& back() { return data_.get()[size_ - 1]; }

  operator std::span<const T>() const { return {data(), size_}; }

  /// Removes all elements and gives back the storage.
  void clear() { data_.reset(), size_ = capacity_ = 0; }

  /// Changes the size and keeps what fits; elements that are new hold no defined value.
  void resize_uninitialized(std::size_t size) {
    if (size > capacity_) reallocate(size);
    size_ = size;
  }

  void push_back(const T& value) {
    if (size_ == capacity_) {
      const T copy = value;
      reallocate(size_ + size_ / 2 + kAlignment / sizeof(T) + 1);
      data_.get()[size_++] = copy;
      return;
    }
    data_.get()[size_++] = value;
  }

  /// Gives back storage beyond the size.
  void shrink_to_fit() {
    if (padded(size_) < capacity_) reallocate(size_);
  }

 private:
  struct Free {
    std::size_t bytes = 0;
    void operator()(T* p) const { free_column(p, bytes); }
  };

  static std::size_t padded(std::size_t size) {
    const std::size_t bytes = (size * sizeof(T) + kAlignment - 1) / kAlignment * kAlignment;
    return bytes / sizeof(T);
  }

  void reallocate(std::size_t size) {
    const std::size_t capacity = padded(size);
    std::unique_ptr<T, Free> grown;
    if (capacity > 0) {
      const std::size_t bytes = (capacity * sizeof(T) + kAlignment - 1) / kAlignment * kAlignment;
      grown = {static_cast<T*>(allocate_column(bytes)), Free{bytes}};
      if (size_ > 0) std::memcpy(grown.get(), data_.get(), (size_ < size ? size_ : size) * sizeof(T));
    }
    data_ = std::move(grown);
    capacity_ = capacity;
  }

  std::unique_ptr<T, Free> data_;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

}  // namespace oktett
