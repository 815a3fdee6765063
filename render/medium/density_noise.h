#pragma once
/// \file Clouds of noise: densities that look like smoke.

#include <cstdint>
#include <limits>
#include <memory>

#include "core/description.h"
#include "render/medium/density_grid.h"

namespace oktett {

/// Sums of smooth random numbers on ever finer lattices.
struct DensityNoise {
  std::uint32_t size = 64;    ///< values along each edge of the grid, [2, 512]
  double scale = 4;           ///< cells of the coarsest lattice along an edge
  std::uint32_t octaves = 5;  ///< lattices, each twice as fine and half as strong as the one before, [1, 12]
  double threshold = 0.5;  ///< noise, in [0, 1], below this becomes 0; what is above is stretched to [0, 1]
  double falloff = 0;      ///< part of the way from the middle to the faces on which the density falls to 0
  std::uint32_t seed = 0;

  void describe(auto& p) {
    p.field("size", size, whole(2, 512), "values along each edge");
    p.field("scale", scale, Range{0, 1e6, true}, "cells of the coarsest lattice along an edge");
    p.field("octaves", octaves, whole(1, 12),
            "lattices, each twice as fine and half as strong as the one before");
    p.field("threshold", threshold, Range{0, 1, false, true},
            "noise below becomes 0, above it is stretched to 1");
    p.field("falloff", falloff, kUnitInterval,
            "part of the way from the middle to the faces on which it fades to 0");
    p.field("seed", seed, kAnySeed, "which of many clouds");
  }
};

/// The noise on a grid, with densities in [0, 1]: a function of the parameters alone.
std::shared_ptr<const DensityGrid> density_of(const DensityNoise& noise);

}  // namespace oktett
