#include "kernels/shapes/height_grid.h"

#include <sys/mman.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace oktett {

namespace {

/// Rays come to a field in many places: with pages of 2 MiB their addresses are at hand.
template <class T>
VirtualArray<T> large_array(std::size_t count) {
  constexpr std::size_t kWorthwhile = std::size_t{1} << 22;
  VirtualArray<T> array(count);
  // Only advice: whether it is taken changes nothing but the speed.
  if (count * sizeof(T) >= kWorthwhile) madvise(array.data(), count * sizeof(T), MADV_HUGEPAGE);
  return array;
}

}  // namespace

HeightGrid::HeightGrid(std::uint32_t columns, std::uint32_t rows, HeightInterpolation interpolation)
    : columns_(columns),
      rows_(rows),
      interpolation_(interpolation),
      tile_row_((columns + kTile - 1) / kTile * std::size_t{kTile} * kTile) {}

std::shared_ptr<const HeightGrid> HeightGrid::from_words(std::uint32_t columns, std::uint32_t rows,
                                                         Column<std::uint16_t> words,
                                                         HeightInterpolation interpolation) {
  std::shared_ptr<HeightGrid> grid(new HeightGrid(columns, rows, interpolation));
  grid->words_ = grid->take(words);
  grid->word_data_ = grid->words_.data();
  grid->step_ = 1;
  grid->build_pyramid();
  return grid;
}

std::shared_ptr<const HeightGrid> HeightGrid::from_floats(std::uint32_t columns, std::uint32_t rows,
                                                          Column<float> floats,
                                                          HeightInterpolation interpolation) {
  std::shared_ptr<HeightGrid> grid(new HeightGrid(columns, rows, interpolation));
  grid->floats_ = grid->take(floats);
  grid->float_data_ = grid->floats_.data();
  // Rounded outwards to steps, for which there must be one to spare.
  grid->step_ = grid->greatest_ > grid->least_ ? (grid->greatest_ - grid->least_) / 65534 : 1;
  grid->build_pyramid();
  return grid;
}

/// The samples in tiles; notes the least and the greatest.
template <class T>
VirtualArray<T> HeightGrid::take(const Column<T>& samples) {
  const auto [lo, hi] = std::minmax_element(samples.begin(), samples.end());
  least_ = *lo, greatest_ = *hi;
  VirtualArray<T> tiles = large_array<T>(places());
  for (std::uint32_t j = 0; j < rows_; ++j)
    for (std::uint32_t i = 0; i < columns_; ++i)
      tiles[column_place(i) + row_place(j)] = samples[i + std::size_t{j} * columns_];
  return tiles;
}

/// Of the samples that the surface over the cells of a block depends on: `nearest` has walls on the borders
/// of the block, up to the heights of the cells around it.
HeightRange HeightGrid::range_of_block(std::uint32_t i, std::uint32_t j) const {
  const std::uint32_t ring = interpolation_ == HeightInterpolation::nearest ? 1 : 0;
  const auto begin = [&](std::uint32_t k) { return k * kBlock - std::min(ring, k * kBlock); };
  const auto end = [&](std::uint32_t k, std::uint32_t size) {
    return std::min(k * kBlock + kBlock + 1 + ring, size);
  };
  double lo = greatest_, hi = least_;
  for (std::uint32_t row = begin(j); row < end(j, rows_); ++row)
    for (std::uint32_t column = begin(i); column < end(i, columns_); ++column) {
      const double h = at(column, row);
      lo = std::min(lo, h), hi = std::max(hi, h);
    }
  const double below = std::floor((lo - least_) / step_), above = std::ceil((hi - least_) / step_);
  return {static_cast<std::uint16_t>(std::clamp(below, 0.0, 65535.0)),
          static_cast<std::uint16_t>(std::clamp(above, 0.0, 65535.0))};
}

void HeightGrid::build_pyramid() {
  const auto blocks = [](std::uint32_t samples) { return std::max((samples + kBlock - 2) / kBlock, 1u); };
  std::uint32_t columns = blocks(columns_), rows = blocks(rows_);
  for (levels_ = 0;; columns = (columns + 1) / 2, rows = (rows + 1) / 2) {
    const std::uint32_t pairs = (columns + 1) / 2;
    level_[levels_++] = {columns, rows, pairs, range_count_};
    range_count_ += 4 * std::size_t{pairs} * ((rows + 1) / 2);
    if (columns == 1 && rows == 1) break;
  }
  ranges_ = large_array<HeightRange>(range_count_);
  range_data_ = ranges_.data();
  for (std::uint32_t j = 0; j < level_[0].rows; ++j)
    for (std::uint32_t i = 0; i < level_[0].columns; ++i) ranges_[level_[0].at(i, j)] = range_of_block(i, j);
  for (int k = 1; k < levels_; ++k) {
    const Level &fine = level_[k - 1], &coarse = level_[k];
    for (std::uint32_t j = 0; j < coarse.rows; ++j)
      for (std::uint32_t i = 0; i < coarse.columns; ++i) {
        HeightRange range{65535, 0};
        for (std::uint32_t y = 2 * j; y < std::min(2 * j + 2, fine.rows); ++y)
          for (std::uint32_t x = 2 * i; x < std::min(2 * i + 2, fine.columns); ++x) {
            const HeightRange part = ranges_[fine.at(x, y)];
            range.least = std::min(range.least, part.least);
            range.greatest = std::max(range.greatest, part.greatest);
          }
        ranges_[coarse.at(i, j)] = range;
      }
  }
}

}  // namespace oktett
