#pragma once
/// \file Densities on a grid, between which media of varying density are interpolated.

#include <cstdint>
#include <memory>

#include "core/soa.h"
#include "core/vec3.h"

namespace oktett {

/// Most values along an edge of a grid, and in all.
inline constexpr std::uint32_t kMostDensitySide = 4096;
inline constexpr std::size_t kMostDensities = std::size_t{1} << 28;

/// Values at the corners of cells. Within a cell the density is interpolated linearly along each axis.
class DensityGrid {
 public:
  /// `values`: at least 0 and finite, x fastest, then y, then z; nx * ny * nz of them, each side from 2 to
  /// kMostDensitySide. Others count as 0, and a grid of the wrong size is one of zeros.
  DensityGrid(std::uint32_t nx, std::uint32_t ny, std::uint32_t nz, Column<float> values);

  std::uint32_t size(int axis) const { return size_[axis]; }
  /// The greatest density.
  double most() const { return most_; }

  /// The density at a place in units of cells, [0, size - 1] along each axis; 0 outside.
  double at(const Vec3d& place) const;

  // Blocks of kBlock^3 cells, each with a bound of its density.
  static constexpr int kBlock = 8;
  int blocks(int axis) const { return blocks_[axis]; }
  /// No density in the block, or within half a cell of it, is greater.
  double block_most(int x, int y, int z) const {
    return static_cast<double>(block_most_[(static_cast<std::size_t>(z) * blocks_[1] + y) * blocks_[0] + x]);
  }

 private:
  void bound_blocks();
  float value(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return values_[(std::size_t{z} * size_[1] + y) * size_[0] + x];
  }

  std::uint32_t size_[3];
  int blocks_[3];
  double most_ = 0;
  Column<float> values_, block_most_;
};

}  // namespace oktett
