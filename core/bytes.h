#pragma once
/// \file Numbers and texts as bytes, for binary files, and hashes and checksums of them: the same on every
/// machine.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

#include "core/random.h"
#include "core/vec3.h"

namespace oktett {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");

/// A hash of `bytes` and of how many there are, the same on every machine.
std::uint64_t checksum(std::string_view bytes);

/// Appends the bytes of a number.
template <class T>
void append_number(std::string& bytes, T value) {
  static_assert(std::is_arithmetic_v<T>);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

/// Appends the length of `text` and `text`.
void append_text(std::string& bytes, std::string_view text);

/// Takes what was appended off the front of some bytes. Each function throws Error if too few are left.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  std::string_view take(std::size_t size);
  template <class T>
  T number() {
    static_assert(std::is_arithmetic_v<T> && !std::is_same_v<T, bool>);
    T value;
    std::memcpy(&value, take(sizeof(T)).data(), sizeof(T));
    return value;
  }
  std::string text();
  /// The number of things that follow, each of at least `size` bytes. Throws Error if so many cannot be left.
  std::uint32_t count(std::size_t size);
  std::size_t left() const { return bytes_.size(); }

 private:
  std::string_view bytes_;
};

/// Takes numbers in and gives 64 bits that depend on all of them and on their order.
class Hasher {
 public:
  void add(std::uint64_t bits) { state_ = mix_bits((state_ ^ bits) + kGoldenBits); }
  void add(float x) { add(std::uint64_t{std::bit_cast<std::uint32_t>(x)}); }
  void add(double x) { add(std::bit_cast<std::uint64_t>(x)); }
  void add(const Vec3f& v) { add(v.x), add(v.y), add(v.z); }

  std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0;
};

/// Bytes that are summed up as one piece. The checksum depends on this number.
inline constexpr std::size_t kChecksumPiece = std::size_t{1} << 20;

/// The checksum of one piece, at most kChecksumPiece bytes. Any change within eight bytes at a multiple of
/// eight changes it.
std::uint64_t piece_checksum(const void* data, std::size_t bytes);

/// The checksum of `bytes` bytes, the same on every machine and for any number of threads: a hash of the
/// checksums of all pieces and of the size.
std::uint64_t block_checksum(const void* data, std::size_t bytes);

/// Copies `bytes` bytes and returns the checksum of the copy.
std::uint64_t copy_with_checksum(const void* from, void* to, std::size_t bytes);

}  // namespace oktett
