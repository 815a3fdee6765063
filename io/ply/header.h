#pragma once
/// \file The header of a PLY file: which elements follow it, how they are laid out, and values in their
/// bytes. The format is that of the scans of Stanford's repository.

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "io/mesh/reading.h"

namespace oktett {

enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

constexpr std::size_t size_of(PlyType type) {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}
constexpr bool is_whole(PlyType type) { return type < PlyType::float32; }

enum class PlyFormat { ascii, little_endian, big_endian };

/// A value of each record, or a list of values with its length before it.
struct PlyProperty {
  std::string_view name;
  const char* where = nullptr;  ///< the line of the header
  PlyType type = PlyType::float32;
  bool is_list = false;
  PlyType length_type = PlyType::uint8;  ///< of a list
};

struct PlyElement {
  std::string_view name;
  const char* where = nullptr;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  static constexpr int kNone = -1;
  /// The index of the first of these properties that there is, or kNone.
  int find(std::initializer_list<std::string_view> names) const;
  bool has_lists() const;
  /// The fewest bytes of a record in a binary file: lists are empty. That is the size if there are no lists.
  std::size_t least_bytes() const;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  std::vector<std::string_view> textures;  ///< file names behind `comment TextureFile`
  const char* body = nullptr;              ///< behind the header
  std::vector<MeshFailure> notices;        ///< what is read with a warning

  const PlyElement* find(std::string_view name) const;
};

/// Reads the header of a file. Throws MeshFailure.
PlyHeader read_ply_header(std::string_view text);

static_assert(std::endian::native == std::endian::little, "values in big-endian files are turned around");

template <class T, bool kSwap>
T load_value(const char* p) {
  T value;
  if constexpr (kSwap) {
    char bytes[sizeof(T)];
    for (std::size_t i = 0; i < sizeof(T); ++i) bytes[i] = p[sizeof(T) - 1 - i];
    std::memcpy(&value, bytes, sizeof(T));
  } else {
    std::memcpy(&value, p, sizeof(T));
  }
  return value;
}

/// Calls f.operator()<T, kSwap>() for the values of a file.
template <class F>
decltype(auto) with_type(PlyType type, bool swap, const F& f) {
  const auto call = [&]<class T>() -> decltype(auto) {
    return swap ? f.template operator()<T, true>() : f.template operator()<T, false>();
  };
  switch (type) {
    case PlyType::int8:
      return f.template operator()<std::int8_t, false>();
    case PlyType::uint8:
      return f.template operator()<std::uint8_t, false>();
    case PlyType::int16:
      return call.template operator()<std::int16_t>();
    case PlyType::uint16:
      return call.template operator()<std::uint16_t>();
    case PlyType::int32:
      return call.template operator()<std::int32_t>();
    case PlyType::uint32:
      return call.template operator()<std::uint32_t>();
    case PlyType::float32:
      return call.template operator()<float>();
    case PlyType::float64:
      break;
  }
  return call.template operator()<double>();
}

/// The whole number at `p`. Values of other types do not count as whole.
inline std::int64_t load_whole(PlyType type, bool swap, const char* p) {
  return with_type(type, swap, [p]<class T, bool kSwap>() -> std::int64_t {
    if constexpr (std::integral<T>)
      return load_value<T, kSwap>(p);
    else
      return -1;
  });
}

inline double load_double(PlyType type, bool swap, const char* p) {
  return with_type(type, swap,
                   [p]<class T, bool kSwap>() { return static_cast<double>(load_value<T, kSwap>(p)); });
}

inline float load_float(PlyType type, bool swap, const char* p) {
  return with_type(type, swap,
                   [p]<class T, bool kSwap>() { return static_cast<float>(load_value<T, kSwap>(p)); });
}

}  // namespace oktett
