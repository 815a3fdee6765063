#pragma once
/// \file Memory in pages, which large arrays take from the system themselves, and an array in such pages that
/// many threads fill.

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

namespace oktett {

/// Columns of at least so many bytes have pages of their own.
inline constexpr std::size_t kLargePiece = std::size_t{4} << 20;
inline constexpr std::size_t kHugePage = std::size_t{2} << 20;

/// The size of the system's pages: 4 KiB on x86-64, and 4, 16 or 64 KiB on 64-bit ARM, by the kernel. The
/// kernel takes only addresses that begin with a page, and rounds lengths up to whole pages.
std::size_t page_size();

/// Whole pages: `bytes` bytes from address `first` on.
struct PageRange {
  std::uintptr_t first = 0;
  std::size_t bytes = 0;
};
/// The whole pages among the `bytes` bytes from `begin` on, and those that hold any of these bytes; `page` is
/// a power of two.
PageRange pages_within(std::uintptr_t begin, std::size_t bytes, std::size_t page);
PageRange pages_around(std::uintptr_t begin, std::size_t bytes, std::size_t page);

/// Rounds up to whole pages: to a huge page where the rest fills at least half of one, else to pages of
/// page_size(), or of `page` bytes. Sizes near the greatest number, for which there is no memory, are
/// returned unchanged.
std::size_t whole_pages(std::size_t bytes);
std::size_t whole_pages(std::size_t bytes, std::size_t page);

/// Address space for so many bytes, which read as zero. Pages are allocated when they are first written.
/// Whole huge pages are requested: rays read nodes and triangles in random order, and with small pages, most
/// reads of a large tree miss the processor's table of addresses (TLB). Throws std::bad_alloc.
void* reserve_pages(std::size_t bytes);

/// Gives back address space of reserve_pages, from a page boundary on; a piece of it may be given back before
/// the rest.
void release_pages(void* begin, std::size_t bytes);

/// Gives back the memory of the whole pages among these bytes. Their contents are lost; the address space
/// remains and may be written again.
void discard_pages(void* begin, std::size_t bytes);

/// Has the system allocate all pages of these `bytes` bytes, which the caller is going to write. One call for
/// many pages costs a fraction of the page faults that writing them causes. Their contents are kept.
/// Does nothing where the system cannot do so (Linux can since version 5.14).
void populate_pages(void* begin, std::size_t bytes);

/// Whether the system would give so many more bytes of address space now.
bool can_reserve(std::size_t bytes);

/// An array for many threads. Reserves address space for `size` elements; pages are allocated when first
/// written. New elements read as zero bytes.
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
