#pragma once
/// \file Values in the bytes of PLY files, in either byte order.

#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>

#include "io/ply/header.h"

namespace oktett {

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

inline float load_float(PlyType type, bool swap, const char* p) {
  return with_type(type, swap,
                   [p]<class T, bool kSwap>() { return static_cast<float>(load_value<T, kSwap>(p)); });
}

}  // namespace oktett
