#pragma once
/// \file How rays are sent through the tree. The hits are the same bits in every mode; only the speed
/// differs.

#include <cstdint>

namespace oktett {

enum class TraceMode : std::uint8_t {
  automatic,  ///< tiles for rays that share a point, packets for those that run together, else one by one
  single,     ///< one by one
  packet4,
  packet8,
  packet16,
  tile,  ///< as automatic, but no tile is given up, however small the triangles
};

}  // namespace oktett
