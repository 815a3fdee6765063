#pragma once
/// \file The traversal that a query uses. Hits have the same bits in every mode; only the speed differs. Each
/// set has packets of the widths that suit its registers: the scalar set none, so that every ray goes alone;
/// the others packets of 8, SSE4.2 also of 4 and AVX-512 also of 16. Where a set lacks the packets that are
/// asked for, those of 8 are used.

#include <cstdint>

namespace oktett {

enum class TraceMode : std::uint8_t {
  automatic,    ///< beams for rays that share a point, packets for other coherent rays, the rest interleaved
  single,       ///< one ray after the other
  interleaved,  ///< single rays, many in flight (without vector registers: like `single`)
  packet4,
  packet8,
  packet16,
  beam,  ///< like automatic, but no beam is given up, however small the triangles
};

}  // namespace oktett
