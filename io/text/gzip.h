#pragma once
/// \file Files that gzip has packed.

#include <cstddef>
#include <string>
#include <string_view>

namespace oktett {

/// Bytes in memory of their own, behind which more zero bytes follow.
class UnpackedBytes {
 public:
  /// Throws std::bad_alloc if there is no room for `capacity` bytes.
  explicit UnpackedBytes(std::size_t capacity);
  ~UnpackedBytes();
  UnpackedBytes(UnpackedBytes&& other) noexcept;
  UnpackedBytes& operator=(UnpackedBytes&&) = delete;
  UnpackedBytes(const UnpackedBytes&) = delete;
  UnpackedBytes& operator=(const UnpackedBytes&) = delete;

  char* data() { return data_; }
  const char* data() const { return data_; }
  std::size_t capacity() const { return capacity_; }
  /// Moves pages, copies nothing. Bytes that are new are zero.
  void resize(std::size_t capacity);

  std::size_t size = 0;  ///< bytes that count

 private:
  char* data_ = nullptr;
  std::size_t capacity_ = 0;
};

/// The most that `packed` bytes may unpack to: files of meshes shrink to a tenth, small ones may be all
/// zeros.
constexpr std::size_t most_unpacked(std::size_t packed) { return (std::size_t{16} << 20) + 256 * packed; }

/// Unpacks all members of a gzip file one after the other; `padding` zero bytes follow the result. Memory
/// grows with the data. Throws Error, which names `path`, if they are damaged, cut short, followed by
/// something else than zeros, or unpack to more than most_unpacked.
UnpackedBytes unpack_gzip(const std::string& path, std::string_view packed, std::size_t padding);

}  // namespace oktett
