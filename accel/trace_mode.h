#pragma once
/// \file How rays are sent through the tree. The hits are the same bits in every mode; only the speed
/// differs.

#include <cstdint>

namespace oktett {

enum class TraceMode : std::uint8_t {
  automatic,  ///< packets of 8 (of 16 with AVX-512) for rays that run together, else one by one
  single,     ///< one by one
  packet4,
  packet8,
  packet16,
};

}  // namespace oktett
