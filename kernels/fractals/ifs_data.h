#pragma once
/// \file What describes the fractal of an iterated function system.

#include <cstdint>
#include <vector>

#include "core/transform.h"

namespace oktett {

/// Most levels; finer ones would be smaller than a float can tell apart.
inline constexpr int kMaxIfsDepth = 32;
inline constexpr int kMaxIfsMaps = 64;

/// An iterated function system: the base, moved by `depth` of the maps in all orders (M. Barnsley: Fractals
/// Everywhere, 1988). The union of all pieces is a solid.
struct IfsShape {
  enum class Base : std::uint8_t {
    ball,  ///< of radius 1 about the origin
    box,   ///< [-1, 1]^3
  };
  std::vector<Affine> maps;  ///< 1 to kMaxIfsMaps, invertible contractions
  std::uint32_t depth = 8;   ///< at most kMaxIfsDepth
  Base base = Base::ball;
  double least = 0;          ///< pieces of no more than this part of the base's size are not divided; >= 0
  bool every_level = false;  ///< with the pieces that have been divided, too
};

}  // namespace oktett
