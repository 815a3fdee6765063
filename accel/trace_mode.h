#pragma once
/// \file How rays are sent through the tree. The hits are the same bits in every mode; only the speed
/// differs.

#include <cstdint>

namespace oktett {

enum class TraceMode : std::uint8_t {
  automatic,    ///< beams for rays that share a point, packets for those that run together, the others
                ///< interleaved
  single,       ///< one by one
  interleaved,  ///< one by one, many in flight (without vector registers: like `single`)
  packet4,
  packet8,
  packet16,
  beam,  ///< as automatic, but no beam is given up, however small the triangles
};

}  // namespace oktett
