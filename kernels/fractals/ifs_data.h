#pragma once
/// \file What describes the fractal of an iterated function system.

#include <cstdint>
#include <vector>

#include "core/description.h"
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
  std::vector<Affine> maps;
  std::uint32_t depth = 8;
  Base base = Base::ball;
  double least = 0;
  bool every_level = false;

  static constexpr ShapeInfo kShapeInfo{"ifs", "the base, moved by `depth` of the maps in all orders"};
  void describe(auto& p) {
    p.required("maps", maps, whole(1, kMaxIfsMaps), "each a contraction with an inverse");
    p.field("depth", depth, whole(0, kMaxIfsDepth), "how many maps follow each other");
    p.choice("base", base, {{"ball", Base::ball}, {"box", Base::box}},
             "a ball of radius 1, or the cube [-1, 1]³");
    p.field("least", least, kUnitInterval,
            "pieces of at most this part of the base's size are not divided further");
    p.field("every_level", every_level, "shows the pieces that were divided, too");
  }
};

}  // namespace oktett
