#pragma once
/// \file Numbers and texts as bytes, for binary files.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

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

}  // namespace oktett
